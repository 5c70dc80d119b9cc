#include "semantic_mapper/frame_input.hpp"

#include <algorithm>
#include <utility>

#include "common/messages/camera.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/depth_input.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::semantic_mapper {
namespace {

using time::Match;

constexpr std::size_t kWaitingFrames = 90;  // frames with depth wait for labels: three seconds at 30 Hz
constexpr std::size_t kWaitingImages = kWaitingFrames + 30;  // images wait for slam's pose, too: one second more
constexpr std::size_t kWaitingInfos = kWaitingImages + 34;   // on a network they are ahead by half a second more

}  // namespace

FrameInput::FrameInput(const SemanticMapperComponentConfig& config, runtime::Context& context,
                       std::function<void(const std::string&)> drop)
    : config_(config), context_(context), drop_(std::move(drop)),
      tracked_(context, topics::kTrackedFrame, "slam frame", kWaitingFrames),
      tolerance_(time::Duration::from_seconds(config.max_stamp_difference_s)),
      depth_(runtime::depth_input(context, kWaitingImages)),
      labels_(context, topics::kLabels, "labels", kWaitingImages),
      confidence_(context, topics::kLabelConfidence, "label confidence", kWaitingImages),
      info_(context, topics::kColorInfo, "camera info", kWaitingInfos), depth_camera_(context, static_transforms_) {
  context.subscribe(topics::kStaticTransforms, [this](const auto& m) { static_transforms_.add(m); });
  depth_camera_.follow(context, topics::kDepthEstimate);
  depth_.require();
  info_.require();
  tracked_.on_clock_set([this](time::Duration step) { follow_clock(step); });
}

/// The step is known to the jitter of delays only, and time must not go back.
void FrameInput::follow_clock(time::Duration step) {
  const time::Time first = tracked_.front().first;
  if (on_clock_set_) on_clock_set_(step, first);
  for (auto* images : {&depth_, &labels_, &confidence_}) images->expect_restart(first);
  info_.expect_restart(first);
  tolerance_.begin_anew();
  if (newest_) newest_ = std::min(*newest_ + step, first);
}

void FrameInput::collect(const runtime::Cycle& cycle) {
  while (collect_oldest(cycle)) {
  }
}

/// Joins the oldest frame of slam with its depth; false when its partners may still come.
bool FrameInput::collect_oldest(const runtime::Cycle& cycle) {
  namespace Constants = lapis_msgs::msg::TrackedFrame_Constants;
  if (tracked_.empty()) return false;
  const auto& [stamp, tracked] = tracked_.front();
  const bool is_last_chance = cycle.inputs_complete || tracked_.is_full();
  if (depth_camera_.is_awaited() && !is_last_chance) return false;
  const auto known = tolerance_.of(stamp, tracked_.second());
  const auto tolerance = known.value_or(is_last_chance ? time::StampTolerance::kLargest : time::Duration{});
  const auto partners = partners_of(stamp, tolerance, cycle.inputs_complete);
  if (!partners) return false;
  const bool is_whole = partners->depth != nullptr && partners->info != nullptr;
  if (!is_whole && !known && !is_last_chance) return false;  // the next tracked frame gives the tolerance
  published_ = stamp;
  const auto state = tracked.state();
  if (state != Constants::STATE_TRACKING && state != Constants::STATE_DEAD_RECKONING &&
      state != Constants::STATE_UNCONNECTED) {
    drop_("slam has no pose");
  } else if (partners->depth == nullptr) {
    drop_("no depth image for a tracked frame");
  } else if (partners->info == nullptr) {
    drop_("no camera info for a tracked frame");
  } else {
    add(tracked, *partners, tolerance);
  }
  tolerance_.note(stamp);
  depth_.drop_until(stamp - tolerance);
  info_.drop_until(stamp - tolerance);
  if (waiting_.empty()) drop_labels_until(stamp - tolerance);
  tracked_.drop_until(stamp);
  return true;
}

/// Null where there is none; nothing while one may still come.
std::optional<FrameInput::Partners> FrameInput::partners_of(time::Time stamp, time::Duration tolerance,
                                                            bool is_complete) {
  Partners found;
  const auto depth_match = depth_.match(stamp, tolerance, is_complete, found.depth);
  const auto info_match = info_.match(stamp, tolerance, is_complete, found.info);
  return depth_match == Match::kWait || info_match == Match::kWait ? std::nullopt : std::optional(found);
}

bool FrameInput::is_too_soon(const Tracked& tracked) const {
  if (!newest_ || tracked.session() != session_) return false;
  return (messages::from_message(tracked.header().stamp()) - *newest_).seconds() < config_.frame_interval_s;
}

void FrameInput::add(const Tracked& tracked, const Partners& partners, time::Duration tolerance) {
  if (is_too_soon(tracked)) return;
  const auto camera = messages::lens_camera(depth_camera_.corrected(*partners.info));
  if (!camera) return drop_(camera.reason);
  const auto depth = depth_camera_.convert(*partners.depth, *partners.info);
  if (!depth) return drop_(depth.reason);
  auto samples = to_core(*depth, *camera, config_.frame);
  if (!samples) return drop_(samples.reason);
  const time::Time stamp = messages::from_message(tracked.header().stamp());
  waiting_.push_back({stamp, tracked, std::move(*samples), *camera, tolerance});
  newest_ = stamp;
  session_ = tracked.session();
}

std::optional<SeenFrame> FrameInput::take(bool is_last_chance) {
  while (!waiting_.empty()) {
    const auto labels = labels_of(waiting_.front(), is_last_chance);
    if (!labels) return std::nullopt;
    SeenFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    const std::string problem = set_labels(frame.samples, *labels, frame.camera, config_.frame, rectifier_);
    drop_labels_until(frame.stamp - frame.tolerance);
    const auto above_list = frame.samples.labels_out_of_list();
    if (above_list > 0) context_.status().count("pixels unlabelled: label not in the list", above_list);
    if (problem.empty()) return frame;
    drop_(problem);
  }
  return std::nullopt;
}

/// Labels are optional: a slow segmentation costs frames their labels, but does not cost the map its frames. Nothing
/// while they may still come.
std::optional<LabelMessages> FrameInput::labels_of(const SeenFrame& frame, bool is_last_chance) {
  const auto waited = time::abs(tracked_.newest().value_or(frame.stamp) - frame.stamp);
  const bool is_overdue = is_last_chance || waiting_.size() >= kWaitingFrames ||
                          waited.seconds() > config_.label_wait_s ||
                          waiting_.back().tracked.session() != frame.tracked.session();
  Image* labels = nullptr;
  Image* confidence = nullptr;
  const auto label_match = labels_.match(frame.stamp, frame.tolerance, is_overdue || !labels_.has_publisher(), labels);
  const auto confidence_match =
      confidence_.match(frame.stamp, frame.tolerance, is_overdue || !confidence_.has_publisher(), confidence);
  if (label_match == Match::kWait || confidence_match == Match::kWait) return std::nullopt;
  return LabelMessages{labels, confidence};
}

void FrameInput::drop_labels_until(time::Time stamp) {
  labels_.drop_until(stamp);
  confidence_.drop_until(stamp);
}

}  // namespace lapis::semantic_mapper
