#include "controller/conversions.hpp"

#include <cmath>

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"

namespace lapis::controller {
namespace {

constexpr double kFarthest_m = 1e4;  // keeps cell indices within the range of integers
constexpr double kFinest_m = 0.01;

geometry_msgs::msg::Pose to_message(const PlanarPose& T) {
  const Eigen::Vector2d& p = T.translation();
  return messages::to_message(geometry::make_pose(
      {p.x(), p.y(), 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_of(T), Eigen::Vector3d::UnitZ()))));
}

}  // namespace

messages::Converted<PlanarPose> to_core(const geometry_msgs::msg::Pose& message) {
  using Result = messages::Converted<PlanarPose>;
  const auto T = messages::from_message(message);
  if (!T) return Result::refused(T.reason);
  if (T->translation().norm() > kFarthest_m) return Result::refused("pose is more than 10 km from the map's origin");
  const Eigen::Vector3d forward = T->linear().col(0);
  return planar_pose(T->translation().head<2>(), bearing(forward.head<2>()));
}

messages::Converted<std::vector<PlanarPose>> to_core(const nav_msgs::msg::Path& message) {
  std::vector<PlanarPose> poses;
  for (const auto& stamped : message.poses()) {
    const auto pose = to_core(stamped.pose());
    if (!pose) return messages::Converted<std::vector<PlanarPose>>::refused(pose.reason);
    poses.push_back(*pose);
  }
  return poses;
}

messages::Converted<Grid> to_core(const nav_msgs::msg::OccupancyGrid& message) {
  using Result = messages::Converted<Grid>;
  Grid grid;
  grid.resolution_m = static_cast<double>(message.info().resolution());
  const std::size_t cells = static_cast<std::size_t>(message.info().width()) * message.info().height();
  if (message.data().size() != cells) return Result::refused("grid has not width x height cells");
  if (cells == 0) return grid;
  if (!(grid.resolution_m >= kFinest_m && grid.resolution_m <= kFarthest_m)) {
    return Result::refused("resolution of the grid is not between 1 cm and 10 km");
  }
  const auto origin = to_core(message.info().origin());
  if (!origin) return Result::refused("origin of the grid: " + origin.reason);
  if (std::abs(yaw_of(*origin)) > 1e-6) return Result::refused("grid is turned");
  grid.origin = origin->translation();
  grid.width = static_cast<int>(message.info().width());
  grid.height = static_cast<int>(message.info().height());
  grid.cells.assign(message.data().begin(), message.data().end());
  return grid;
}

messages::Converted<DepthView> to_core(const sensor_msgs::msg::Image& depth, const sensor_msgs::msg::CameraInfo& info,
                                       const geometry::Pose& T_base_camera, images::KeptRectifier& rectifier) {
  using Result = messages::Converted<DepthView>;
  const auto camera = messages::lens_camera(info);
  if (!camera) return Result::refused(camera.reason);
  auto image = messages::to_depth(depth);
  if (!image) return Result::refused(image.reason);
  const auto problem = messages::size_problem("depth", image->width, image->height, camera->pinhole);
  if (!problem.empty()) return Result::refused(problem);
  rectifier.of(*camera).rectify(*image);
  return DepthView{std::move(*image), camera->pinhole, T_base_camera};
}

bool is_finite(const Velocity& velocity) {
  return std::isfinite(velocity.forward_m_s) && std::isfinite(velocity.turn_rad_s);
}

messages::Converted<Velocity> to_core(const geometry_msgs::msg::Twist& message) {
  const Velocity velocity{message.linear().x(), message.angular().z()};
  if (!is_finite(velocity)) return messages::Converted<Velocity>::refused("it is not finite");
  return velocity;
}

geometry_msgs::msg::Twist to_message(const Velocity& velocity) {
  geometry_msgs::msg::Twist message;
  message.linear().x(velocity.forward_m_s);
  message.angular().z(velocity.turn_rad_s);
  return message;
}

nav_msgs::msg::Path to_message(const std::vector<PlanarPose>& path, const std_msgs::msg::Header& header) {
  nav_msgs::msg::Path message;
  message.header(header);
  for (const PlanarPose& T_map_pose : path) {
    geometry_msgs::msg::PoseStamped stamped;
    stamped.header(header);
    stamped.pose(to_message(T_map_pose));
    message.poses().push_back(stamped);
  }
  return message;
}

nav_msgs::msg::Odometry to_message(const CommandOdometry& odometry, const std_msgs::msg::Header& header,
                                   const std::string& base_frame) {
  nav_msgs::msg::Odometry message;
  message.header(header);
  message.child_frame_id(base_frame);
  message.pose().pose(to_message(odometry.T_odom_base()));
  message.twist().twist(to_message(odometry.velocity()));
  return message;
}

lapis_msgs::msg::ControllerStatus to_message(const Decision& decision, const std_msgs::msg::Header& header) {
  lapis_msgs::msg::ControllerStatus message;
  message.header(header);
  message.state(static_cast<std::uint8_t>(decision.state));
  message.reason(decision.reason);
  message.distance_to_goal_m(decision.distance_to_goal_m);
  message.command(to_message(decision.command));
  return message;
}

}  // namespace lapis::controller
