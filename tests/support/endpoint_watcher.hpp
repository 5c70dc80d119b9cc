#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/participant.hpp"

namespace lapis::test {

/// A writer or reader as DDS discovery announces it to others. History depth is not part of that.
struct SeenEndpoint {
  bool is_writer = false;
  std::string topic;  ///< DDS name, "rt/slam/odometry"
  std::string type;   ///< DDS name, "nav_msgs::msg::dds_::Odometry_"
  bool is_reliable = false;
  bool is_latched = false;  ///< TRANSIENT_LOCAL
  bool is_keyed = false;
  std::string user_data;
  dds::Gid gid{};
};

struct SeenParticipant {
  std::string name;
  std::string user_data;
  dds::Gid gid{};
};

/// Watches, through a participant of the test, the discovery of others. Create it before they start.
class EndpointWatcher {
 public:
  explicit EndpointWatcher(dds::Participant& participant);
  ~EndpointWatcher();
  EndpointWatcher(const EndpointWatcher&) = delete;
  EndpointWatcher& operator=(const EndpointWatcher&) = delete;

  std::vector<SeenEndpoint> endpoints() const;
  std::vector<SeenParticipant> participants() const;  ///< those that are still there
  std::optional<SeenEndpoint> writer(const std::string& topic) const;
  std::optional<SeenEndpoint> reader(const std::string& topic) const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
  dds::compat::fdds::DomainParticipant* participant_ = nullptr;
};

}  // namespace lapis::test
