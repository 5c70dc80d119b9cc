#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "common/geometry/se3.hpp"
#include "common/messages/converted.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/tf2_msgs.hpp"

namespace lapis::messages {

geometry_msgs::msg::Pose to_message(const geometry::Pose& T);
geometry_msgs::msg::Transform to_transform(const geometry::Pose& T);
/// A transform as on /tf: of the frame `child` in that of the header.
geometry_msgs::msg::TransformStamped stamped_transform(const std_msgs::msg::Header& header, const std::string& child,
                                                       const geometry::Pose& T_header_child);

/// Refuses non-finite numbers and quaternions whose norm differs from 1 by more than 1e-3 (all zero means "unknown").
Converted<geometry::Pose> from_message(const geometry_msgs::msg::Pose& message);
Converted<geometry::Pose> from_message(const geometry_msgs::msg::Transform& message);

/// 6x6 row-major covariance as in ROS: the order (x, y, z, rotation about x, y, z) is that of Vector6d.
std::array<double, 36> to_row_major(const geometry::Matrix6d& covariance);

/// Static transforms by child frame, as announced on /tf_static so far (the transforms of several writers are merged).
class StaticTransforms {
 public:
  static constexpr std::size_t kMostFrames = 1000;

  /// Stores the valid transforms, of up to kMostFrames child frames; returns the reason why the last of the others was
  /// refused, or an empty text.
  std::string add(const tf2_msgs::msg::TFMessage& message);
  /// T_parent_child along the announced transforms, up and down their tree; nothing until they connect the two frames.
  std::optional<geometry::Pose> find(const std::string& parent, const std::string& child) const;

 private:
  struct Link {
    std::string parent;
    geometry::Pose T_parent_child;
  };
  template <class Visit>
  void climb(const std::string& first, Visit visit) const;

  std::map<std::string, Link> links_;
};

}  // namespace lapis::messages
