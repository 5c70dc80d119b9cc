#pragma once

#include <cstddef>
#include <vector>

#include "simulator/core/validation/report.hpp"
#include "simulator/core/views.hpp"
#include "simulator/core/world.hpp"

namespace lapis::simulator {

struct FeatureConfig {
  geometry::PinholeCamera camera;
  geometry::CameraMount mount;
  double robot_radius_m = 0.2;
  std::size_t max_views = 1500;
};

/// A view and how many ORB features (at most 1000, FAST threshold 20) its image with the default noise has.
struct FeatureView {
  Eigen::Vector2d position{0, 0};
  double yaw_rad = 0.0;
  int features = 0;
};

/// Whether so many poor ones among so many views leave no doubt on which side of 4 % the share of poor views is: were
/// it 4 %, fewer than one draw in 10,000 would be as far off (binomial distribution, one-sided).
bool is_decided(std::size_t poor, std::size_t views);

/// Views from where the robot gets to from the starts: places 0.5 m apart, 8 headings each, drawn in a fixed order
/// until they are max_views or is_decided after a hundred.
std::vector<FeatureView> measure_features(const World& world, const FeatureConfig& config, const Progress& progress);

/// Judges measure_features: fails when more than 4 % of the views have fewer than 100 features; a note instead for
/// stress scenes and for those without rooms or pictures, and also below 0.5 % (the robot cannot get lost).
Check check_features(const Scene& scene, std::vector<FeatureView> views);

}  // namespace lapis::simulator
