#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "common/images/rectifier.hpp"
#include "common/messages/geometry.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/depth_camera.hpp"
#include "common/runtime/stamped_input.hpp"
#include "common/time/stamp_tolerance.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "semantic_mapper/conversions.hpp"
#include "semantic_mapper/semantic_mapper_config.hpp"

namespace lapis::semantic_mapper {

/// What the camera saw in a frame of slam.
struct SeenFrame {
  time::Time stamp;
  lapis_msgs::msg::TrackedFrame tracked;  ///< with a pose, or in a sub-map of slam
  mapping::CompactFrame samples;
  geometry::LensCamera camera;   ///< of colour, to which labels and pose belong
  time::Duration tolerance;      ///< largest difference of the labels' stamps
  bool is_in_obstacles = false;  ///< for the caller to note
};

/// Joins the frames of slam with depth, and these with their labels, each in the order of their stamps. Labels may come
/// later than depth by `semantic_mapper.label_wait_s`; in between, a frame waits with what it has.
class FrameInput {
 public:
  using Tracked = lapis_msgs::msg::TrackedFrame;

  /// `config` outlives this object. `drop` is called with the reason for each frame that cannot be used.
  FrameInput(const SemanticMapperComponentConfig& config, runtime::Context& context,
             std::function<void(const std::string& reason)> drop);
  /// Sets the function that is called in free run when the stamps of frames have jumped, with the step and the stamp of
  /// the first frame behind it, before any of these is collected. The frames that wait are from before it.
  void on_clock_set(std::function<void(time::Duration step, time::Time first)> action) {
    on_clock_set_ = std::move(action);
  }

  /// Takes in all frames whose depth is there. Frames that come sooner than `semantic_mapper.frame_interval_s` after
  /// the one before are left out.
  void collect(const runtime::Cycle& cycle);
  /// The oldest frame when its labels are there, or when it does not wait for them any longer: with `is_last_chance`,
  /// when many frames wait, and behind frames of another session of slam.
  std::optional<SeenFrame> take(bool is_last_chance);
  /// Frames that wait for their labels, the oldest first.
  std::deque<SeenFrame>& waiting() { return waiting_; }
  /// Stamp of the newest frame that slam published and that was collected or dropped.
  time::Time published() const { return published_; }

 private:
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;

  struct Partners {
    Image* depth = nullptr;
    Info* info = nullptr;
  };

  void follow_clock(time::Duration step);
  bool collect_oldest(const runtime::Cycle& cycle);
  std::optional<Partners> partners_of(time::Time stamp, time::Duration tolerance, bool is_complete);
  void add(const Tracked& tracked, const Partners& partners, time::Duration tolerance);
  std::optional<LabelMessages> labels_of(const SeenFrame& frame, bool is_last_chance);
  void drop_labels_until(time::Time stamp);
  bool is_too_soon(const Tracked& tracked) const;

  const SemanticMapperComponentConfig& config_;
  runtime::Context& context_;
  std::function<void(const std::string&)> drop_;
  std::function<void(time::Duration, time::Time)> on_clock_set_;

  runtime::StampedInput<Tracked> tracked_;
  time::StampTolerance tolerance_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Image> labels_;
  runtime::StampedInput<Image> confidence_;
  runtime::StampedInput<Info> info_;  // of colour
  messages::StaticTransforms static_transforms_;
  runtime::DepthCamera depth_camera_;
  images::KeptRectifier rectifier_;  // of labels

  std::deque<SeenFrame> waiting_;
  std::int64_t session_ = 0;          // of the newest frame that was collected
  std::optional<time::Time> newest_;  // its stamp
  time::Time published_;
};

}  // namespace lapis::semantic_mapper
