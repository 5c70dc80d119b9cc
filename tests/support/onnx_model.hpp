#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace lapis::test {

/// Writes an ONNX model: the fields of onnx.proto that a small network needs, in the wire format of protocol buffers.
class OnnxModel {
 public:
  using Shape = std::vector<std::int64_t>;
  struct Attribute {
    std::string name;
    std::variant<std::int64_t, float, std::string, Shape> value;
  };

  explicit OnnxModel(int opset) : opset_(opset) {}

  /// Values of the graph from outside: tensors of float, outputs of int64 where `is_index`.
  void input(const std::string& name, const Shape& shape);
  void output(const std::string& name, const Shape& shape, bool is_index = false);
  void weights(const std::string& name, const Shape& shape, const std::vector<float>& values);
  void node(const std::string& op, const std::vector<std::string>& inputs, const std::string& output,
            const std::vector<Attribute>& attributes = {});

  /// Content of the file.
  std::string bytes() const;

 private:
  int opset_;
  std::string graph_;
};

}  // namespace lapis::test
