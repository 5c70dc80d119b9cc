#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "idl/type_support.hpp"

namespace lapis::idl::test {

using Bytes = std::vector<std::uint8_t>;

#if __has_include(<fastdds/config.hpp>)  // Fast DDS 3
/// Fast CDR 2 reads bytes that end between two members as a message of an older, shorter type.
inline constexpr bool kMissingMembersAreRefused = false;
#else
inline constexpr bool kMissingMembersAreRefused = true;
#endif

/// What a writer of T puts on the wire: four bytes of encapsulation, then CDR.
template <typename T>
Bytes serialize(const T& message) {
  typename TypeSupport<T>::PubSubType type;
  T copy = message;
#if __has_include(<fastdds/config.hpp>)
  constexpr auto kXcdr1 = eprosima::fastdds::dds::XCDR_DATA_REPRESENTATION;
  eprosima::fastdds::rtps::SerializedPayload_t payload(type.calculate_serialized_size(&copy, kXcdr1));
  if (!type.serialize(&copy, payload, kXcdr1)) return {};
#else
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&copy)());
  if (!type.serialize(&copy, &payload)) return {};
#endif
  return {payload.data, payload.data + payload.length};
}

/// Reads T from the bytes of the wire; false when they are no T.
template <typename T, typename PubSubType = typename TypeSupport<T>::PubSubType>
bool deserialize(const Bytes& bytes, T& message) {
  PubSubType type;
#if __has_include(<fastdds/config.hpp>)
  eprosima::fastdds::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
#else
  eprosima::fastrtps::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
#endif
  for (std::size_t i = 0; i < bytes.size(); ++i) payload.data[i] = bytes[i];
  payload.length = static_cast<std::uint32_t>(bytes.size());
#if __has_include(<fastdds/config.hpp>)
  return type.deserialize(payload, &message);
#else
  return type.deserialize(&payload, &message);
#endif
}

}  // namespace lapis::idl::test
