#pragma once

#include <cstddef>
#include <type_traits>

#include "common/topics.hpp"

namespace lapis::fuzz {

/// Calls `visit` with the std::type_identity of each type that our readers take, once for each topic.
template <class Visitor>
void for_each_message(const Visitor& visit) {
  topics::for_each(
      [&](const auto& topic) { visit(std::type_identity<typename std::decay_t<decltype(topic)>::Type>()); });
  visit(std::type_identity<std_srvs::srv::Trigger_Request>());
  visit(std::type_identity<std_srvs::srv::Trigger_Response>());
}

inline std::size_t message_count() {
  std::size_t count = 0;
  for_each_message([&](auto) { ++count; });
  return count;
}

}  // namespace lapis::fuzz
