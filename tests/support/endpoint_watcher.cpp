#include "tests/support/endpoint_watcher.hpp"

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "common/dds/discovery.hpp"

namespace lapis::test {
namespace {

namespace compat = dds::compat;
using compat::fdds::DomainParticipant;

template <class Bytes>
std::string text_of(const Bytes& bytes) {
  return std::string(bytes.begin(), bytes.end());
}

// The last byte of an entity id says the kind (DDSI-RTPS 2.3, table 9.1).
bool has_key(const dds::Gid& gid) {
  constexpr std::uint8_t kWriterWithKey = 0x02;
  constexpr std::uint8_t kReaderWithKey = 0x07;
  return gid.back() == kWriterWithKey || gid.back() == kReaderWithKey;
}

// 2.9 gives proxies with getters, 3.1 plain structs.
#ifdef LAPIS_FASTDDS_3
template <class Data>
SeenEndpoint to_seen(const Data& data, bool is_writer) {
  return {is_writer,
          data.topic_name.to_string(),
          data.type_name.to_string(),
          data.reliability.kind == compat::fdds::RELIABLE_RELIABILITY_QOS,
          data.durability.kind == compat::fdds::TRANSIENT_LOCAL_DURABILITY_QOS,
          has_key(dds::to_gid(data.guid)),
          text_of(data.user_data.getValue()),
          dds::to_gid(data.guid)};
}
#else
template <class Data>
SeenEndpoint to_seen(const Data& data, bool is_writer) {
  return {is_writer,
          data.topicName().to_string(),
          data.typeName().to_string(),
          data.m_qos.m_reliability.kind == compat::fdds::RELIABLE_RELIABILITY_QOS,
          data.m_qos.m_durability.kind == compat::fdds::TRANSIENT_LOCAL_DURABILITY_QOS,
          has_key(dds::to_gid(data.guid())),
          text_of(data.m_qos.m_userData.getValue()),
          dds::to_gid(data.guid())};
}
#endif

}  // namespace

class EndpointWatcher::Listener : public compat::fdds::DomainParticipantListener {
 public:
  explicit Listener(const dds::Gid& own) : own_(own) {}

#ifdef LAPIS_FASTDDS_3
  void on_participant_discovery(DomainParticipant*, compat::rtps::ParticipantDiscoveryStatus status,
                                const compat::fdds::ParticipantBuiltinTopicData& info, bool&) override {
    using Status = compat::rtps::ParticipantDiscoveryStatus;
    if (status == Status::REMOVED_PARTICIPANT || status == Status::DROPPED_PARTICIPANT) remove(dds::to_gid(info.guid));
    if (status != Status::DISCOVERED_PARTICIPANT) return;
    add(SeenParticipant{info.participant_name.to_string(), text_of(info.user_data.getValue()), dds::to_gid(info.guid)});
  }
  void on_data_writer_discovery(DomainParticipant*, compat::rtps::WriterDiscoveryStatus status,
                                const compat::fdds::PublicationBuiltinTopicData& info, bool&) override {
    if (status == compat::rtps::WriterDiscoveryStatus::DISCOVERED_WRITER) add(to_seen(info, true));
  }
  void on_data_reader_discovery(DomainParticipant*, compat::rtps::ReaderDiscoveryStatus status,
                                const compat::fdds::SubscriptionBuiltinTopicData& info, bool&) override {
    if (status == compat::rtps::ReaderDiscoveryStatus::DISCOVERED_READER) add(to_seen(info, false));
  }
#else
  void on_participant_discovery(DomainParticipant*, compat::rtps::ParticipantDiscoveryInfo&& found) override {
    using Info = compat::rtps::ParticipantDiscoveryInfo;
    const auto& info = found.info;
    if (found.status == Info::REMOVED_PARTICIPANT || found.status == Info::DROPPED_PARTICIPANT) {
      remove(dds::to_gid(info.m_guid));
    }
    if (found.status != Info::DISCOVERED_PARTICIPANT) return;
    add(SeenParticipant{info.m_participantName.to_string(), text_of(info.m_userData.getValue()),
                        dds::to_gid(info.m_guid)});
  }
  void on_publisher_discovery(DomainParticipant*, compat::rtps::WriterDiscoveryInfo&& found) override {
    if (found.status == compat::rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) add(to_seen(found.info, true));
  }
  void on_subscriber_discovery(DomainParticipant*, compat::rtps::ReaderDiscoveryInfo&& found) override {
    if (found.status == compat::rtps::ReaderDiscoveryInfo::DISCOVERED_READER) add(to_seen(found.info, false));
  }
#endif

  mutable std::mutex mutex;  // discovery calls from threads of DDS
  std::vector<SeenEndpoint> endpoints;
  std::vector<SeenParticipant> participants;

 private:
  void add(SeenParticipant participant) {
    const std::lock_guard lock(mutex);
    participants.push_back(std::move(participant));
  }
  void remove(const dds::Gid& gid) {
    const std::lock_guard lock(mutex);
    std::erase_if(participants, [&](const SeenParticipant& participant) { return participant.gid == gid; });
  }
  void add(SeenEndpoint endpoint) {
    // DDS announces the participant's own endpoints, too.
    if (std::equal(own_.begin(), own_.begin() + dds::kGidPrefixBytes, endpoint.gid.begin())) return;
    const std::lock_guard lock(mutex);
    endpoints.push_back(std::move(endpoint));
  }

  dds::Gid own_;
};

EndpointWatcher::EndpointWatcher(dds::Participant& participant)
    : listener_(std::make_unique<Listener>(participant.gid())) {
  const auto domain = static_cast<std::uint32_t>(dds::discovery_from_environment().domain);
  for (auto* candidate : compat::fdds::DomainParticipantFactory::get_instance()->lookup_participants(domain)) {
    if (dds::to_gid(candidate->guid()) == participant.gid()) participant_ = candidate;
  }
  if (participant_ == nullptr) throw std::runtime_error("the participant to watch with is not in the test's domain");
  participant_->set_listener(listener_.get(), compat::fdds::StatusMask::none());
}

EndpointWatcher::~EndpointWatcher() { participant_->set_listener(nullptr, compat::fdds::StatusMask::none()); }

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
