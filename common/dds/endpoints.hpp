#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/gid.hpp"

namespace lapis::dds {

/// A writer or reader of another process, as discovery announces it. The depth of its history is not part of that.
struct Endpoint {
  bool is_writer = false;
  std::string topic;  ///< DDS name, "rt/slam/odometry"
  std::string type;   ///< DDS name, "nav_msgs::msg::dds_::Odometry_"
  bool is_reliable = false;
  bool is_latched = false;  ///< TRANSIENT_LOCAL
  bool is_keyed = false;
  std::string user_data;  ///< "typehash=RIHS01_...;"
  Gid gid{};
};

/// The endpoints of the domain that are there now. Threads of DDS add and remove them.
class Endpoints {
 public:
  void add(Endpoint endpoint);
  void remove(const Gid& gid);
  /// Removes all endpoints of a participant.
  void remove_participant(const Gid& participant);
  std::vector<Endpoint> all() const;  ///< in the order of their ids
  /// Increases with every change.
  std::uint64_t version() const;

 private:
  static constexpr std::size_t kMost = 20'000;  // further ones are not kept

  mutable std::mutex mutex_;
  std::map<Gid, Endpoint> endpoints_;
  std::uint64_t version_ = 0;
};

/// "/slam/odometry" of "rt/slam/odometry"; empty: not a topic of ROS 2.
std::string ros_topic_name(const std::string& dds_name);
/// "nav_msgs/msg/Odometry" of "nav_msgs::msg::dds_::Odometry_"; empty: not a type of ROS 2.
std::string ros_type_name(const std::string& dds_name);
/// The inverse of ros_type_name(). Empty when the name is none of ROS 2.
std::string dds_type_name(const std::string& ros_name);
/// The type hash that an endpoint announces; empty when it announces none.
std::string type_hash_of(const Endpoint& endpoint);

}  // namespace lapis::dds
