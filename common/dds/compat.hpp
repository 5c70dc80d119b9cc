#pragma once

// The only file that depends on the Fast DDS version: 2.9 (Debian 12) or 3.1 (Debian 13).

#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/ContentFilteredTopic.hpp>
#include <fastdds/dds/topic/IContentFilter.hpp>
#include <fastdds/dds/topic/IContentFilterFactory.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/dds/host_addresses.hpp"
#if __has_include(<fastdds/config.hpp>)
#define LAPIS_FASTDDS_3 1
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#endif

namespace lapis::dds::compat {

namespace fdds = eprosima::fastdds::dds;

#ifdef LAPIS_FASTDDS_3

namespace rtps = eprosima::fastdds::rtps;
using DdsDuration = fdds::Duration_t;
inline DdsDuration infinite() { return fdds::c_TimeInfinite; }
inline bool ok(fdds::ReturnCode_t code) { return code == fdds::RETCODE_OK; }
inline fdds::ReturnCode_t write(fdds::DataWriter& writer, const void* sample, rtps::WriteParams& params) {
  return writer.write(sample, params);
}
template <class WriterQos>
void set_timings(WriterQos& qos, DdsDuration heartbeat_period, DdsDuration response_delay) {
  qos.reliable_writer_qos().times.heartbeat_period = heartbeat_period;
  qos.reliable_writer_qos().times.nack_response_delay = response_delay;
}
inline std::size_t serialized_size(const fdds::DataWriter& writer, const void* sample) {
  return writer.get_type().get()->calculate_serialized_size(sample, fdds::XCDR_DATA_REPRESENTATION);
}
template <class WriterQos>
void set_nack_suppression(WriterQos& qos, DdsDuration duration) {
  qos.reliable_writer_qos().times.nack_supression_duration = duration;
}
template <class ReaderQos>
void set_reader_timings(ReaderQos& qos, DdsDuration response_delay) {
  qos.reliable_reader_qos().times.heartbeat_response_delay = response_delay;
}
inline const fdds::ReturnCode_t kReturnOk = fdds::RETCODE_OK;
using FilterResult = fdds::ReturnCode_t;
/// 3.1.2 ends a process by an assertion, soon after its start, when its participant has a flow controller.
inline constexpr bool kHasFlowControllers = false;
using Payload = rtps::SerializedPayload_t&;
inline void announce_no_type_information(fdds::TypeSupport&) {}
inline std::uint32_t& reserved_bytes(fdds::TypeSupport& type) { return type->max_serialized_type_size; }
inline void announce_no_type_information(fdds::DomainParticipantQos& qos) {
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
}

#else

namespace rtps = eprosima::fastrtps::rtps;
using DdsDuration = eprosima::fastrtps::Duration_t;
inline DdsDuration infinite() { return eprosima::fastrtps::c_TimeInfinite; }
inline bool ok(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
inline bool ok(bool done) { return done; }
inline bool write(fdds::DataWriter& writer, const void* sample, rtps::WriteParams& params) {
  return writer.write(const_cast<void*>(sample), params);  // Fast DDS 2.9 takes void*, but only reads
}
template <class WriterQos>
void set_timings(WriterQos& qos, DdsDuration heartbeat_period, DdsDuration response_delay) {
  qos.reliable_writer_qos().times.heartbeatPeriod = heartbeat_period;
  qos.reliable_writer_qos().times.nackResponseDelay = response_delay;
}
inline std::size_t serialized_size(const fdds::DataWriter& writer, const void* sample) {
  return writer.get_type().get()->getSerializedSizeProvider(const_cast<void*>(sample))();  // it only reads
}
template <class WriterQos>
void set_nack_suppression(WriterQos& qos, DdsDuration duration) {
  qos.reliable_writer_qos().times.nackSupressionDuration = duration;
}
template <class ReaderQos>
void set_reader_timings(ReaderQos& qos, DdsDuration response_delay) {
  qos.reliable_reader_qos().times.heartbeatResponseDelay = response_delay;
}
using FilterResult = eprosima::fastrtps::types::ReturnCode_t;
inline constexpr bool kHasFlowControllers = true;
inline const eprosima::fastrtps::types::ReturnCode_t kReturnOk = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
using Payload = rtps::SerializedPayload_t*;
inline void announce_no_type_information(fdds::TypeSupport& type) {
  type->auto_fill_type_object(false);
  type->auto_fill_type_information(false);
}
/// Bytes that each sample of a history has from the start; it gets more when it needs more.
inline std::uint32_t& reserved_bytes(fdds::TypeSupport& type) { return type->m_typeSize; }
inline void announce_no_type_information(fdds::DomainParticipantQos&) {}

#endif

using eprosima::fastdds::rtps::SharedMemTransportDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
#ifdef LAPIS_FASTDDS_3
using eprosima::fastdds::rtps::IPLocator;
#else
using eprosima::fastrtps::rtps::IPLocator;
#endif

#ifdef LAPIS_FASTDDS_3
inline fdds::InstanceHandle_t no_instance() { return fdds::HANDLE_NIL; }
#else
inline fdds::InstanceHandle_t no_instance() { return fdds::InstanceHandle_t(); }
#endif

/// The IPv4 address of a locator as a number, the first byte highest; a locator keeps it in its last four bytes.
inline std::uint32_t ipv4_of(const rtps::Locator_t& locator) {
  std::uint32_t address = 0;
  for (std::size_t i = 12; i < 16; ++i) address = (address << 8U) | locator.address[i];
  return address;
}

/// Decides which datagrams Fast DDS may read. Called from threads of DDS, several at once.
class PacketInspector {
 public:
  virtual ~PacketInspector() = default;
  /// @param is_local the sender has an address of this host
  virtual bool admits(std::span<const std::uint8_t> message, const rtps::Locator_t& sender, bool is_local) = 0;
};

/// Settings of a transport that lets an inspector see what another transport receives.
class InspectedTransportDescriptor : public eprosima::fastdds::rtps::ChainingTransportDescriptor {
 public:
  InspectedTransportDescriptor(std::shared_ptr<UDPv4TransportDescriptor> udp,
                               std::shared_ptr<PacketInspector> inspector)
      : ChainingTransportDescriptor(std::move(udp)), inspector_(std::move(inspector)) {}
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

 private:
  std::shared_ptr<PacketInspector> inspector_;
};

/// Sends to this host's own addresses by the loopback interface, even where a list of interfaces does not contain them:
/// ROS 2 Jazzy announces them in each of its discovery ranges and receives there. Fast DDS 2.9 would drop them.
class InspectedTransport : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  InspectedTransport(const InspectedTransportDescriptor& descriptor, std::shared_ptr<PacketInspector> inspector)
      : ChainingTransport(descriptor), inspector_(std::move(inspector)) {}

  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next, const rtps::octet* message,
               std::uint32_t size, const rtps::Locator_t& own, const rtps::Locator_t& sender) override {
    if (inspector_->admits({message, size}, sender, is_local_locator(sender))) {
      next->OnDataReceived(message, size, own, sender);
    }
  }

