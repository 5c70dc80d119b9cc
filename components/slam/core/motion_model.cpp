#include "slam/core/motion_model.hpp"

namespace lapis::slam {

void MotionModel::update(const Map& map, time::Time stamp, KeyframeId reference,
                         const geometry::Pose& T_reference_camera) {
  Last next{stamp, reference, T_reference_camera, geometry::Vector6d::Zero()};
  const double elapsed_s = last_ ? (stamp - last_->stamp).seconds() : 0.0;
  if (elapsed_s > 0.0 && elapsed_s <= max_gap_s_) {
    const geometry::Pose T_map_last = map.keyframe(last_->reference).T_map_camera * last_->T_reference_camera;
    const geometry::Pose T_map_camera = map.keyframe(reference).T_map_camera * T_reference_camera;
    next.velocity = geometry::se3_log(T_map_last.inverse() * T_map_camera) / elapsed_s;
  }
  last_ = next;
}

std::optional<geometry::Pose> MotionModel::predict(const Map& map, time::Time stamp) const {
  if (!last_) return std::nullopt;
  const double elapsed_s = (stamp - last_->stamp).seconds();
  if (elapsed_s < 0.0 || elapsed_s > max_gap_s_) return std::nullopt;
  return map.keyframe(last_->reference).T_map_camera * last_->T_reference_camera *
         geometry::se3_exp(last_->velocity * elapsed_s);
}

}  // namespace lapis::slam
