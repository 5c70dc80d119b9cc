#include "common/messages/geometry.hpp"

#include <cmath>

namespace lapis::messages {
namespace {

template <class Vector, class Quaternion>
Converted<geometry::Pose> checked_pose(const Vector& p, const Quaternion& q) {
  const Eigen::Vector3d translation(p.x(), p.y(), p.z());
  const Eigen::Quaterniond rotation(q.w(), q.x(), q.y(), q.z());
  if (!translation.allFinite() || !rotation.coeffs().allFinite()) {
    return Converted<geometry::Pose>::refused("pose has numbers that are not finite");
  }
  if (std::abs(rotation.norm() - 1.0) > 1e-3) return Converted<geometry::Pose>::refused("quaternion is not a unit one");
  return geometry::make_pose(translation, rotation);
}

template <class Vector>
void set_vector(const Eigen::Vector3d& from, Vector& to) {
  to.x(from.x());
  to.y(from.y());
  to.z(from.z());
}

void set_rotation(const geometry::Pose& T, geometry_msgs::msg::Quaternion& to) {
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  to.x(q.x());
  to.y(q.y());
  to.z(q.z());
  to.w(q.w());
}

}  // namespace

geometry_msgs::msg::Pose to_message(const geometry::Pose& T) {
  geometry_msgs::msg::Pose message;
  set_vector(T.translation(), message.position());
  set_rotation(T, message.orientation());
  return message;
}

geometry_msgs::msg::Transform to_transform(const geometry::Pose& T) {
  geometry_msgs::msg::Transform message;
  set_vector(T.translation(), message.translation());
  set_rotation(T, message.rotation());
  return message;
}

geometry_msgs::msg::TransformStamped stamped_transform(const std_msgs::msg::Header& header, const std::string& child,
                                                       const geometry::Pose& T_header_child) {
  geometry_msgs::msg::TransformStamped message;
  message.header(header);
  message.child_frame_id(child);
  message.transform(to_transform(T_header_child));
  return message;
}

Converted<geometry::Pose> from_message(const geometry_msgs::msg::Pose& message) {
  return checked_pose(message.position(), message.orientation());
}

Converted<geometry::Pose> from_message(const geometry_msgs::msg::Transform& message) {
  return checked_pose(message.translation(), message.rotation());
}

std::array<double, 36> to_row_major(const geometry::Matrix6d& covariance) {
  std::array<double, 36> out{};
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out.data()) = covariance;
  return out;
}

std::string StaticTransforms::add(const tf2_msgs::msg::TFMessage& message) {
  std::string problem;
  for (const auto& transform : message.transforms()) {
    if (links_.size() >= kMostFrames && !links_.contains(transform.child_frame_id())) {
      problem = "there are " + std::to_string(kMostFrames) + " frames already";
    } else if (const auto T = from_message(transform.transform())) {
      links_[transform.child_frame_id()] = {transform.header().frame_id(), *T};
    } else {
      problem = T.reason;
    }
  }
  return problem;
}

std::optional<geometry::Pose> StaticTransforms::find(const std::string& parent, const std::string& child) const {
  std::map<std::string, geometry::Pose> above;  // the parent in itself and in the frames above it
  climb(parent, [&](const std::string& frame, const geometry::Pose& T) { return !above.emplace(frame, T).second; });
  std::optional<geometry::Pose> found;
  climb(child, [&](const std::string& frame, const geometry::Pose& T) {
    const auto common = above.find(frame);
    if (common != above.end()) found = common->second.inverse() * T;
    return found.has_value();
  });
  return found;
}

/// Calls `visit` for a frame and those above it, with the pose of the first one in each, until it returns true.
template <class Visit>
void StaticTransforms::climb(const std::string& first, Visit visit) const {
  geometry::Pose T = geometry::Pose::Identity();
  std::string frame = first;
  for (std::size_t steps = 0; steps <= links_.size(); ++steps) {  // bounded, because faulty input may form a cycle
    if (visit(frame, T)) return;
    const auto link = links_.find(frame);
    if (link == links_.end()) return;
    T = link->second.T_parent_child * T;
    frame = link->second.parent;
  }
}

}  // namespace lapis::messages
