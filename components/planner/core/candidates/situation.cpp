#include "planner/core/candidates/situation.hpp"

namespace lapis::planner {

geometry::Pose camera_at(const Situation& s, const Pose2& robot) {
  geometry::Pose T_map_base = geometry::Pose::Identity();
  T_map_base.translate(Eigen::Vector3d(robot.p_map.x(), robot.p_map.y(), 0.0));
  T_map_base.rotate(Eigen::AngleAxisd(robot.yaw_rad, Eigen::Vector3d::UnitZ()));
  return T_map_base * s.T_base_camera;
}

}  // namespace lapis::planner
