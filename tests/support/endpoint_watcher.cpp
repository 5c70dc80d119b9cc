#include "tests/support/endpoint_watcher.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "common/dds/discovery.hpp"

namespace lapis::test {

class EndpointWatcher::Listener : public dds::ParticipantListener {
 public:
  explicit Listener(const dds::Gid& own) : own_(own) {}

  void found(const SeenParticipant& participant) override {
    const std::lock_guard lock(mutex);
    participants.push_back(participant);
  }
  void lost(const dds::Gid& gid) override {
    const std::lock_guard lock(mutex);
    std::erase_if(participants, [&](const SeenParticipant& participant) { return participant.gid == gid; });
  }
  void found(SeenEndpoint endpoint) override {
    // DDS announces the participant's own endpoints, too.
    if (std::equal(own_.begin(), own_.begin() + dds::kGidPrefixBytes, endpoint.gid.begin())) return;
    const std::lock_guard lock(mutex);
    std::erase_if(endpoints, [&](const SeenEndpoint& other) { return other.gid == endpoint.gid; });
    endpoints.push_back(std::move(endpoint));
  }

  mutable std::mutex mutex;  // discovery calls from threads of DDS
  std::vector<SeenEndpoint> endpoints;
  std::vector<SeenParticipant> participants;

 private:
  dds::Gid own_;
};

EndpointWatcher::EndpointWatcher(dds::Participant& participant)
    : listener_(std::make_unique<Listener>(participant.gid())) {
  const auto domain = static_cast<std::uint32_t>(dds::discovery_from_environment().domain);
  for (auto* candidate : dds::compat::fdds::DomainParticipantFactory::get_instance()->lookup_participants(domain)) {
    if (dds::to_gid(candidate->guid()) == participant.gid()) participant_ = candidate;
  }
  if (participant_ == nullptr) throw std::runtime_error("the participant to watch with is not in the test's domain");
  participant_->set_listener(listener_.get(), dds::compat::fdds::StatusMask::none());
}

EndpointWatcher::~EndpointWatcher() { participant_->set_listener(nullptr, dds::compat::fdds::StatusMask::none()); }

std::vector<SeenEndpoint> EndpointWatcher::endpoints() const {
  const std::lock_guard lock(listener_->mutex);
  return listener_->endpoints;
}

std::vector<SeenParticipant> EndpointWatcher::participants() const {
  const std::lock_guard lock(listener_->mutex);
  return listener_->participants;
}

std::optional<SeenEndpoint> EndpointWatcher::writer(const std::string& topic) const {
  for (const auto& endpoint : endpoints()) {
    if (endpoint.is_writer && endpoint.topic == topic) return endpoint;
  }
  return std::nullopt;
}

std::optional<SeenEndpoint> EndpointWatcher::reader(const std::string& topic) const {
  for (const auto& endpoint : endpoints()) {
    if (!endpoint.is_writer && endpoint.topic == topic) return endpoint;
  }
  return std::nullopt;
}

}  // namespace lapis::test
