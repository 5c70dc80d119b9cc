#pragma once

#include <cstdint>
#include <filesystem>

#include "simulator/core/world.hpp"
#include "tests/benchmark/slam/blind_tour.hpp"

namespace lapis::slam::benchmark {

/// Writes a tour that comes back to where it began, and drives its first legs again, so that the camera sees what it
/// saw first: as many of the scene's waypoints as `longest_s` allows, by the planner's estimate (0: all). Its name in
/// `folder` says the start. Returns the file.
/// @throws std::runtime_error with one line that says what is wrong
std::filesystem::path write_round_tour(const simulator::World& world, const simulator::SimulatorConfig& config,
                                       double longest_s, const std::filesystem::path& folder);

/// Blind for 2 to 5 s within the first 20 s, in which odometry's heading gains an error of 5 to 10 degrees.
BlindStretch draw_heading_error(std::uint64_t seed);

/// Two runs that are blind for the same time, with and without the error of the heading.
struct HeadingTrial {
  BlindStretch stretch;
  BlindTour bent, straight;
};
HeadingTrial play_heading(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
                          const SlamConfig& slam, std::uint64_t seed);

struct HeadingVerdict {
  double ratio = 0.0;  ///< of the key-frames' ATE, with the error over without
  double right_again_s =
      0.0;  ///< after the stretch, from when on poses err by at most 0.1 m and 2 degrees for 1 s; or infinity
  bool is_passed = false;  ///< a ratio of at most 1.5
  bool is_wrong = false;   ///< a wrong loop in the map with the error
};
HeadingVerdict judge(const HeadingTrial& trial);

}  // namespace lapis::slam::benchmark
