#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/runtime/context.hpp"
#include "common/runtime/depth_camera.hpp"
#include "common/runtime/depth_input.hpp"
#include "common/runtime/stamped_input.hpp"
#include "common/time/stamp_tolerance.hpp"
#include "slam/frame_converter.hpp"

namespace lapis::slam {

/// The messages of one frame; the pointers are valid until the frame is popped.
struct JoinedFrame {
  time::Time stamp;  ///< of the colour image
  std::string optical_frame;
  const ColorMessage* color = nullptr;
  const sensor_msgs::msg::Image* depth = nullptr;
  const sensor_msgs::msg::CameraInfo* info = nullptr;
  std::string problem;  ///< what is missing; empty when the frame is whole
};

/// Joins colour, depth and camera info of one camera by their stamps: each colour image with the nearest of the others
/// within a tolerance. The result depends on stamps only, not on the order of arrival. A colour image without partners
/// is a frame with a problem; a depth image without colour is counted on /diagnostics. Neither holds up others.
class FrameInput {
 public:
  /// `tolerance`: largest difference of the stamps in a frame; zero: see time::StampTolerance. `transforms` are kept up
  /// to date by the caller, and outlive this object.
  FrameInput(time::Duration tolerance, const messages::StaticTransforms& transforms, runtime::Context& context);

  /// Called when the camera has restarted in lock-step: stamps of colour went back by more than a second.
  void on_restart(std::function<void()> action) { on_restart_ = std::move(action); }
  /// Called in free run when the stamps of colour have jumped, by `step`, and go on from there.
  void on_clock_set(std::function<void(time::Duration step)> action) { on_clock_set_ = std::move(action); }

  /// The oldest frame, or nothing while its partners may still come.
  std::optional<JoinedFrame> oldest(const runtime::Cycle& cycle);
  /// Content of a frame; refused with a reason when it cannot be used.
  messages::Converted<RgbdFrame> convert(const JoinedFrame& frame);
  messages::DepthConverter& depth_converter() { return depth_camera_.converter(); }
  /// Removes the oldest frame, which must be `frame`, and the messages that only older frames could use.
  void pop(const JoinedFrame& frame);

 private:
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;
  using Color = runtime::StampedInput<ColorMessage>;

  void begin_anew();

  runtime::Status& status_;
  time::StampTolerance tolerance_;
  time::Duration joined_within_;  // the tolerance of the oldest frame
  std::function<void()> on_restart_;
  std::function<void(time::Duration)> on_clock_set_;
  FrameConverter converter_;
  runtime::DepthCamera depth_camera_;
  Color color_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Info> info_;
};

}  // namespace lapis::slam
