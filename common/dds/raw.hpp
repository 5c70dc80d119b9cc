#pragma once

#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/service.hpp"
#include "common/dds/subscription.hpp"
#include "common/dds/writer.hpp"

namespace lapis::dds {

/// Type support of any type without keys, whose samples are bytes (std::vector<std::uint8_t>): CDR with its
/// encapsulation header. A participant knows one type support for each name of a type, so those that read or write
/// bytes cannot use the same types as messages.
class RawType : public compat::fdds::TopicDataType {
 public:
  using Bytes = std::vector<std::uint8_t>;

#ifdef LAPIS_FASTDDS_3
  explicit RawType(const std::string& type_name) {
    set_name(type_name);
    max_serialized_type_size = kFirstSize;
    is_compute_key_provided = false;
  }
  bool serialize(const void* const sample, compat::Payload payload, compat::fdds::DataRepresentationId_t) override {
    return write(*static_cast<const Bytes*>(sample), payload);
  }
  std::uint32_t calculate_serialized_size(const void* const sample, compat::fdds::DataRepresentationId_t) override {
    return static_cast<std::uint32_t>(static_cast<const Bytes*>(sample)->size());
  }
  bool deserialize(compat::Payload payload, void* sample) override { return read(payload, sample); }
  void* create_data() override { return new Bytes(); }
  void delete_data(void* sample) override { delete static_cast<Bytes*>(sample); }
  bool compute_key(compat::Payload, compat::rtps::InstanceHandle_t&, bool) override { return false; }
  bool compute_key(const void* const, compat::rtps::InstanceHandle_t&, bool) override { return false; }
#else
  explicit RawType(const std::string& type_name) {
    setName(type_name.c_str());
    m_typeSize = kFirstSize;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* sample, compat::Payload payload) override {
    return write(*static_cast<const Bytes*>(sample), *payload);
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override {
    return [sample] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(sample)->size()); };
  }
  bool deserialize(compat::Payload payload, void* sample) override { return read(*payload, sample); }
  void* createData() override { return new Bytes(); }
  void deleteData(void* sample) override { delete static_cast<Bytes*>(sample); }
  bool getKey(void*, compat::rtps::InstanceHandle_t*, bool) override { return false; }
#endif

 private:
  static constexpr std::uint32_t kFirstSize = 4096;  // of a buffer, which grows with the samples
  static constexpr std::size_t kHeader = 4;          // of CDR

  template <class Payload>
  static bool write(const Bytes& bytes, Payload& payload) {
    if (bytes.size() < kHeader || payload.max_size < bytes.size()) return false;
    std::memcpy(payload.data, bytes.data(), bytes.size());
    payload.length = static_cast<std::uint32_t>(bytes.size());
    payload.encapsulation = bytes[1];
    return true;
  }
  template <class Payload>
  static bool read(const Payload& payload, void* sample) {
    if (payload.length < kHeader) return false;
    static_cast<Bytes*>(sample)->assign(payload.data, payload.data + payload.length);
    return true;
  }
};

/// Receives the samples of a topic as bytes.
class RawSubscription : public Source {
 public:
  using Handler = std::function<void(const RawType::Bytes& bytes, const compat::fdds::SampleInfo& info)>;

  /// @param topic,type names of DDS
  RawSubscription(Participant& participant, const std::string& topic, const std::string& type,
                  const std::string& type_hash, const Qos& qos, Handler handler)
      : Source(participant, topic, type, compat::fdds::TypeSupport(new RawType(type)), type_hash, qos, Writers::kMany),
        handler_(std::move(handler)) {}

  std::size_t dispatch(std::size_t most) override {
    return take_each(most, &bytes_, [this](const auto& info) { handler_(bytes_, info); });
  }

 private:
  Handler handler_;
  RawType::Bytes bytes_;
};

/// Publishes bytes on a topic.
class RawPublisher : public Writer {
 public:
  /// @param topic,type names of DDS
  RawPublisher(Participant& participant, const std::string& topic, const std::string& type,
               const std::string& type_hash, const Qos& qos)
      : Writer(participant, topic, type, compat::fdds::TypeSupport(new RawType(type)), type_hash, qos) {}

  /// False when DDS refuses the sample, which is counted.
  bool publish(const RawType::Bytes& bytes) { return write(&bytes); }
};

/// Calls a service by bytes.
class RawClient : public RequestClient<RawType::Bytes, RawType::Bytes> {
 public:
  /// @param service name of the service as ROS 2 shows it
  /// @param request,response DDS names of the types
  RawClient(Participant& participant, const std::string& service, const std::string& request,
            const std::string& request_hash, const std::string& response, const std::string& response_hash)
      : RequestClient(participant, service, type_of(request, request_hash), type_of(response, response_hash)) {}

 private:
  static Type type_of(const std::string& name, const std::string& hash) {
    return {name, hash, compat::fdds::TypeSupport(new RawType(name))};
  }
};

}  // namespace lapis::dds
