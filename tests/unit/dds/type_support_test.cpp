#include "common/dds/type_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>
#include <vector>

#include "idl/std_msgs.hpp"

namespace lapis::dds {
namespace {

template <class Type>
bool decode(Type& type, const std::vector<std::uint8_t>& bytes, void* sample) {
  compat::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<std::uint32_t>(bytes.size());
  if constexpr (std::is_pointer_v<compat::Payload>) {
    return type.deserialize(&payload, sample);
  } else {
    return type.deserialize(payload, sample);
  }
}

TEST(TypeSupport, DamagedSamplesAreRefusedAndCounted) {
  GuardedType<idl::TypeSupport<std_msgs::msg::Bool>::PubSubType> type;
  std_msgs::msg::Bool message;
  EXPECT_TRUE(decode(type, {0, 1, 0, 0, 1}, &message));
  EXPECT_TRUE(message.data());
  const std::uint64_t before = undecodable_samples;
  const std::vector<std::vector<std::uint8_t>> damaged = {
      {0, 1, 0, 0, 2},     // neither true nor false
      {0x7f, 1, 0, 0, 1},  // unknown encapsulation
  };
  for (const auto& bytes : damaged) EXPECT_FALSE(decode(type, bytes, &message)) << ::testing::PrintToString(bytes);
  EXPECT_EQ(undecodable_samples, before + damaged.size());
}

}  // namespace
}  // namespace lapis::dds
