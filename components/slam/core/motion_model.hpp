#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/map.hpp"

namespace lapis::slam {

/// Constant velocity. Remembers the last pose relative to a key-frame, so that it follows when key-frames move.
class MotionModel {
 public:
  explicit MotionModel(double max_gap_s) : max_gap_s_(max_gap_s) {}

  void update(const Map& map, time::Time stamp, KeyframeId reference, const geometry::Pose& T_reference_camera);
  /// T_map_camera at a stamp; none before the first update and when the last one is too long ago or in the future.
  std::optional<geometry::Pose> predict(const Map& map, time::Time stamp) const;

 private:
  struct Last {
    time::Time stamp;
    KeyframeId reference = 0;
    geometry::Pose T_reference_camera = geometry::Pose::Identity();
    geometry::Vector6d velocity = geometry::Vector6d::Zero();  // [m/s, rad/s], camera frame
  };
  double max_gap_s_;
  std::optional<Last> last_;
};

}  // namespace lapis::slam
