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
  double wrong_s = 0.0;                                       ///< held from then on, and off by more than 1 m
  bool is_passed = false;  ///< never lost while covered, and vision is back within 2 s; without odometry, at all
  bool is_wrong = false;   ///< a wrong loop in the map, or off by more than 1 m for more than 2 s
};

/// `plain`: frames of the same tour without a cover. Vision is awaited from the first frame after the cover in which it
/// gave the pose there, too.
DarkVerdict judge(const BlindTour& tour, const BlindStretch& cover, const std::vector<WatchedFrame>& plain,
                  bool has_odometry);

}  // namespace lapis::slam::benchmark
