#include "controller/core/watchdog.hpp"

#include <sstream>

namespace lapis::controller {

Watchdog::Watchdog(const WatchdogConfig& config)
    : inputs_{{{"depth image", time::Duration::from_seconds(config.camera_timeout_s), {}, {}},
               {"pose", time::Duration::from_seconds(config.pose_timeout_s), {}, {}},
               {"usable depth image", time::Duration::from_seconds(config.camera_timeout_s), {}, {}},
               {"map", time::Duration::from_seconds(config.map_timeout_s), {}, {}},
               {"sign of life of the planner", time::Duration::from_seconds(config.planner_timeout_s), {}, {}}}} {}

void Watchdog::note(Input input, time::Time arrival, std::optional<time::Time> stamp) {
  Watched& watched = inputs_[static_cast<std::size_t>(input)];
  if (stamp && watched.stamp == stamp) return;
  watched.arrival = arrival;
  watched.stamp = stamp;
}

std::optional<Input> Watchdog::stale(time::Time now, std::initializer_list<Input> needed) const {
  for (const Input input : needed) {
    if (is_stale(inputs_[static_cast<std::size_t>(input)], now)) return input;
  }
  return std::nullopt;
}

bool Watchdog::is_stale(const Watched& watched, time::Time now) const {
  if (!watched.arrival || abs(now - *watched.arrival) > watched.timeout) return true;
  const auto& newest = inputs_[static_cast<std::size_t>(Input::kCamera)].stamp;
  return watched.stamp && newest && abs(*newest - *watched.stamp) > watched.timeout;
}

std::string Watchdog::describe(Input input) const {
  const Watched& watched = inputs_[static_cast<std::size_t>(input)];
  std::ostringstream text;
  if (watched.arrival) {
    text << "no " << watched.name << " for more than " << watched.timeout.seconds() << " s";
  } else {
    text << "no " << watched.name << " yet";
  }
  return text.str();
}

}  // namespace lapis::controller
