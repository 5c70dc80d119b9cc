#include "tests/benchmark/slam/heading_trial.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "simulator/core/robot/tour.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/slam/dice.hpp"

namespace lapis::slam::benchmark {
namespace {

using Waypoints = std::vector<Eigen::Vector2d>;

// The first `count` waypoints, back to the start, and the first two again.
Waypoints round_trip(const Waypoints& waypoints, std::size_t count, const Eigen::Vector2d& start) {
  Waypoints round(waypoints.begin(), waypoints.begin() + static_cast<std::ptrdiff_t>(count));
  round.push_back(start);
  round.insert(round.end(), waypoints.begin(),
               waypoints.begin() + static_cast<std::ptrdiff_t>(std::min(count, std::size_t{2})));
  return round;
}

std::optional<double> right_again_s(const std::vector<WatchedFrame>& frames, double from_s) {
  constexpr double kWithin_m = 0.1, kWithin_rad = 2.0 / kDegrees, kFor_s = 1.0;
  std::optional<double> since_s;
  for (const WatchedFrame& frame : frames) {
    if (frame.t_s < from_s) continue;
    const bool is_right = is_held(frame) && frame.error.m <= kWithin_m && frame.error.rad <= kWithin_rad;
    if (!is_right) since_s.reset();
    if (is_right && !since_s) since_s = frame.t_s;
    if (since_s && frame.t_s - *since_s >= kFor_s) return *since_s - from_s;
  }
  return std::nullopt;
}

}  // namespace

std::filesystem::path write_round_tour(const simulator::World& world, const simulator::SimulatorConfig& config,
                                       double longest_s, const std::filesystem::path& folder) {
  const Waypoints& all = world.scene().tour;
  if (all.empty()) throw std::runtime_error("scene " + world.scene().name + " has no tour");
  const Eigen::Vector2d start = start_pose(world, config).position;
  Waypoints round;
  for (std::size_t count = all.size(); count > 0; --count) {
    round = round_trip(all, count, start);
    const auto tour = simulator::plan_tour(world.nav_map(), start, round, tour_config(config));
    if (longest_s <= 0.0 || tour.duration_s <= longest_s) break;
  }
  std::filesystem::create_directories(folder);
  std::filesystem::path file = folder / ("round_" + world.scene().name + "_" + std::to_string(config.seed) + "_" +
                                         std::to_string(round.size()) + ".yaml");
  std::ofstream out(file);
  out << "tour: [";
  for (const auto& p : round) out << (&p == &round.front() ? "" : ", ") << "[" << p.x() << ", " << p.y() << "]";
  out << "]\n";
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
  return file;
}

BlindStretch draw_heading_error(std::uint64_t seed) {
  constexpr double kWithin_s = 20.0, kFirst_s = 2.0;
  Dice dice(seed);
  BlindStretch stretch;
  const double length_s = dice.between(2.0, 5.0);
  stretch.from_s = dice.between(kFirst_s, kWithin_s - length_s);
  stretch.to_s = stretch.from_s + length_s;
  const double sign = dice.sign();
  stretch.heading_error_rad = sign * dice.between(5.0, 10.0) / kDegrees;
  return stretch;
}

HeadingTrial play_heading(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
                          const SlamConfig& slam, std::uint64_t seed) {
  HeadingTrial trial;
  trial.stretch = draw_heading_error(seed);
  BlindStretch straight = trial.stretch;
  straight.heading_error_rad = 0.0;
  trial.straight = play_blind(config, folder, slam, straight);
  trial.bent = play_blind(config, folder, slam, trial.stretch);
  return trial;
}

HeadingVerdict judge(const HeadingTrial& trial) {
  constexpr double kRatio = 1.5;
  HeadingVerdict verdict;
  verdict.ratio = trial.bent.map.ate_m / trial.straight.map.ate_m;
  verdict.right_again_s =
      right_again_s(trial.bent.frames, trial.stretch.to_s).value_or(std::numeric_limits<double>::infinity());
  verdict.is_passed = verdict.ratio <= kRatio;
  verdict.is_wrong = trial.bent.map.wrong_loops > 0;
  return verdict;
}

}  // namespace lapis::slam::benchmark
