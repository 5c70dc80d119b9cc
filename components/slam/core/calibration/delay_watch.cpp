#include "slam/core/calibration/delay_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lapis::slam {
namespace {

constexpr std::size_t kFewestEdges = 300;
constexpr std::size_t kFewestViews = 4, kMostViews = 8;
constexpr int kMostSeen = 300;      // frames with edges, a minute
constexpr double kLeast_s = 0.1;    // between views
constexpr double kLongest_s = 0.3;  // from the frame before to the one after: velocity changes
constexpr double kLeastSpeed_px_s = 60.0;
constexpr double kMostDelay_s = 0.1;
constexpr double kLeastSigmas = 4.0, kNotable_px = 1.5;
constexpr double kLeastBetterSigmas = 2.6;     // 99 %: one of two explanations is chosen
constexpr double kNotableElsewhere_px = 0.75;  // by what is off beside the delay

}  // namespace

std::optional<DepthOffset> DelayWatch::add(const RgbdFrame& frame, const std::optional<geometry::Pose>& T_map_camera) {
  if (is_over_) return std::nullopt;
  if (!T_map_camera) {
    last_.reset();
    pending_.reset();
    return std::nullopt;
  }
  const Seen now{frame.stamp, *T_map_camera};
  const bool has_more = complete_pending(now);
  if (last_ && !pending_ && (!newest_ || (frame.stamp - *newest_).seconds() >= kLeast_s)) {
    newest_ = frame.stamp;
    pending_.emplace(frame);
    before_pending_ = last_;
    if (pending_->edges().size() < kFewestEdges) pending_.reset();
  }
  last_ = now;
  const bool is_power_of_two = (views_.size() & (views_.size() - 1)) == 0;
  if (!has_more || views_.size() < kFewestViews || !is_power_of_two) return std::nullopt;
  const auto found = conclude();
  is_over_ = found || views_.size() >= kMostViews;
  return found;
}

/// Whether the view that waited shows motion.
bool DelayWatch::complete_pending(const Seen& now) {
  if (!pending_) return false;
  EdgeView view = std::move(*pending_);
  pending_.reset();
  is_over_ = ++seen_ >= kMostSeen;
  const double elapsed_s = (now.stamp - before_pending_->stamp).seconds();
  is_moving_ = false;  // as far as anybody can tell
  if (!(elapsed_s > 0.0 && elapsed_s < kLongest_s)) return false;
  const geometry::Pose T_before_now = before_pending_->T_map_camera.inverse() * now.T_map_camera;
  view.set_velocity(geometry::se3_log(T_before_now) / elapsed_s);
  is_moving_ = moved_px({&view, 1}, {.delay_s = 1.0}) >= kLeastSpeed_px_s;
  if (!*is_moving_) return false;
  views_.push_back(std::move(view));
  return true;
}

std::optional<DepthOffset> DelayWatch::conclude() const {
  const auto [found, better_sigmas] = align_late_depth(views_, kMostDelay_s, stated_);
  DepthOffset late = found.offset;
  // That depth lies beside colour has to be beyond doubt, and that a delay explains it better than anything else. What
  // is beyond doubt better than the best without a delay is so than what is stated, too.
  if (std::max(found.gain_sigmas, better_sigmas) < kLeastSigmas) return std::nullopt;
  if (better_sigmas < kLeastBetterSigmas) return std::nullopt;
  if (moved_px(views_, {.delay_s = late.delay_s}) < kNotable_px) return std::nullopt;
  if (std::abs(late.delay_s) > kMostDelay_s) return std::nullopt;
  const DepthOffset from_stated{1.0 + late.focal_ratio - stated_.focal_ratio, late.shift_m - stated_.shift_m};
  if (moved_px(views_, from_stated) >= kNotableElsewhere_px) return late;
  late.focal_ratio = stated_.focal_ratio;
  late.shift_m = stated_.shift_m;
  return late;
}

}  // namespace lapis::slam
