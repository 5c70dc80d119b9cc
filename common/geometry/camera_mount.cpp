#include "common/geometry/camera_mount.hpp"

namespace lapis::geometry {

Pose T_base_link(const CameraMount& mount) {
  // A positive turn about y (left) takes x (forward) to -z (down).
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(mount.pitch_down_rad, Eigen::Vector3d::UnitY()));
  return make_pose({0.0, 0.0, mount.height_m}, rotation);
}

Pose T_link_optical() {
  // The matrix of rpy(-pi/2, 0, -pi/2), written out because its entries are exactly 0 and 1.
  Pose T = Pose::Identity();
  T.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return T;
}

Pose T_base_camera(const CameraMount& mount) { return T_base_link(mount) * T_link_optical(); }

}  // namespace lapis::geometry
