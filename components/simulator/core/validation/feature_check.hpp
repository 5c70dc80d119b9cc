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

/// A view, and the number of ORB features (at most 1000, FAST threshold 20) in its image with the default noise.
struct FeatureView {
  Eigen::Vector2d position{0, 0};
  double yaw_rad = 0.0;
  int features = 0;
};

/// True when this number of poor views leaves no doubt on which side of 4 % the share of poor views is: if it were 4 %,
/// fewer than one draw in 10,000 would be as far off (binomial distribution, one-sided).
bool is_decided(std::size_t poor, std::size_t views);

/// Measures views from places that the robot can reach from the starts: places 0.5 m apart, with 8 headings each. Views
/// are drawn in a fixed order until there are max_views, or until is_decided(), which is evaluated every 100 views.
std::vector<FeatureView> measure_features(const World& world, const FeatureConfig& config, const Progress& progress);

/// Judges the result of measure_features: fails when more than 4 % of the views have fewer than 100 features. The
/// verdict is a note instead for stress scenes and for those without rooms or pictures, and also when the share is
/// below 0.5 % (the robot cannot get lost).
Check check_features(const Scene& scene, std::vector<FeatureView> views);

}  // namespace lapis::simulator
