#include "common/parameters/parameter_value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lapis::parameters {
namespace {

using rcl_interfaces::msg::ParameterDescriptor;
using rcl_interfaces::msg::ParameterValue;
namespace types = rcl_interfaces::msg::ParameterType_Constants;

constexpr std::array<const char*, 10> kTypeNames = {
    "none",  "a bool",          "an integer",         "a double",          "a string",
    "bytes", "a list of bools", "a list of integers", "a list of doubles", "a list of strings"};

std::string type_name(std::uint8_t type) {
  return type < kTypeNames.size() ? kTypeNames[type] : "of unknown type " + std::to_string(type);
}

/// The value of a key in the field of its type.
struct ToValue {
  ParameterValue value;

  void operator()(const bool* v) { set(types::PARAMETER_BOOL).bool_value(*v); }
  void operator()(const int* v) { set(types::PARAMETER_INTEGER).integer_value(*v); }
  void operator()(const std::int64_t* v) { set(types::PARAMETER_INTEGER).integer_value(*v); }
  void operator()(const double* v) { set(types::PARAMETER_DOUBLE).double_value(*v); }
  void operator()(const std::string* v) { set(types::PARAMETER_STRING).string_value(*v); }
  void operator()(const config::Words* v) { set(types::PARAMETER_STRING_ARRAY).string_array_value(*v); }
  void operator()(const config::Numbers* v) { set(types::PARAMETER_DOUBLE_ARRAY).double_array_value(*v); }

 private:
  ParameterValue& set(std::uint8_t type) {
    value.type(type);
    return value;
  }
};

/// A value read as the type of a key; nothing: it is of another type.
struct Read {
  const ParameterValue& value;

  std::optional<bool> operator()(const bool* /*key*/) const {
    return value.type() == types::PARAMETER_BOOL ? std::optional(value.bool_value()) : std::nullopt;
  }
  std::optional<std::int64_t> operator()(const std::int64_t* /*key*/) const {
    return value.type() == types::PARAMETER_INTEGER ? std::optional(value.integer_value()) : std::nullopt;
  }
  std::optional<double> operator()(const double* /*key*/) const {
    if (value.type() == types::PARAMETER_INTEGER) return static_cast<double>(value.integer_value());
    return value.type() == types::PARAMETER_DOUBLE ? std::optional(value.double_value()) : std::nullopt;
  }
  std::optional<std::string> operator()(const std::string* /*key*/) const {
    return value.type() == types::PARAMETER_STRING ? std::optional(value.string_value()) : std::nullopt;
  }
  std::optional<config::Words> operator()(const config::Words* /*key*/) const {
    return value.type() == types::PARAMETER_STRING_ARRAY ? std::optional(value.string_array_value()) : std::nullopt;
  }
  std::optional<config::Numbers> operator()(const config::Numbers* /*key*/) const {
    if (value.type() == types::PARAMETER_INTEGER_ARRAY) {
      return config::Numbers(value.integer_array_value().begin(), value.integer_array_value().end());
    }
    return value.type() == types::PARAMETER_DOUBLE_ARRAY ? std::optional(value.double_array_value()) : std::nullopt;
  }
};

/// What is wrong with a value of the right type; empty: nothing.
struct Refusal {
  const config::Bound& bound;

  std::string operator()(bool /*value*/) const { return ""; }
  std::string operator()(double value) const { return bound.allows(value) ? "" : bound.refusal(); }
  std::string operator()(std::int64_t value) const { return (*this)(static_cast<double>(value)); }
  std::string operator()(const std::string& value) const {
    if (!config::is_utf8(value)) return " is no UTF-8 text";
    return bound.allows(value) ? "" : bound.refusal();
  }
  template <class Item>
  std::string operator()(const std::vector<Item>& items) const {
    for (const Item& item : items) {
      if (const std::string refusal = (*this)(item); !refusal.empty()) return refusal;
    }
    return "";
  }
};

template <class Value>
std::string text_of(Value value) {
  config::Entry entry{"", &value, {}, ""};
  return config::to_text(entry);
}

struct Assign {
  const config::Entry& entry;
  const ParameterValue& value;

  template <class Value>
  std::string operator()(Value* key) const {
    const auto read = Read{value}(key);
    if (!read) {
      return entry.path + " is " + type_name(to_value(entry).type()) + ", not " + type_name(value.type());
    }
    if (const std::string refusal = Refusal{entry.bound}(*read); !refusal.empty()) {
      return entry.path + ": " + text_of(*read) + refusal;
    }
    *key = *read;
    return "";
  }
  std::string operator()(int* key) const {
    std::int64_t wide = *key;
    config::Entry as_wide = entry;
    as_wide.value = &wide;
    as_wide.bound.lowest = std::max<double>(entry.bound.lowest, std::numeric_limits<int>::lowest());
    as_wide.bound.highest = std::min<double>(entry.bound.highest, std::numeric_limits<int>::max());
    const std::string refusal = assign(as_wide, value);
    *key = static_cast<int>(wide);
    return refusal;
  }
};

/// The ends of a bound as integers of a type.
template <class Integer>
rcl_interfaces::msg::IntegerRange integer_range(const config::Bound& bound) {
  using Limits = std::numeric_limits<Integer>;
  rcl_interfaces::msg::IntegerRange range;
  const bool has_lowest = bound.lowest > static_cast<double>(Limits::lowest());
  const bool has_highest = bound.highest < static_cast<double>(Limits::max());
  range.from_value(has_lowest ? static_cast<std::int64_t>(std::ceil(bound.lowest)) : Limits::lowest());
  range.to_value(has_highest ? static_cast<std::int64_t>(std::floor(bound.highest)) : Limits::max());
  range.step(0);  // any
  return range;
}

struct AddRange {
  const config::Bound& bound;
  ParameterDescriptor& descriptor;

  void operator()(const int* /*key*/) const { descriptor.integer_range().push_back(integer_range<int>(bound)); }
  void operator()(const std::int64_t* /*key*/) const {
    if (!bound.text().empty()) descriptor.integer_range().push_back(integer_range<std::int64_t>(bound));
  }
  void operator()(const double* /*key*/) const {
    if (bound.text().empty()) return;
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value(bound.lowest);
    range.to_value(bound.highest);
    range.step(0.0);  // any
    descriptor.floating_point_range().push_back(range);
  }
  template <class Other>
  void operator()(const Other* /*key*/) const {
    if (!bound.text().empty()) descriptor.additional_constraints(bound.text());
  }
};

}  // namespace

ParameterValue to_value(const config::Entry& entry) {
  ToValue to_value;
  std::visit(to_value, entry.value);
  return to_value.value;
}

ParameterDescriptor to_descriptor(const config::Entry& entry) {
  ParameterDescriptor descriptor;
  descriptor.name(entry.path);
  descriptor.type(to_value(entry).type());
  descriptor.description(entry.meaning);
  descriptor.read_only(entry.change == config::Change::kAtStart);
  descriptor.dynamic_typing(false);
  std::visit(AddRange{entry.bound, descriptor}, entry.value);
  return descriptor;
}

std::string assign(const config::Entry& entry, const ParameterValue& value) {
  return std::visit(Assign{entry, value}, entry.value);
}

}  // namespace lapis::parameters
