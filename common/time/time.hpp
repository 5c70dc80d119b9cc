#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace lapis::time {

/// Signed span of time in whole nanoseconds.
struct Duration {
  std::int64_t nanoseconds = 0;

  static constexpr Duration from_seconds(double seconds) {
    // Rounded half away from zero, so that decimal inputs such as 0.033333 keep their last digit.
    return {static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5))};
  }
  constexpr double seconds() const { return static_cast<double>(nanoseconds) * 1e-9; }
  constexpr auto operator<=>(const Duration&) const = default;
};

/// Point in time: whole nanoseconds since the epoch of the clock in use (system or simulated).
struct Time {
  std::int64_t nanoseconds = 0;

  static constexpr Time from_seconds(double seconds) { return {Duration::from_seconds(seconds).nanoseconds}; }
  constexpr double seconds() const { return static_cast<double>(nanoseconds) * 1e-9; }
  constexpr auto operator<=>(const Time&) const = default;
};

constexpr Duration operator-(Time a, Time b) { return {a.nanoseconds - b.nanoseconds}; }
constexpr Time operator+(Time t, Duration d) { return {t.nanoseconds + d.nanoseconds}; }
constexpr Time operator-(Time t, Duration d) { return {t.nanoseconds - d.nanoseconds}; }
constexpr Duration operator-(Duration d) { return {-d.nanoseconds}; }
constexpr Duration abs(Duration d) { return d.nanoseconds < 0 ? -d : d; }

/// Exact decimal seconds with nine digits, as TUM files and logs show stamps: "12.033333000".
std::string to_string(Time t);

}  // namespace lapis::time
