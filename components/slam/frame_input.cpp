#include "slam/frame_input.hpp"

#include "common/topics/camera.hpp"

namespace lapis::slam {
namespace {

constexpr std::size_t kWaitingMessages = 8;
constexpr std::size_t kWaitingInfos = 64;  // small messages are ahead of their images, on a network by half a second

}  // namespace

FrameInput::FrameInput(time::Duration tolerance, const messages::StaticTransforms& transforms,
                       runtime::Context& context)
    : status_(context.status()), tolerance_(tolerance), depth_camera_(context, transforms),
      color_(context.options().is_color_compressed
                 ? Color(context, topics::kCompressedColor, "colour", kWaitingMessages)
                 : Color(context, topics::kColor, "colour", kWaitingMessages)),
      depth_(runtime::depth_input(context, kWaitingMessages)),
      info_(context, topics::kColorInfo, "camera info", kWaitingInfos) {
  color_.require();
  depth_.require();
  info_.require();
  color_.on_restart([this] {
    begin_anew();
    if (on_restart_) on_restart_();
  });
  color_.on_clock_set([this](time::Duration step) {
    begin_anew();
    if (on_clock_set_) on_clock_set_(step);
  });
}

void FrameInput::begin_anew() {
  const time::Time first = color_.front().first;
  depth_.expect_restart(first);
  info_.expect_restart(first);
  tolerance_.begin_anew();
}

std::optional<JoinedFrame> FrameInput::oldest(const runtime::Cycle& cycle) {
  using time::Match;
  if (color_.empty()) return std::nullopt;
  const auto& [stamp, color] = color_.front();
  const bool is_last_chance = cycle.inputs_complete || color_.is_full();
  if (depth_camera_.is_awaited() && !is_last_chance) return std::nullopt;
  const auto known = tolerance_.of(stamp, color_.second());
  joined_within_ = known.value_or(is_last_chance ? time::StampTolerance::kLargest : time::Duration{});
  Image* depth = nullptr;
  Info* info = nullptr;
  const auto depth_match = depth_.match(stamp, joined_within_, is_last_chance, depth);
  const auto info_match = info_.match(stamp, joined_within_, is_last_chance, info);
  if (depth_match == Match::kWait || info_match == Match::kWait) return std::nullopt;
  const bool is_whole = depth != nullptr && info != nullptr;
  if (!is_whole && !known && !is_last_chance) return std::nullopt;  // the next colour image gives the tolerance
  const auto frame_id = [](const auto& message) { return message.header().frame_id(); };
  JoinedFrame frame{stamp, std::visit(frame_id, color), &color, depth, info, ""};
  if (depth == nullptr) {
    frame.problem = "no depth image for a colour image";
  } else if (info == nullptr) {
    frame.problem = "no camera info for a colour image";
  }
  return frame;
}

messages::Converted<RgbdFrame> FrameInput::convert(const JoinedFrame& frame) {
  auto depth = depth_camera_.convert(*frame.depth, *frame.info);
  if (!depth) return messages::Converted<RgbdFrame>::refused(depth.reason);
  return converter_.convert(*frame.color, std::move(*depth), depth_camera_.corrected(*frame.info), frame.stamp);
}

void FrameInput::pop(const JoinedFrame& frame) {
  tolerance_.note(frame.stamp);
  const time::Time too_old = frame.stamp - joined_within_;
  const bool has_depth = frame.depth != nullptr;
  const time::Time depth_end = has_depth ? messages::from_message(frame.depth->header().stamp()) : too_old;
  const std::size_t unused = depth_.drop_until(depth_end) - (has_depth ? 1 : 0);
  if (unused > 0) status_.count("depth dropped: no colour image near it", unused);
  info_.drop_until(too_old);
  color_.drop_until(frame.stamp);
}

}  // namespace lapis::slam
