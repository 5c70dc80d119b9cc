#include "tests/support/onnx_model.hpp"

#include <cstring>

namespace lapis::test {
namespace {

// Numbers of fields and types in onnx.proto.
namespace model {
constexpr int kIrVersion = 1, kGraph = 7, kOpsetImport = 8;
}
namespace opset_id {
constexpr int kDomain = 1, kVersion = 2;
}
namespace graph {
constexpr int kNode = 1, kName = 2, kInitializer = 5, kInput = 11, kOutput = 12;
}
namespace node {
constexpr int kInput = 1, kOutput = 2, kName = 3, kOpType = 4, kAttribute = 5;
}
namespace attribute {
constexpr int kName = 1, kFloat = 2, kInt = 3, kText = 4, kInts = 8, kType = 20;
constexpr std::uint64_t kIsFloat = 1, kIsInt = 2, kIsText = 3, kIsInts = 7;
}  // namespace attribute
namespace tensor {
constexpr int kDims = 1, kDataType = 2, kName = 8, kRawData = 9;
constexpr std::uint64_t kFloat = 1, kInt64 = 7;
}  // namespace tensor
namespace value {
constexpr int kName = 1, kType = 2, kTensorType = 1, kElemType = 1, kShape = 2, kDim = 1, kDimValue = 1;
}
constexpr std::uint64_t kNewestIr = 10;

std::string varint(std::uint64_t number) {
  std::string bytes;
  for (; number >= 128; number >>= 7) bytes += static_cast<char>(number % 128 + 128);
  return bytes + static_cast<char>(number);
}

std::string key(int field, std::uint64_t wire_type) {
  return varint(static_cast<std::uint64_t>(field) * 8 + wire_type);
}

std::string number_field(int field, std::uint64_t number) { return key(field, 0) + varint(number); }

std::string bytes_field(int field, const std::string& bytes) { return key(field, 2) + varint(bytes.size()) + bytes; }

std::string float_field(int field, float number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return key(field, 5) + bytes;
}

std::string numbers_field(int field, const OnnxModel::Shape& numbers) {
  std::string bytes;
  for (const std::int64_t number : numbers) bytes += number_field(field, static_cast<std::uint64_t>(number));
  return bytes;
}

std::string value_info(const std::string& name, const OnnxModel::Shape& shape, std::uint64_t type) {
  std::string dims;
  for (const std::int64_t size : shape) {
    dims += bytes_field(value::kDim, number_field(value::kDimValue, static_cast<std::uint64_t>(size)));
  }
  const std::string of_tensor = number_field(value::kElemType, type) + bytes_field(value::kShape, dims);
  return bytes_field(value::kName, name) + bytes_field(value::kType, bytes_field(value::kTensorType, of_tensor));
}

struct AttributeValue {
  std::string operator()(std::int64_t number) const {
    return number_field(attribute::kInt, static_cast<std::uint64_t>(number)) +
           number_field(attribute::kType, attribute::kIsInt);
  }
  std::string operator()(float number) const {
    return float_field(attribute::kFloat, number) + number_field(attribute::kType, attribute::kIsFloat);
  }
  std::string operator()(const std::string& text) const {
    return bytes_field(attribute::kText, text) + number_field(attribute::kType, attribute::kIsText);
  }
  std::string operator()(const OnnxModel::Shape& numbers) const {
    return numbers_field(attribute::kInts, numbers) + number_field(attribute::kType, attribute::kIsInts);
  }
};

}  // namespace

void OnnxModel::input(const std::string& name, const Shape& shape) {
  graph_ += bytes_field(graph::kInput, value_info(name, shape, tensor::kFloat));
}

void OnnxModel::output(const std::string& name, const Shape& shape, bool is_index) {
  graph_ += bytes_field(graph::kOutput, value_info(name, shape, is_index ? tensor::kInt64 : tensor::kFloat));
}

void OnnxModel::weights(const std::string& name, const Shape& shape, const std::vector<float>& values) {
  std::string raw(values.size() * sizeof(float), '\0');
  if (!values.empty()) std::memcpy(raw.data(), values.data(), raw.size());
  graph_ += bytes_field(graph::kInitializer, numbers_field(tensor::kDims, shape) +
                                                 number_field(tensor::kDataType, tensor::kFloat) +
                                                 bytes_field(tensor::kName, name) + bytes_field(tensor::kRawData, raw));
}

void OnnxModel::node(const std::string& op, const std::vector<std::string>& inputs, const std::string& output,
                     const std::vector<Attribute>& attributes) {
  std::string bytes;
  for (const std::string& name : inputs) bytes += bytes_field(node::kInput, name);
  bytes +=
      bytes_field(node::kOutput, output) + bytes_field(node::kName, "make_" + output) + bytes_field(node::kOpType, op);
  for (const auto& [name, value] : attributes) {
    bytes += bytes_field(node::kAttribute, bytes_field(attribute::kName, name) + std::visit(AttributeValue(), value));
  }
  graph_ += bytes_field(graph::kNode, bytes);
}

std::string OnnxModel::bytes() const {
  const std::string opset =
      bytes_field(opset_id::kDomain, "") + number_field(opset_id::kVersion, static_cast<std::uint64_t>(opset_));
  return number_field(model::kIrVersion, kNewestIr) +
         bytes_field(model::kGraph, bytes_field(graph::kName, "test") + graph_) +
         bytes_field(model::kOpsetImport, opset);
}

}  // namespace lapis::test
