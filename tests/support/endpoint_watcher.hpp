#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/participant.hpp"
#include "common/dds/participant_listener.hpp"

namespace lapis::test {

using SeenEndpoint = dds::Endpoint;
using SeenParticipant = dds::FoundParticipant;

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
