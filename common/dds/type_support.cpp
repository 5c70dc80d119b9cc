#include "common/dds/type_support.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include <fastdds/dds/topic/TopicDataType.hpp>

namespace lapis::dds {
namespace {

using Payload = compat::rtps::SerializedPayload_t;
using Handle = compat::rtps::InstanceHandle_t;

class MessageType final : public compat::fdds::TopicDataType {
 public:
  explicit MessageType(const MessageFunctions& functions) : functions_(functions) {
    void* message = functions_.create();
    compat::describe_type(*this, functions_.dds_name, functions_.encoded_bytes(message), functions_.write_key != nullptr);
    functions_.destroy(message);
  }

#ifdef LAPIS_FASTDDS_3
  bool serialize(const void* message, Payload& payload, compat::fdds::DataRepresentationId_t /*ours is one*/) override {
    return encode(message, payload);
  }
  bool deserialize(Payload& payload, void* message) override { return decode(payload, message); }
  std::uint32_t calculate_serialized_size(const void* message, compat::fdds::DataRepresentationId_t /**/) override {
    return encoded_bytes(message);
  }
  void* create_data() override { return functions_.create(); }
  void delete_data(void* message) override { functions_.destroy(message); }
  bool compute_key(Payload& payload, Handle& handle, bool /*force_md5*/) override {
    void* message = functions_.create();
    const bool is_known = decode(payload, message) && key_of(message, handle);
    functions_.destroy(message);
    return is_known;
  }
  bool compute_key(const void* message, Handle& handle, bool /*force_md5*/) override { return key_of(message, handle); }
#else
  bool serialize(void* message, Payload* payload) override { return encode(message, *payload); }
  bool deserialize(Payload* payload, void* message) override { return decode(*payload, message); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* message) override {
    return [this, message] { return encoded_bytes(message); };
  }
  void* createData() override { return functions_.create(); }
  void deleteData(void* message) override { functions_.destroy(message); }
  bool getKey(void* message, Handle* handle, bool /*force_md5*/) override { return key_of(message, *handle); }
#endif

 private:
  bool encode(const void* message, Payload& payload) const {
    const std::size_t size = functions_.encode(message, {payload.data, payload.max_size});
    payload.length = static_cast<std::uint32_t>(size);
    payload.encapsulation = CDR_LE;
    return size > 0;
  }
  bool decode(const Payload& payload, void* message) const {
    if (functions_.decode({payload.data, payload.length}, message)) return true;
    ++undecodable_samples;
    return false;
  }
  std::uint32_t encoded_bytes(const void* message) const {
    return static_cast<std::uint32_t>(functions_.encoded_bytes(message));
  }
  // An instance is known by its key, big-endian and filled with zeros [OMG DDSI-RTPS, 9.6.4.8]; keys are not longer
  // than that (idl/cpp_types.py).
  bool key_of(const void* message, Handle& handle) const {
    if (functions_.write_key == nullptr) return false;
    std::array<std::uint8_t, 16> key{};
    idl::CdrWriter writer(key, std::endian::big);
    functions_.write_key(message, writer);
    for (std::size_t i = 0; i < key.size(); ++i) handle.value[i] = key[i];
    return true;
  }

  const MessageFunctions& functions_;
};

}  // namespace

compat::fdds::TypeSupport make_type_support(const MessageFunctions& functions) {
  return compat::fdds::TypeSupport(new MessageType(functions));  // takes ownership
}

}  // namespace lapis::dds
