#pragma once

#include <atomic>
#include <cstdint>
#include <exception>

#include "common/dds/compat.hpp"
#include "idl/type_support.hpp"

namespace lapis::dds {

/// Number of samples that this process dropped because their bytes are not a message of the topic's type.
inline std::atomic<std::uint64_t> undecodable_samples{0};

/// Generated type support that survives damaged samples: otherwise the exceptions of Fast CDR would end the process.
template <class PubSubType>
class GuardedType : public PubSubType {
 public:
  bool deserialize(compat::Payload payload, void* sample) override {
    try {
      if (PubSubType::deserialize(payload, sample)) return true;
    } catch (const std::exception&) {  // Fast CDR's exceptions derive from it
    }
    ++undecodable_samples;
    return false;
  }
};

template <class Message>
compat::fdds::TypeSupport make_type_support() {
  return compat::fdds::TypeSupport(
      new GuardedType<typename idl::TypeSupport<Message>::PubSubType>());  // takes ownership
}

}  // namespace lapis::dds
