#pragma once

#include <optional>
#include <string>
#include <utility>

namespace lapis::messages {

/// A message's content in core types, or the reason why it cannot be used.
template <class Value>
struct Converted {
  std::optional<Value> value;
  std::string reason;  ///< empty when there is a value

  Converted(Value v) : value(std::move(v)) {}  // NOLINT(google-explicit-constructor): reads like the value
  static Converted refused(std::string why) {
    Converted result;
    result.reason = std::move(why);
    return result;
  }
  explicit operator bool() const { return value.has_value(); }
  Value& operator*() { return *value; }
  const Value& operator*() const { return *value; }
  Value* operator->() { return &*value; }
  const Value* operator->() const { return &*value; }

 private:
  Converted() = default;
};

}  // namespace lapis::messages
