#pragma once

#include <string>
#include <vector>

namespace lapis::command_line {

/// A writer or reader of another process.
struct SeenEndpoint {
  bool is_writer = false;
  std::string topic = {};  ///< ROS name with leading slash, or the plain DDS name
  std::string type = {};   ///< ROS name, or the DDS name of a type that is none of ROS 2
  bool is_reliable = false;
  bool is_latched = false;
  bool is_keyed = false;
  std::string type_hash = {};  ///< "RIHS01_..."; empty: it announces none
  std::string node = {};       ///< "/slam"; empty: unknown
  std::string run = {};        ///< run of Lapis that it belongs to; empty: none

  bool operator==(const SeenEndpoint&) const = default;
};

struct SeenTopic {
  std::string name = {};
  std::vector<std::string> types = {};  ///< one, unless its users disagree
  std::vector<SeenEndpoint> writers = {};
  std::vector<SeenEndpoint> readers = {};
};

/// The endpoints by topic, in the order of names.
std::vector<SeenTopic> topics_of(const std::vector<SeenEndpoint>& endpoints);

/// A service that somebody serves.
struct SeenService {
  std::string name = {};
  std::string request_type = {};  ///< "std_srvs/srv/Trigger_Request"
  std::string node = {};

  /// "std_srvs/srv/Trigger"
  std::string type() const;
};

/// "no topic /slm/odometry; there are /slam/odometry, /slam/status", or that there is none at all.
std::string not_among(const std::string& what, const std::string& name, const std::vector<std::string>& known);

}  // namespace lapis::command_line
