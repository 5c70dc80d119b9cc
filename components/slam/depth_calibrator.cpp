#include "slam/depth_calibrator.hpp"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace lapis::slam {
namespace {

constexpr std::size_t kFewestEdges = 300;
constexpr std::size_t kMostViews = 16;  // with edges: what these do not show is small
constexpr int kMostSeen = 300;          // a minute of bare walls
constexpr int kMostCorrections = 4;     // each makes the last one better
constexpr double kLeast_s = 0.2;        // between views
constexpr double kLeastSigmas = 4.0;
constexpr double kFirstNotable_px = 2.0, kNotable_px = 0.75;  // a correction is made better by less

/// The search may leave what it began with.
bool is_plausible(const DepthOffset& offset) {
  constexpr double kLeastRatio = 0.7, kMostRatio = 1.4, kMostShift_m = 0.12;
  return offset.focal_ratio > kLeastRatio && offset.focal_ratio < kMostRatio && offset.shift_m.norm() < kMostShift_m;
}

bool is_power_of_two(std::size_t n) { return (n & (n - 1)) == 0; }

}  // namespace

bool DepthCalibrator::wants(time::Time stamp) const {
  return !is_over() && (!newest_ || std::abs((stamp - *newest_).seconds()) >= kLeast_s);
}

bool DepthCalibrator::is_over() const {
  return views_.size() >= kMostViews || seen_ >= kMostSeen || found_ >= kMostCorrections;
}

std::optional<DepthAlignment> DepthCalibrator::add(const RgbdFrame& frame, const images::RgbdCalibration& used) {
  if (!used_ || !(*used_ == used)) views_.clear();
  used_ = used;
  newest_ = frame.stamp;
  ++seen_;
  EdgeView view(frame);
  if (view.edges().size() < kFewestEdges) return std::nullopt;
  views_.push_back(std::move(view));
  const auto count = views_.size();
  const std::size_t fewest = found_ > 0 ? std::max<std::size_t>(2, fewest_views_) : fewest_views_;
  if (count < fewest || !is_power_of_two(count)) return std::nullopt;
  const DepthAlignment alignment = align_depth(views_);
  const double notable_px = found_ == 0 ? kFirstNotable_px : kNotable_px;
  if (alignment.gain_sigmas < kLeastSigmas || !(alignment.moved_px >= notable_px)) return std::nullopt;
  if (!is_plausible(alignment.offset)) return std::nullopt;
  views_.clear();
  ++found_;
  return alignment;
}

images::RgbdCalibration corrected(const images::RgbdCalibration& used, const DepthOffset& offset) {
  images::RgbdCalibration cameras = used;
  geometry::PinholeCamera& depth = cameras.depth.pinhole;
  depth.fx /= offset.focal_ratio;
  depth.fy /= offset.focal_ratio;
  auto beside = cameras.T_color_depth.translation().head<2>();
  beside = offset.focal_ratio * beside + offset.shift_m;
  return cameras;
}

DepthOffset offset_to(const images::RgbdCalibration& used, const images::RgbdCalibration& other) {
  const double ratio = used.depth.pinhole.fx / other.depth.pinhole.fx;
  return {ratio, other.T_color_depth.translation().head<2>() - ratio * used.T_color_depth.translation().head<2>()};
}

std::string describe(const images::RgbdCalibration& cameras) {
  const Eigen::Vector3d t = 100.0 * cameras.T_color_depth.translation();
  return fmt::format("fx {:.1f}, fy {:.1f}, {:.1f} cm to the {} of colour and {:.1f} cm {} it",
                     cameras.depth.pinhole.fx, cameras.depth.pinhole.fy, std::abs(t.x()),
                     t.x() < 0.0 ? "left" : "right", std::abs(t.y()), t.y() < 0.0 ? "above" : "below");
}

}  // namespace lapis::slam
