#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include <string>
#include <vector>

#include "common/dds/compat.hpp"
#include "common/dds/endpoints.hpp"
#include "common/dds/gid.hpp"

namespace lapis::dds {

/// A participant of the domain, as discovery announces it.
struct FoundParticipant {
  std::string name;
  std::string user_data;  ///< "enclave=/;"
  Gid gid{};
};

/// Reports what discovery finds and loses, the own endpoints included. All functions are called from threads of DDS.
class ParticipantListener : public compat::fdds::DomainParticipantListener {
 public:
  virtual void found(const FoundParticipant& participant) = 0;
  virtual void lost(const Gid& /*participant*/) {}
  virtual void found(Endpoint /*endpoint*/) {}
  virtual void lost_endpoint(const Gid& /*endpoint*/) {}

 private:
  template <class Bytes>
  static std::string text_of(const Bytes& bytes) {
    return std::string(bytes.begin(), bytes.end());
  }

  /// The last byte of an entity id says the kind (DDSI-RTPS 2.3, table 9.1).
  static bool has_key(const Gid& gid) {
    constexpr std::uint8_t kWriterWithKey = 0x02, kReaderWithKey = 0x07;
    return gid.back() == kWriterWithKey || gid.back() == kReaderWithKey;
  }

  // 2.9 gives proxies with getters, 3.1 plain structs.
#ifdef LAPIS_FASTDDS_3
  template <class Data>
  static Endpoint to_endpoint(const Data& data, bool is_writer) {
    return {is_writer,
            data.topic_name.to_string(),
            data.type_name.to_string(),
            data.reliability.kind == compat::fdds::RELIABLE_RELIABILITY_QOS,
            data.durability.kind == compat::fdds::TRANSIENT_LOCAL_DURABILITY_QOS,
            has_key(to_gid(data.guid)),
            text_of(data.user_data.getValue()),
            to_gid(data.guid)};
  }
  void on_participant_discovery(compat::fdds::DomainParticipant*, compat::rtps::ParticipantDiscoveryStatus status,
                                const compat::fdds::ParticipantBuiltinTopicData& info, bool&) final {
    using Status = compat::rtps::ParticipantDiscoveryStatus;
    if (status == Status::REMOVED_PARTICIPANT || status == Status::DROPPED_PARTICIPANT) lost(to_gid(info.guid));
    if (status != Status::DISCOVERED_PARTICIPANT) return;
    found(FoundParticipant{info.participant_name.to_string(), text_of(info.user_data.getValue()), to_gid(info.guid)});
  }
  void on_data_writer_discovery(compat::fdds::DomainParticipant*, compat::rtps::WriterDiscoveryStatus status,
                                const compat::fdds::PublicationBuiltinTopicData& info, bool&) final {
    using Status = compat::rtps::WriterDiscoveryStatus;
    status == Status::REMOVED_WRITER ? lost_endpoint(to_gid(info.guid)) : found(to_endpoint(info, true));
  }
  void on_data_reader_discovery(compat::fdds::DomainParticipant*, compat::rtps::ReaderDiscoveryStatus status,
                                const compat::fdds::SubscriptionBuiltinTopicData& info, bool&) final {
    using Status = compat::rtps::ReaderDiscoveryStatus;
    status == Status::REMOVED_READER ? lost_endpoint(to_gid(info.guid)) : found(to_endpoint(info, false));
  }
#else
  template <class Data>
  static Endpoint to_endpoint(const Data& data, bool is_writer) {
    return {is_writer,
            data.topicName().to_string(),
            data.typeName().to_string(),
            data.m_qos.m_reliability.kind == compat::fdds::RELIABLE_RELIABILITY_QOS,
            data.m_qos.m_durability.kind == compat::fdds::TRANSIENT_LOCAL_DURABILITY_QOS,
            has_key(to_gid(data.guid())),
            text_of(data.m_qos.m_userData.getValue()),
            to_gid(data.guid())};
  }
  void on_participant_discovery(compat::fdds::DomainParticipant*,
                                compat::rtps::ParticipantDiscoveryInfo&& discovered) final {
    using Info = compat::rtps::ParticipantDiscoveryInfo;
    const auto& info = discovered.info;
    const bool is_lost =
        discovered.status == Info::REMOVED_PARTICIPANT || discovered.status == Info::DROPPED_PARTICIPANT;
    if (is_lost) lost(to_gid(info.m_guid));
    if (discovered.status != Info::DISCOVERED_PARTICIPANT) return;
    found(
        FoundParticipant{info.m_participantName.to_string(), text_of(info.m_userData.getValue()), to_gid(info.m_guid)});
  }
  void on_publisher_discovery(compat::fdds::DomainParticipant*, compat::rtps::WriterDiscoveryInfo&& discovered) final {
    const bool is_lost = discovered.status == compat::rtps::WriterDiscoveryInfo::REMOVED_WRITER;
    is_lost ? lost_endpoint(to_gid(discovered.info.guid())) : found(to_endpoint(discovered.info, true));
  }
  void on_subscriber_discovery(compat::fdds::DomainParticipant*, compat::rtps::ReaderDiscoveryInfo&& discovered) final {
    const bool is_lost = discovered.status == compat::rtps::ReaderDiscoveryInfo::REMOVED_READER;
    is_lost ? lost_endpoint(to_gid(discovered.info.guid())) : found(to_endpoint(discovered.info, false));
  }
#endif
};

}  // namespace lapis::dds
