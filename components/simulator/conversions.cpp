#include "simulator/conversions.hpp"

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::simulator {
namespace {

constexpr double kUnknownVariance = 1e6;  // for what a robot on the floor cannot measure
constexpr double kLeastVariance = 1e-8;   // for what has no noise: zero would mean "unknown"

/// Pose of a robot on the floor.
geometry::Pose planar_pose(const Eigen::Vector2d& position, double yaw_rad) {
  return geometry::make_pose({position.x(), position.y(), 0.0},
                             Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())));
}

/// Covariance of (x, y, yaw), embedded in the 6x6 matrix of ROS (x, y, z, rotations about x, y and z).
geometry::Matrix6d planar_covariance(const Eigen::Matrix3d& covariance) {
  geometry::Matrix6d out = geometry::Matrix6d::Zero();
  for (const int i : {2, 3, 4}) out(i, i) = kUnknownVariance;
  const std::array<int, 3> index{0, 1, 5};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      out(index[static_cast<std::size_t>(row)], index[static_cast<std::size_t>(column)]) = covariance(row, column);
    }
    out(index[static_cast<std::size_t>(row)], index[static_cast<std::size_t>(row)]) += kLeastVariance;
  }
  return out;
}

nav_msgs::msg::Odometry to_message(const OdometrySample& sample, const SimulatorFrameIds& ids) {
  nav_msgs::msg::Odometry message;
  message.header(messages::header(sample.stamp, ids.odom));
  message.child_frame_id(ids.camera.base);
  message.pose().pose(messages::to_message(planar_pose(sample.position, sample.yaw_rad)));
  message.pose().covariance(messages::to_row_major(planar_covariance(sample.pose_covariance)));
  message.twist().twist().linear().x(sample.velocity.speed_m_s);
  message.twist().twist().angular().z(sample.velocity.turn_rate_rad_s);
  message.twist().covariance(messages::to_row_major(planar_covariance(sample.velocity_covariance)));
  return message;
}

tf2_msgs::msg::TFMessage to_transforms(const nav_msgs::msg::Odometry& odometry) {
  geometry_msgs::msg::TransformStamped transform;
  transform.header(odometry.header());
  transform.child_frame_id(odometry.child_frame_id());
  const auto& position = odometry.pose().pose().position();
  auto& translation = transform.transform().translation();
  translation.x(position.x());
  translation.y(position.y());
  translation.z(position.z());
  transform.transform().rotation(odometry.pose().pose().orientation());
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(transform);
  return message;
}

sensor_msgs::msg::Imu to_message(const ImuSample& sample, const SimulatorFrameIds& ids) {
  sensor_msgs::msg::Imu message;
  message.header(messages::header(sample.stamp, ids.camera.base));
  message.orientation_covariance()[0] = -1.0;  // it measures no orientation (sensor_msgs)
  message.angular_velocity().x(sample.turn_rate_rad_s.x());
  message.angular_velocity().y(sample.turn_rate_rad_s.y());
  message.angular_velocity().z(sample.turn_rate_rad_s.z());
  message.linear_acceleration().x(sample.acceleration_m_s2.x());
  message.linear_acceleration().y(sample.acceleration_m_s2.y());
  message.linear_acceleration().z(sample.acceleration_m_s2.z());
  for (const std::size_t i : {0U, 4U, 8U}) {
    message.angular_velocity_covariance()[i] = sample.turn_rate_variance;
    message.linear_acceleration_covariance()[i] = sample.acceleration_variance;
  }
  return message;
}

}  // namespace

messages::CameraSetUp set_up(const robot::CameraDescription& camera) {
  return {camera_mount(camera), pinhole_camera(camera), std::nullopt};
}

SensorMessages to_messages(const SensorFrame& frame, const messages::CameraSetUp& cameras,
                           const SimulatorFrameIds& ids) {
  SensorMessages out;
  const messages::CameraFrame seen{frame.stamp, frame.images.color, &frame.images.depth_mm, &frame.images.labels,
                                   frame.T_world_base};
  out.camera = messages::to_messages(seen, cameras, ids.camera);
  auto& twist = out.camera.ground_truth->twist().twist();
  twist.linear().x(frame.robot.velocity.x());
  twist.linear().y(frame.robot.velocity.y());
  twist.angular().z(frame.turn_rate_rad_s);
  for (const auto& sample : frame.odometry) {
    out.odometry.push_back(to_message(sample, ids));
    out.transforms.push_back(to_transforms(out.odometry.back()));
  }
  for (const auto& sample : frame.imu) out.imu.push_back(to_message(sample, ids));
  return out;
}

DriveCommand from_message(const geometry_msgs::msg::Twist& message) {
  return {message.linear().x(), message.angular().z()};
}

}  // namespace lapis::simulator
