#include "common/dds/endpoint_qos.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

using namespace compat::fdds;  // NOLINT(google-build-using-namespace): policy names only

constexpr Qos kByBestEffort{.depth = 5, .sensor = true, .best_effort = true};
constexpr Qos kProfiles[] = {kImage, kState,    kFrameState, kLatched, kCommand,
                             kBurst, kLockstep, kKeyedTiles, kService, kByBestEffort};

template <class EndpointQos>
void expect_common(const EndpointQos& qos, const Qos& wanted) {
  EXPECT_EQ(qos.reliability().kind, wanted.best_effort ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS);
  EXPECT_EQ(qos.history().kind, KEEP_LAST_HISTORY_QOS);
  EXPECT_EQ(qos.history().depth, wanted.depth);
  EXPECT_EQ(qos.durability().kind, wanted.latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS);
  EXPECT_EQ(qos.data_sharing().kind(), OFF);
  const auto& limits = qos.resource_limits();
  if (wanted.keyed) {  // any other choice leaves a reader matched and silent after ten keys
    EXPECT_EQ(limits.max_instances, 0);
    EXPECT_EQ(limits.max_samples, 0);
    EXPECT_EQ(limits.max_samples_per_instance, 1);
  } else {
    EXPECT_GE(limits.max_samples, limits.max_instances * limits.max_samples_per_instance);
    EXPECT_GE(limits.max_samples_per_instance, wanted.depth);
  }
  const auto user_data = qos.user_data().getValue();
  EXPECT_EQ(std::string(user_data.begin(), user_data.end()), "typehash=RIHS01_abc;");
}

TEST(EndpointQos, EveryProfileSetsEveryPolicy) {
  for (const auto& wanted : kProfiles) {
    expect_common(writer_qos(wanted, "RIHS01_abc"), wanted);
    expect_common(reader_qos(wanted, "RIHS01_abc"), wanted);
  }
}

TEST(EndpointQos, WritersOfferOnlyPlainCdr) {
  for (const auto& wanted : kProfiles) {
    const auto qos = writer_qos(wanted, "RIHS01_abc");
    ASSERT_EQ(qos.representation().m_value.size(), 1u);
    EXPECT_EQ(qos.representation().m_value[0], XCDR_DATA_REPRESENTATION);
  }
}

TEST(EndpointQos, LargeSamplesArePacedOnANetworkOnly) {
  for (const auto& wanted : kProfiles) {
    const auto on_host = writer_qos(wanted, "RIHS01_abc");
    EXPECT_EQ(on_host.publish_mode().kind, SYNCHRONOUS_PUBLISH_MODE);
    EXPECT_FALSE(on_host.reliable_writer_qos().disable_heartbeat_piggyback);
    const auto on_network = writer_qos(wanted, "RIHS01_abc", kNetworkLink);
    EXPECT_EQ(on_network.publish_mode().kind, wanted.large ? ASYNCHRONOUS_PUBLISH_MODE : SYNCHRONOUS_PUBLISH_MODE);
    EXPECT_EQ(on_network.reliable_writer_qos().disable_heartbeat_piggyback, wanted.large);
  }
}

TEST(EndpointQos, ImagesStayInTheHistoryForASecondOnANetwork) {
  EXPECT_EQ(writer_qos(kImage, "RIHS01_abc", kNetworkLink).history().depth, 30);
  EXPECT_EQ(reader_qos(kImage, "RIHS01_abc", kNetworkLink).history().depth, 30);
  EXPECT_EQ(writer_qos(kKeyedTiles, "RIHS01_abc", kNetworkLink).history().depth, 1);
}

}  // namespace
}  // namespace lapis::dds
