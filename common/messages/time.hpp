#pragma once

#include <string>

#include "common/time/time.hpp"
#include "idl/builtin_interfaces.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::messages {

/// Time of a message's stamp.
inline time::Time from_message(const builtin_interfaces::msg::Time& stamp) {
  return {static_cast<std::int64_t>(stamp.sec()) * 1'000'000'000 + stamp.nanosec()};
}

/// Stamp of a time, with nanosec in [0, 1e9) also before the epoch.
inline builtin_interfaces::msg::Time to_message(time::Time t) {
  std::int64_t sec = t.nanoseconds / 1'000'000'000;
  std::int64_t nanosec = t.nanoseconds % 1'000'000'000;
  if (nanosec < 0) {
    nanosec += 1'000'000'000;
    --sec;
  }
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(sec));
  stamp.nanosec(static_cast<std::uint32_t>(nanosec));
  return stamp;
}

inline std_msgs::msg::Header header(time::Time stamp, const std::string& frame_id) {
  std_msgs::msg::Header h;
  h.stamp(to_message(stamp));
  h.frame_id(frame_id);
  return h;
}

}  // namespace lapis::messages
