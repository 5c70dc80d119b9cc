#include "slam/core/calibration/kept_depth.hpp"

#include "common/images/depth_registration.hpp"
#include "slam/core/frame/surface.hpp"

namespace lapis::slam {
namespace {

/// Of a camera that moves from one pose to a later one.
std::optional<geometry::Vector6d> velocity(const geometry::Pose& from, const geometry::Pose& to,
                                           time::Duration elapsed) {
  if (elapsed <= time::Duration{}) return std::nullopt;
  return geometry::Vector6d(geometry::se3_log(from.inverse() * to) / elapsed.seconds());
}

}  // namespace

void KeptDepth::add(const Map& map, const RgbdFrame& frame, const std::optional<geometry::Pose>& T_map_camera,
                    std::optional<KeyframeId> keyframe) {
  if (!T_map_camera) return last_.reset();
  if (last_ && !kept_.empty() && kept_.back().stamp == last_->first) {
    Kept& kept = kept_.back();
    kept.after = velocity(map.keyframe(kept.id).T_map_camera, *T_map_camera, frame.stamp - kept.stamp);
  }
  if (keyframe && kept_.size() < kMost) {
    const auto before = last_ ? velocity(last_->second, *T_map_camera, frame.stamp - last_->first) : std::nullopt;
    kept_.push_back({*keyframe, frame.stamp, frame.depth, before, std::nullopt});
  }
  last_.emplace(frame.stamp, *T_map_camera);
}

void KeptDepth::correct(const SlamConfig& config, const DepthOffset& offset, Map& map) const {
  for (const Kept& kept : kept_) {
    const Keyframe& keyframe = map.keyframe(kept.id);
    const geometry::DepthImage depth = corrected(kept, keyframe.camera, offset);
    std::vector<Feature> features = keyframe.features;
    for (Feature& feature : features) feature.depth_m = interpolate_depth(config.noise, depth, feature.pixel);
    std::vector<SurfaceSample> surface;
    if (config.surface.enabled) surface = sample_surface(config.surface, config.noise, keyframe.camera, depth);
    map.renew_depth(kept.id, std::move(features), std::move(surface));
  }
}

/// By the motion in the time in which depth was measured; where only that on the other side is known, by that.
geometry::DepthImage KeptDepth::corrected(const Kept& kept, const geometry::PinholeCamera& camera,
                                          const DepthOffset& offset) {
  const auto& nearer = offset.delay_s > 0.0 ? kept.after : kept.before;
  const auto& other = offset.delay_s > 0.0 ? kept.before : kept.after;
  const geometry::Vector6d velocity = nearer.value_or(other.value_or(geometry::Vector6d::Zero()));
  geometry::PinholeCamera depth_camera = camera;
  depth_camera.fx /= offset.focal_ratio;
  depth_camera.fy /= offset.focal_ratio;
  const Eigen::Translation3d beside(offset.shift_m.x(), offset.shift_m.y(), 0.0);
  const geometry::Pose T_color_depth = geometry::se3_exp(velocity * offset.delay_s) * beside;
  return images::DepthRegistration({{camera, {}}, {depth_camera, {}}, T_color_depth})(kept.depth);
}

}  // namespace lapis::slam