  bool is_local_locator(const rtps::Locator_t& locator) const override {
    return IsLocatorSupported(locator) && host_.contains(ipv4_of(locator));
  }

  /// Others may send larger datagrams than this process does, which is what the transport below would ask for.
  std::uint32_t max_recv_buffer_size() const override { return kLargestDatagram; }

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

#ifdef LAPIS_FASTDDS_3
  using Buffers = std::vector<rtps::NetworkBuffer>;
  bool send(rtps::SenderResource* below, const Buffers& buffers, std::uint32_t bytes, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(buffers, bytes, begin, end, timeout);
  }
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result, bool is_remote_open,
                                bool is_local_open) const override {
    return to_loopback(remote, result) ||
           ChainingTransport::transform_remote_locator(remote, result, is_remote_open, is_local_open);
  }
#else
  bool send(rtps::SenderResource* below, const rtps::octet* message, std::uint32_t size, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(message, size, begin, end, timeout);
  }
  bool transform_remote_locator(const rtps::Locator_t& remote, rtps::Locator_t& result) const override {
    return to_loopback(remote, result) || ChainingTransport::transform_remote_locator(remote, result);
  }
#endif

 private:
  bool to_loopback(const rtps::Locator_t& remote, rtps::Locator_t& result) const {
    if (!is_local_locator(remote)) return false;
    result = remote;
    return IPLocator::setIPv4(result, "127.0.0.1");
  }

  static constexpr std::uint32_t kLargestDatagram = 65'535;

  std::shared_ptr<PacketInspector> inspector_;
  mutable HostAddresses host_;
};

inline eprosima::fastdds::rtps::TransportInterface* InspectedTransportDescriptor::create_transport() const {
  return new InspectedTransport(*this, inspector_);  // Fast DDS owns it
}

/// A filter of one reader, by the writer that signed a sample with its own identity (Writer::write). Fast DDS applies
/// it when a sample arrives, before it takes a place in the reader's history, and does not say there who wrote the
/// sample.
class SignatureFilter : private fdds::IContentFilter, public fdds::IContentFilterFactory {
 public:
  virtual ~SignatureFilter() = default;
  /// Called from threads of DDS. @param signer unknown() for a sample that is not signed
  virtual bool admits(const rtps::GUID_t& signer) const = 0;

 private:
  /// The end of a key has no payload and cannot be signed, so everybody's is admitted (decision 0054, price).
  bool evaluate(const SerializedPayload& payload, const FilterSampleInfo& info, const rtps::GUID_t&) const final {
    return payload.length == 0 || admits(info.sample_identity.writer_guid());
  }
  FilterResult create_content_filter(const char*, const char*, const fdds::TopicDataType*, const char*,
                                     const ParameterSeq&, fdds::IContentFilter*& filter) final {
    filter = this;
    return kReturnOk;
  }
  FilterResult delete_content_filter(const char*, fdds::IContentFilter*) final { return kReturnOk; }
};

inline DdsDuration duration(std::int64_t nanoseconds) {
  return DdsDuration(static_cast<std::int32_t>(nanoseconds / 1'000'000'000),
                     static_cast<std::uint32_t>(nanoseconds % 1'000'000'000));
}

}  // namespace lapis::dds::compat
