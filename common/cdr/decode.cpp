#include "common/cdr/decode.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace lapis::cdr {
namespace {

/// The value of a float32 as people write it: 0.1, not 0.10000000149.
double shortest(float value) {
  if (!std::isfinite(value)) return static_cast<double>(value);
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  double result = 0.0;
  std::from_chars(text, end.ptr, result);
  return result;
}

class Decoder {
 public:
  Decoder(const Layout& layout, const Bytes& bytes) : layout_(layout), bytes_(bytes) {
    if (bytes.size() < kHeaderBytes) throw std::runtime_error("a sample of " + std::to_string(bytes.size()) + " bytes");
    if (bytes[0] != 0 || bytes[1] > 1) throw std::runtime_error("its encoding is not plain CDR");
    const bool is_little = bytes[1] == 1;
    swaps_ = is_little != (std::endian::native == std::endian::little);
  }

  Value structure(std::size_t index, std::string_view end = {}) {
    Value value = Value::object();
    const Structure& structure = layout_.structures[index];
    if (structure.fields.empty()) take(1);  // of a structure without fields
    for (const Field& field : structure.fields) {
      if (field.name == end) break;
      value[field.name] = member(field);
    }
    return value;
  }

 private:
  Value member(const Field& field) {
    if (field.container == Container::kNone) return element(field);
    const std::size_t count = field.container == Container::kArray ? field.capacity : number<std::uint32_t>();
    if (count > bytes_.size() - at_) {  // each element has a byte at least
      throw std::runtime_error(field.name + ": " + std::to_string(count) + " elements, more than the sample has bytes");
    }
    Value value = Value::array();
    value.get_ref<Value::array_t&>().reserve(count);
    for (std::size_t i = 0; i < count; ++i) value.push_back(element(field));
    return value;
  }

  Value element(const Field& field) {
    switch (field.kind) {
      case Kind::kBool: return number<std::uint8_t>() != 0;
      case Kind::kByte:
      case Kind::kUint8: return number<std::uint8_t>();
      case Kind::kInt8: return number<std::int8_t>();
      case Kind::kInt16: return number<std::int16_t>();
      case Kind::kUint16: return number<std::uint16_t>();
      case Kind::kInt32: return number<std::int32_t>();
      case Kind::kUint32: return number<std::uint32_t>();
      case Kind::kInt64: return number<std::int64_t>();
      case Kind::kUint64: return number<std::uint64_t>();
      case Kind::kFloat32: return shortest(number<float>());
      case Kind::kFloat64: return number<double>();
      case Kind::kString: return string();
      case Kind::kStructure: return structure(field.structure);
    }
    throw std::logic_error("unknown kind of field");
  }

  /// The next bytes, from a multiple of `alignment` behind the header on.
  const std::uint8_t* take(std::size_t count, std::size_t alignment = 1) {
    const std::size_t begin = kHeaderBytes + (at_ - kHeaderBytes + alignment - 1) / alignment * alignment;
    if (begin > bytes_.size() || count > bytes_.size() - begin) throw std::runtime_error("the sample ends too early");
    at_ = begin + count;
    return bytes_.data() + begin;
  }

  template <class Number>
  Number number() {
    std::uint8_t raw[sizeof(Number)];
    std::memcpy(raw, take(sizeof(Number), sizeof(Number)), sizeof raw);
    if (swaps_) std::reverse(raw, raw + sizeof raw);
    Number value{};
    std::memcpy(&value, raw, sizeof raw);
    return value;
  }

  /// Its length counts the NUL at its end, at which it ends even if bytes follow, as in Fast CDR.
  std::string string() {
    const std::size_t size = number<std::uint32_t>();
    const auto* text = reinterpret_cast<const char*>(take(size));
    return std::string(text, strnlen(text, size));
  }

  const Layout& layout_;
  const Bytes& bytes_;
  std::size_t at_ = kHeaderBytes;
  bool swaps_ = false;
};

}  // namespace

Value decode(const Layout& layout, const Bytes& bytes, std::string_view end) {
  return Decoder(layout, bytes).structure(0, end);
}

}  // namespace lapis::cdr
