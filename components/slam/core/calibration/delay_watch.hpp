#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/calibration/depth_alignment.hpp"

namespace lapis::slam {

/// Finds out, from frames in which the camera moves, whether depth is of the same instant as colour.
class DelayWatch {
 public:
  /// `stated`: offset of the depth camera as it is stated to be from where the frames have it. Frames may have it
  /// elsewhere, because depth lay beside colour: this may have been the delay.
  explicit DelayWatch(const DepthOffset& stated = {}) : stated_(stated) {}

  /// Takes each frame, all with depth registered alike, and the pose that was found, if any. Returns the delay once it
  /// is beyond doubt, with what else is off, or `stated` where that is it; `is_over` from then on, or when enough has
  /// been seen.
  std::optional<DepthOffset> add(const RgbdFrame& frame, const std::optional<geometry::Pose>& T_map_camera);
  bool is_over() const { return is_over_; }
  /// Whether the newest frame with edges showed motion, which frames far apart never do; nothing before the first one.
  std::optional<bool> is_moving() const { return is_moving_; }
  /// Whether a frame has come with a pose, whose motion the next ones will tell.
  bool is_waiting() const { return last_.has_value(); }

 private:
  struct Seen {
    time::Time stamp;
    geometry::Pose T_map_camera = geometry::Pose::Identity();
  };
  bool complete_pending(const Seen& now);
  std::optional<DepthOffset> conclude() const;

  DepthOffset stated_;
  std::optional<bool> is_moving_;
  std::optional<Seen> last_, before_pending_;
  std::optional<EdgeView> pending_;  // its velocity follows from the frames before and after it
  std::optional<time::Time> newest_;
  std::vector<EdgeView> views_;
  int seen_ = 0;
  bool is_over_ = false;
};

}  // namespace lapis::slam
