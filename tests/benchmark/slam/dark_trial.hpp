#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tests/benchmark/slam/blind_tour.hpp"

namespace lapis::slam::benchmark {

/// The camera is covered for 20 s, at any time of a tour of `duration_s` but its first and last 10 s.
/// @throws std::runtime_error when the tour is too short
BlindStretch draw_cover(double duration_s, std::uint64_t seed);

struct DarkVerdict {
  double odometry_s = 0.0, lost_s = 0.0;                      ///< of the covered time
  PoseError drift;                                            ///< of the last pose while covered
  double sigma_m = 0.0, sigma_rad = 0.0;                      ///< that slam gave it
  double vision_s = std::numeric_limits<double>::infinity();  ///< until vision is back
  PoseError end;                                              ///< of the last pose
  bool is_passed = false;  ///< never lost while covered, and vision is back within 2 s
  bool is_wrong = false;   ///< a wrong loop in the map
};

/// `plain`: frames of the same tour without a cover. Vision is awaited from the first frame after the cover in which it
/// gave the pose there, too.
DarkVerdict judge(const BlindTour& tour, const BlindStretch& cover, const std::vector<WatchedFrame>& plain);

}  // namespace lapis::slam::benchmark
