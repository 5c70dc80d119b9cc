// A best-effort camera on Cyclone DDS feeds slam and mapper on the wall clock.
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/topics/diagnostics.hpp"
#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

/// What ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST is for Cyclone DDS.
constexpr const char* kLoopback =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
    "</Domain></CycloneDDS>";

TEST(Cyclone, BestEffortCameraIsTrackedAndMapped) {
  setenv("CYCLONEDDS_URI", kLoopback, 1);  // NOLINT(concurrency-mt-unsafe): before any thread starts
  TopicProbe probe;
  const auto& frames = probe.collect(topics::kTrackedFrame);
  const auto& map = probe.collect(topics::kMapState);
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess slam("lapis_slam");
  ChildProcess mapper("lapis_semantic_mapper");
  ASSERT_TRUE(wait_until_ready(slam) && wait_until_ready(mapper)) << slam.log() << mapper.log();
  ChildProcess camera("lapis_test_cyclone_camera");
  const auto logs = [&] { return camera.log() + slam.log() + mapper.log(); };
  for (ChildProcess* process : {&slam, &mapper}) {
    EXPECT_TRUE(process->wait_for_line("rt/camera/depth/image_raw: a writer is BEST_EFFORT")) << logs();
  }
  ASSERT_TRUE(probe.wait_until([&] { return frames.size() >= 20; }, Seconds(20))) << logs();
  for (const auto& frame : frames) {
    EXPECT_EQ(frame.state(), lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING) << frame.reason();
  }
  EXPECT_TRUE(probe.wait_until([&] { return !map.empty() && map.back().version() > 0; }, Seconds(20))) << logs();
  EXPECT_TRUE(probe.wait_until([&] {
    return newest_values(diagnostics, "semantic_mapper").contains("best effort rt/camera/depth/image_raw");
  })) << logs();
  EXPECT_EQ(camera.stop(SIGTERM), 0) << camera.log();
}

}  // namespace
}  // namespace lapis::test
