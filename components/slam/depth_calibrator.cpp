#include "slam/depth_calibrator.hpp"

#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace lapis::slam {
namespace {

constexpr std::size_t kFewestEdges = 300;
constexpr int kMostViews = 16;       // with edges: what these do not show is small
constexpr int kMostSeen = 300;       // a minute of bare walls
constexpr int kMostCorrections = 4;  // each makes the last one better
constexpr double kLeast_s = 0.2;     // between views
constexpr double kLeastSigmas = 4.0;
constexpr double kFirstNotable_px = 1.5, kNotable_px = 0.75;  // a correction is made better by less

bool is_power_of_two(std::size_t n) { return (n & (n - 1)) == 0; }

}  // namespace

bool DepthCalibrator::wants(time::Time stamp) const {
  const bool is_over = views_.size() >= static_cast<std::size_t>(kMostViews) || seen_ >= kMostSeen;
  return !is_over && found_ < kMostCorrections && (!newest_ || std::abs((stamp - *newest_).seconds()) >= kLeast_s);
}

std::optional<DepthAlignment> DepthCalibrator::add(const RgbdFrame& frame) {
  newest_ = frame.stamp;
  ++seen_;
  EdgeView view(frame);
  if (view.edges().size() < kFewestEdges) return std::nullopt;
  views_.push_back(std::move(view));
  const auto count = views_.size();
  if (count < static_cast<std::size_t>(fewest_views_) || !is_power_of_two(count)) return std::nullopt;
  const DepthAlignment alignment = align_depth(views_);
  const double notable_px = found_ == 0 ? kFirstNotable_px : kNotable_px;
  if (alignment.gain_sigmas < kLeastSigmas || alignment.moved_px < notable_px) return std::nullopt;
  views_.clear();
  ++found_;
  return alignment;
}

images::RgbdCalibration corrected(const images::RgbdCalibration& used, const DepthOffset& offset) {
  images::RgbdCalibration cameras = used;
  geometry::PinholeCamera& depth = cameras.depth.pinhole;
  depth.fx /= offset.focal_ratio;
  depth.fy /= offset.focal_ratio;
  Eigen::Vector3d shift = offset.focal_ratio * used.T_color_depth.translation();
  shift.head<2>() += offset.shift_m;
  cameras.T_color_depth.translation() = shift;
  return cameras;
}

std::string describe(const images::RgbdCalibration& cameras) {
  const Eigen::Vector3d t = 100.0 * cameras.T_color_depth.translation();
  return fmt::format("fx {:.1f}, fy {:.1f}, {:.1f} cm to the {} of colour and {:.1f} cm {} it",
                     cameras.depth.pinhole.fx, cameras.depth.pinhole.fy, std::abs(t.x()),
                     t.x() < 0.0 ? "left" : "right", std::abs(t.y()), t.y() < 0.0 ? "above" : "below");
}

}  // namespace lapis::slam
