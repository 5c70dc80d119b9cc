#include "common/dds/type_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "idl/lapis_msgs.hpp"
#include "idl/std_msgs.hpp"

namespace lapis::dds {
namespace {

bool decode(compat::fdds::TypeSupport& type, const std::vector<std::uint8_t>& bytes, void* sample) {
  compat::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<std::uint32_t>(bytes.size());
#ifdef LAPIS_FASTDDS_3
  return type->deserialize(payload, sample);
#else
  return type->deserialize(&payload, sample);
#endif
}

TEST(TypeSupport, DamagedSamplesAreRefusedAndCounted) {
  compat::fdds::TypeSupport type = make_type_support<std_msgs::msg::Bool>();
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

TEST(TypeSupport, InstancesAreKnownByTheirKeyBigEndian) {
  compat::fdds::TypeSupport type = make_type_support<lapis_msgs::msg::VoxelTile>();
  lapis_msgs::msg::VoxelTile tile;
  tile.x(1);
  tile.y(-2);
  tile.z(0x0304);
  tile.epoch(9);  // no part of the key
  compat::rtps::InstanceHandle_t handle;
#ifdef LAPIS_FASTDDS_3
  EXPECT_TRUE(type->is_compute_key_provided);
  ASSERT_TRUE(type->compute_key(&tile, handle));
#else
  EXPECT_TRUE(type->m_isGetKeyDefined);
  ASSERT_TRUE(type->getKey(&tile, &handle));
#endif
  const std::array<std::uint8_t, 16> expected{0, 0, 0, 1, 0xFF, 0xFF, 0xFF, 0xFE, 0, 0, 3, 4};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(handle.value[i], expected[i]) << i;
}

}  // namespace
}  // namespace lapis::dds
