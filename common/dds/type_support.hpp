#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/dds/compat.hpp"
#include "idl/cdr.hpp"
#include "idl/type_support.hpp"

namespace lapis::dds {

/// Samples of this process that were dropped because their bytes are no message of the topic's type.
inline std::atomic<std::uint64_t> undecodable_samples{0};

/// What Fast DDS has to do with messages of one type.
struct MessageFunctions {
  const char* dds_name;
  void* (*create)();
  void (*destroy)(void* message);
  std::size_t (*encoded_bytes)(const void* message);
  std::size_t (*encode)(const void* message, std::span<std::uint8_t> to);  ///< 0: does not fit
  bool (*decode)(std::span<const std::uint8_t> bytes, void* message);
  void (*write_key)(const void* message, idl::CdrWriter& to);  ///< null: no key
};

template <class Message>
inline constexpr MessageFunctions kMessageFunctions{
    idl::TypeSupport<Message>::kDdsName,
    []() -> void* { return new Message(); },
    [](void* message) { delete static_cast<Message*>(message); },
    [](const void* message) { return idl::encoded_bytes(*static_cast<const Message*>(message)); },
    [](const void* message, std::span<std::uint8_t> to) {
      return idl::encode(*static_cast<const Message*>(message), to);
    },
    [](std::span<const std::uint8_t> bytes, void* message) {
      return idl::decode(bytes, *static_cast<Message*>(message));
    },
    [] {
      void (*write_key)(const void*, idl::CdrWriter&) = nullptr;
      if constexpr (idl::TypeSupport<Message>::kIsKeyed) {
        write_key = [](const void* message, idl::CdrWriter& to) {
          static_cast<const Message*>(message)->write_key(to);
        };
      }
      return write_key;
    }()};

/// Makes a message type known to Fast DDS. Samples whose bytes are no message are refused and counted.
compat::fdds::TypeSupport make_type_support(const MessageFunctions& functions);

template <class Message>
compat::fdds::TypeSupport make_type_support() {
  return make_type_support(kMessageFunctions<Message>);
}

}  // namespace lapis::dds
