#pragma once

#include <filesystem>
#include <vector>

#include "simulator/simulator_config.hpp"
#include "slam/core/config.hpp"
#include "tests/benchmark/slam/watched_slam.hpp"

namespace lapis::slam::benchmark {

/// A stretch of a tour in which the camera sees nothing: black, without depth.
struct BlindStretch {
  double from_s = 0.0, to_s = 0.0;  ///< stamps, the second not included
  double heading_error_rad = 0.0;   ///< that odometry gains meanwhile, evenly over the time
};

struct BlindTour {
  std::vector<WatchedFrame> frames;
  WatchedMap map;
};

/// Plays the recording of a tour (play_tour) through slam, without odometry where the robot has none. The path that
/// odometry reports is bent where its heading is: what follows is turned with it.
/// @throws std::runtime_error with one line that says what is wrong
BlindTour play_blind(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
                     const SlamConfig& slam, const BlindStretch& stretch);

}  // namespace lapis::slam::benchmark
