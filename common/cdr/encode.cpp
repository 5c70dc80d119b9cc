#include "common/cdr/encode.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace lapis::cdr {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& wanted, const Value& given) {
  constexpr auto kReplace = Value::error_handler_t::replace;
  throw std::runtime_error((path.empty() ? "the message" : path) + ": " + wanted + " is wanted, not " +
                           given.dump(-1, ' ', false, kReplace));
}

/// The number that a text is, all of it.
template <class Number>
bool parse(std::string_view text, Number& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

template <class Integer>
Integer to_integer(const std::string& path, const Value& value) {
  using Limits = std::numeric_limits<Integer>;
  const std::string wanted =
      "an integer from " + std::to_string(Limits::min()) + " to " + std::to_string(Limits::max());
  Integer integer = 0;
  if (value.is_string()) {
    if (!parse(value.get_ref<const std::string&>(), integer)) refuse(path, wanted, value);
  } else if (value.is_number_unsigned()) {
    if (!std::in_range<Integer>(value.get<std::uint64_t>())) refuse(path, wanted, value);
    integer = static_cast<Integer>(value.get<std::uint64_t>());
  } else if (value.is_number_integer()) {
    if (!std::in_range<Integer>(value.get<std::int64_t>())) refuse(path, wanted, value);
    integer = static_cast<Integer>(value.get<std::int64_t>());
  } else {
    refuse(path, wanted, value);
  }
  return integer;
}

double to_double(const std::string& path, const Value& value) {
  if (value.is_number()) return value.get<double>();
  double number = 0.0;
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (text == ".nan") return std::numeric_limits<double>::quiet_NaN();
    if (text == ".inf") return std::numeric_limits<double>::infinity();
    if (text == "-.inf") return -std::numeric_limits<double>::infinity();
    if (parse(text, number)) return number;
  }
  refuse(path, "a number", value);
}

float to_float(const std::string& path, const Value& value) {
  const double number = to_double(path, value);
  if (std::isfinite(number) && std::abs(number) > static_cast<double>(std::numeric_limits<float>::max())) {
    refuse(path, "a number of single precision", value);
  }
  return static_cast<float>(number);
}

bool to_bool(const std::string& path, const Value& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value == "true" || value == "True") return true;
  if (value == "false" || value == "False") return false;
  refuse(path, "true or false", value);
}

class Encoder {
 public:
  explicit Encoder(const Layout& layout) : layout_(layout) {}

  void structure(std::size_t index, const std::string& path, const Value& value) {
    const Structure& structure = layout_.structures[index];
    check_names(structure, path, value);
    if (structure.fields.empty()) bytes_.push_back(0);
    for (const Field& field : structure.fields) {
      const auto given = value.find(field.name);
      member(field, path.empty() ? field.name : path + "." + field.name, given == value.end() ? Value() : *given);
    }
  }
  Bytes take() { return std::move(bytes_); }

 private:
  /// A message without fields, or of which none is given, may be null.
  static void check_names(const Structure& structure, const std::string& path, const Value& value) {
    if (value.is_null()) return;
    std::string known;
    for (const Field& field : structure.fields) known += (known.empty() ? "" : ", ") + field.name;
    if (!value.is_object()) refuse(path, "{" + known + "}", value);
    for (const auto& [name, content] : value.items()) {
      const auto is_it = [&key = name](const Field& field) { return field.name == key; };
      if (std::none_of(structure.fields.begin(), structure.fields.end(), is_it)) {
        throw std::runtime_error(structure.name + " has no field " + name +
                                 (known.empty() ? "; it has none" : "; it has " + known));
      }
    }
  }

  void member(const Field& field, const std::string& path, const Value& value) {
    if (field.container == Container::kNone) return element(field, path, value);
    const bool is_array = field.container == Container::kArray;
    if (!value.is_null() && !value.is_array()) refuse(path, "a list", value);
    if (is_array && !value.is_null() && value.size() != field.capacity) {
      refuse(path, "a list of " + std::to_string(field.capacity), value);
    }
    if (!is_array && field.capacity > 0 && value.size() > field.capacity) {
      refuse(path, "a list of at most " + std::to_string(field.capacity), value);
    }
    const std::size_t count = is_array ? field.capacity : value.size();
    if (!is_array) number(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      element(field, path + "[" + std::to_string(i) + "]", value.is_null() ? Value() : value[i]);
    }
  }

  void element(const Field& field, const std::string& path, const Value& value) {
    const Value& given = value.is_null() && field.kind != Kind::kStructure ? zero(field.kind) : value;
    switch (field.kind) {
      case Kind::kBool: return number<std::uint8_t>(to_bool(path, given) ? 1 : 0);
      case Kind::kByte:
      case Kind::kUint8: return number(to_integer<std::uint8_t>(path, given));
      case Kind::kInt8: return number(to_integer<std::int8_t>(path, given));
      case Kind::kInt16: return number(to_integer<std::int16_t>(path, given));
      case Kind::kUint16: return number(to_integer<std::uint16_t>(path, given));
      case Kind::kInt32: return number(to_integer<std::int32_t>(path, given));
      case Kind::kUint32: return number(to_integer<std::uint32_t>(path, given));
      case Kind::kInt64: return number(to_integer<std::int64_t>(path, given));
      case Kind::kUint64: return number(to_integer<std::uint64_t>(path, given));
      case Kind::kFloat32: return number(to_float(path, given));
      case Kind::kFloat64: return number(to_double(path, given));
      case Kind::kString: return string(field, path, given);
      case Kind::kStructure: return structure(field.structure, path, given);
    }
  }

  static const Value& zero(Kind kind) {
    static const Value kFalse = false, kZero = 0, kEmpty = "";
    return kind == Kind::kBool ? kFalse : kind == Kind::kString ? kEmpty : kZero;
  }

  void align(std::size_t alignment) {
    bytes_.resize(kHeaderBytes + (bytes_.size() - kHeaderBytes + alignment - 1) / alignment * alignment);
  }

  template <class Number>
  void number(Number value) {
    align(sizeof value);
    std::uint8_t raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof raw);
    bytes_.insert(bytes_.end(), raw, raw + sizeof raw);
  }

  void string(const Field& field, const std::string& path, const Value& value) {
    if (!value.is_primitive()) refuse(path, "a text", value);
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (text.find('\0') != std::string::npos) refuse(path, "a text without NUL", value);
    if (field.string_bound > 0 && text.size() > field.string_bound) {
      refuse(path, "a text of at most " + std::to_string(field.string_bound) + " bytes", value);
    }
    number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }

  const Layout& layout_;
  Bytes bytes_{0, 1, 0, 0};  // CDR, little-endian
};

}  // namespace

Bytes encode(const Layout& layout, const Value& value) {
  Encoder encoder(layout);
  encoder.structure(0, "", value);
  return encoder.take();
}

}  // namespace lapis::cdr
