// What every process promises on the wire: names, types, QoS, the ROS 2 graph, latched and keyed data, diagnostics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <set>

#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/map.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/endpoint_watcher.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kEcho = "lapis_test_echo";
constexpr const char* kEchoNode = "test_echo";

// What discovery says of an endpoint against the topic table. History depth is not on the wire, so a remote participant
// cannot check it; tests/unit/dds does.
template <class Message>
void expect_endpoint(const EndpointWatcher& watcher, bool is_writer, const dds::Topic<Message>& topic,
                     const std::string& name_space = "") {
  const std::string name = dds::dds_name(topic, {name_space, {}});
  const auto seen = is_writer ? watcher.writer(name) : watcher.reader(name);
  ASSERT_TRUE(seen) << (is_writer ? "writer of " : "reader of ") << name;
  EXPECT_EQ(seen->type, idl::TypeSupport<Message>::kDdsName) << name;
  EXPECT_TRUE(seen->is_reliable) << name;
  EXPECT_EQ(seen->is_latched, topic.qos.latched) << name;
  EXPECT_EQ(seen->user_data, "typehash=" + std::string(idl::TypeSupport<Message>::kHash) + ";") << name;
}

void expect_echo_endpoints(const EndpointWatcher& watcher, const std::string& name_space) {
  expect_endpoint(watcher, true, topics::kSlamOdometry, name_space);
  expect_endpoint(watcher, true, topics::kKeyframePath, name_space);
  expect_endpoint(watcher, true, topics::kVoxelTiles, name_space);
  expect_endpoint(watcher, true, topics::kDiagnostics, name_space);
  expect_endpoint(watcher, true, topics::kAck, name_space);
  expect_endpoint(watcher, false, topics::kColor, name_space);
  expect_endpoint(watcher, false, topics::kTick, name_space);
}

std::set<dds::Gid> gids(const std::vector<rmw_dds_common::msg::Gid>& list) {
  std::set<dds::Gid> out;
  for (const auto& gid : list) out.insert(gid.data());
  return out;
}

sensor_msgs::msg::Image image(std::int64_t stamp_ns, std::size_t bytes) {
  sensor_msgs::msg::Image message;
  message.header().stamp(messages::to_message(time::Time{stamp_ns}));
  message.data().resize(bytes);
  return message;
}

TEST(Wire, EndpointsAreThoseOfTheTopicTable) {
  TopicProbe probe;
  const EndpointWatcher watcher(probe.participant());
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  const auto graph_topic = [&] { return watcher.writer("ros_discovery_info") && watcher.reader("rt/sim/tick"); };
  ASSERT_TRUE(probe.wait_until(graph_topic));
  ASSERT_TRUE(probe.wait_until([&] { return watcher.endpoints().size() >= 10; })) << watcher.endpoints().size();
  expect_echo_endpoints(watcher, "");
  const auto request = watcher.reader("rq/semantic_mapper/saveRequest");
  const auto reply = watcher.writer("rr/semantic_mapper/saveReply");
  ASSERT_TRUE(request && reply);
  EXPECT_EQ(request->type, "std_srvs::srv::dds_::Trigger_Request_");
  EXPECT_EQ(reply->type, "std_srvs::srv::dds_::Trigger_Response_");
}

TEST(Wire, ParticipantIsARos2Node) {
  TopicProbe probe;
  const EndpointWatcher watcher(probe.participant());
  const auto& graph = probe.collect(kRosGraph);
  ChildProcess echo(kEcho, {"--namespace", "robot1"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until([&] { return !graph.empty() && watcher.endpoints().size() >= 10; }));
  ASSERT_TRUE(probe.wait_until([&] { return watcher.participants().size() == 1u; }));
  EXPECT_EQ(watcher.participants()[0].user_data, "enclave=/;");
  EXPECT_EQ(graph.back().gid().data(), watcher.participants()[0].gid);
  ASSERT_EQ(graph.back().node_entities_info_seq().size(), 1u);
  const auto& node = graph.back().node_entities_info_seq()[0];
  EXPECT_EQ(node.node_name(), "test_echo");
  EXPECT_EQ(node.node_namespace(), "/robot1");
  // Every endpoint belongs to the node, in the right list; ros_discovery_info itself belongs to the middleware.
  std::set<dds::Gid> readers;
  std::set<dds::Gid> writers;
  for (const auto& endpoint : watcher.endpoints()) {
    if (endpoint.topic != "ros_discovery_info") (endpoint.is_writer ? writers : readers).insert(endpoint.gid);
  }
  EXPECT_EQ(gids(node.reader_gid_seq()), readers);
  EXPECT_EQ(gids(node.writer_gid_seq()), writers);
}

TEST(Wire, NodeWithoutNamespaceIsInTheRoot) {
  TopicProbe probe;
  const auto& graph = probe.collect(kRosGraph);
  ChildProcess echo(kEcho);
  ASSERT_TRUE(probe.wait_until([&] { return !graph.empty(); })) << echo.log();
  EXPECT_EQ(graph.back().node_entities_info_seq().at(0).node_namespace(), "/");
}

TEST(Wire, NamespacePrefixesNamesAndFramesButNotGlobalTopics) {
  TopicProbe probe("probe", "robot1");
  const EndpointWatcher watcher(probe.participant());
  auto& color = probe.advertise(topics::kColor);
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  ChildProcess echo(kEcho, {"--namespace", "robot1"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until_matched() && probe.wait_until_known_by(kEchoNode)) << echo.log();
  ASSERT_TRUE(probe.wait_until([&] { return watcher.endpoints().size() >= 10; }));
  expect_echo_endpoints(watcher, "robot1");
  EXPECT_TRUE(watcher.writer("rt/robot1/slam/odometry"));
  EXPECT_TRUE(watcher.writer("robot1/lapis/semantic_mapper/tiles"));
  EXPECT_TRUE(watcher.writer("rt/diagnostics"));
  color.publish(image(1'000, 10));
  ASSERT_TRUE(probe.wait_until([&] { return !odometry.empty(); }));
  EXPECT_EQ(odometry[0].header().frame_id(), "robot1/map");
  EXPECT_EQ(odometry[0].child_frame_id(), "robot1/base_link");
}

TEST(Wire, ImagesOfAMegabyteArriveWholeAndStampsAreCopied) {
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until_matched() && probe.wait_until_known_by(kEchoNode)) << echo.log();
  for (std::int64_t i = 1; i <= 20; ++i) {
    color.publish(image(i * 33'333'333, 1'000'000));
    const auto count = static_cast<std::size_t>(i);
    ASSERT_TRUE(probe.wait_until([&] { return odometry.size() >= count; })) << i << "\n" << echo.log();
    EXPECT_EQ(messages::from_message(odometry.back().header().stamp()).nanoseconds, i * 33'333'333);
    EXPECT_EQ(odometry.back().pose().pose().position().x(), 1e6);
  }
}

/// A sensor of another make.
dds::ParticipantOptions best_effort_sensor() {
  auto options = participant_options("sensor");
  options.sensor_qos = dds::SensorQos::kBestEffort;
  return options;
}

TEST(BestEffort, SensorIsHeardAndTheGraphAndTheDiagnosticsTell) {
  TopicProbe sensor(best_effort_sensor());
  TopicProbe probe;
  const EndpointWatcher watcher(probe.participant());
  const auto& graph = probe.collect(kRosGraph);
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  auto& color = sensor.advertise(topics::kColor);
  const auto& odometry = sensor.collect(topics::kSlamOdometry);
  ChildProcess echo(kEcho);
  ASSERT_TRUE(echo.wait_for_line("rt/camera/color/image_raw: a writer is BEST_EFFORT")) << echo.log();
  ASSERT_TRUE(sensor.wait_until_matched() && sensor.wait_until_known_by(kEchoNode)) << echo.log();
  for (std::int64_t i = 1; i <= 10; ++i) {
    const std::size_t before = odometry.size();
    color.publish(image(i * 33'333'333, 1'000'000));
    ASSERT_TRUE(sensor.wait_until([&] { return odometry.size() > before; })) << i << echo.log();
  }
  const auto told = [&] {
    return newest_values(diagnostics, kEchoNode).contains("best effort rt/camera/color/image_raw");
  };
  EXPECT_TRUE(probe.wait_until(told)) << echo.log();
  EXPECT_EQ(sum_of(newest_values(diagnostics, kEchoNode), "incompatible QoS"), 0.0);
  const auto is_announced = [&] {
    const auto announced = gids(graph.back().node_entities_info_seq().at(0).reader_gid_seq());
    const auto endpoints = watcher.endpoints();
    return std::any_of(endpoints.begin(), endpoints.end(), [&](const SeenEndpoint& endpoint) {
      return endpoint.topic == "rt/camera/color/image_raw" && !endpoint.is_reliable && announced.contains(endpoint.gid);
    });
  };
  EXPECT_TRUE(probe.wait_until(is_announced));
}

TEST(BestEffort, ReliableSensorThatComesLaterIsHeardToo) {
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  {
    TopicProbe sensor(best_effort_sensor());
    sensor.advertise(topics::kColor);
    ASSERT_TRUE(echo.wait_for_line("a writer is BEST_EFFORT")) << echo.log();
    ASSERT_TRUE(sensor.wait_until_matched()) << echo.log();
  }
  TopicProbe sensor;
  auto& color = sensor.advertise(topics::kColor);
  const auto& odometry = sensor.collect(topics::kSlamOdometry);
  ASSERT_TRUE(sensor.wait_until_matched() && sensor.wait_until_known_by(kEchoNode)) << echo.log();
  color.publish(image(1'000, 100));
  EXPECT_TRUE(sensor.wait_until([&] { return !odometry.empty(); })) << echo.log();
}

TEST(BestEffort, IsRefusedAndCountedWhereReliableIsAskedFor) {
  TopicProbe sensor(best_effort_sensor());
  const auto& diagnostics = sensor.collect(topics::kDiagnostics);
  auto& color = sensor.advertise(topics::kColor);
  ChildProcess echo(kEcho, {"--set", "dds.sensor_qos=reliable"});
  ASSERT_TRUE(echo.wait_for_line("rt/camera/color/image_raw: a peer was refused because of its QoS")) << echo.log();
  EXPECT_TRUE(sensor.wait_until(
      [&] { return sum_of(newest_values(diagnostics, kEchoNode), "incompatible QoS rt/camera/color") == 1.0; }));
  EXPECT_EQ(color.matched(), 0u);
}

TEST(BestEffort, IsReadFromTheBeginningWhereItIsAskedFor) {
  TopicProbe sensor(best_effort_sensor());
  auto& color = sensor.advertise(topics::kColor);
  const auto& odometry = sensor.collect(topics::kSlamOdometry);
  ChildProcess echo(kEcho, {"--set", "dds.sensor_qos=best_effort"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(sensor.wait_until_matched() && sensor.wait_until_known_by(kEchoNode)) << echo.log();
  color.publish(image(1'000, 1'000'000));
  EXPECT_TRUE(sensor.wait_until([&] { return !odometry.empty(); })) << echo.log();
}

TEST(Wire, RemappedTopicsAndFramesHaveTheirOtherNames) {
  TopicProbe probe("probe", "robot1");
  const EndpointWatcher watcher(probe.participant());
  ChildProcess echo(kEcho, {"--namespace", "robot1", "--set", "dds.remap=[/camera/color/image_raw:=/rgb/image_raw]",
                            "--remap", "/slam/odometry:=/pose", "--remap", "base_link:=base_footprint"});
  const dds::Topic<sensor_msgs::msg::Image> other{"/rgb/image_raw", topics::kColor.qos, "", "", ""};
  const dds::Topic<nav_msgs::msg::Odometry> pose{"/pose", topics::kSlamOdometry.qos, "", "", ""};
  auto& color = probe.advertise(other);
  const auto& odometry = probe.collect(pose);
  ASSERT_TRUE(probe.wait_until_matched() && probe.wait_until_known_by(kEchoNode)) << echo.log();
  EXPECT_FALSE(watcher.reader("rt/robot1/camera/color/image_raw"));
  color.publish(image(1'000, 10));
  ASSERT_TRUE(probe.wait_until([&] { return !odometry.empty(); })) << echo.log();
  EXPECT_EQ(odometry[0].header().frame_id(), "robot1/map");
  EXPECT_EQ(odometry[0].child_frame_id(), "robot1/base_footprint");
}

TEST(Wire, LateJoinerGetsTheLastLatchedSample) {
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  TopicProbe late;
  const auto& path = late.collect(topics::kKeyframePath);
  ASSERT_TRUE(late.wait_until([&] { return !path.empty(); })) << echo.log();
  EXPECT_EQ(path[0].poses().size(), 3u) << "keep last 1: only the newest of the three";
}

TEST(Wire, LateJoinerGetsEveryKey) {
  constexpr std::size_t kTiles = 300;  // more than the default limit of ten instances
  ChildProcess echo(kEcho, {"--set", "test_echo.tiles=" + std::to_string(kTiles)});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  TopicProbe late;
  std::map<int, std::size_t> tiles;
  late.listen<lapis_msgs::msg::VoxelTile>(topics::kVoxelTiles,
                                          [&](auto& tile) { tiles[tile.x()] = tile.data().size(); });
  ASSERT_TRUE(late.wait_until([&] { return tiles.size() == kTiles; }))
      << tiles.size() << " of " << kTiles << " tiles came\n"
      << echo.log();
  EXPECT_TRUE(std::all_of(tiles.begin(), tiles.end(), [](const auto& tile) { return tile.second == 4096; }));
}

TEST(Wire, ServiceAnswersEveryCallOfEveryClient) {
  ChildProcess echo(kEcho, {"--set", "test_echo.greeting=saved"});
  TopicProbe probe;
  auto& first = probe.client(topics::kSaveMap);
  auto& second = probe.client(topics::kSaveMap);
  ASSERT_TRUE(probe.wait_until([&] { return first.is_ready() && second.is_ready(); })) << echo.log();
  std::vector<std::pair<dds::ServiceClient<std_srvs::srv::Trigger>*, std::uint64_t>> calls;
  for (int i = 0; i < 3; ++i) {
    for (auto* client : {&first, &second}) {
      const auto number = client->call({});
      ASSERT_TRUE(number);
      calls.emplace_back(client, *number);
    }
  }
  for (const auto& call : calls) {
    auto& client = call.first;
    const auto number = call.second;
    std::optional<std_srvs::srv::Trigger_Response> reply;
    ASSERT_TRUE(probe.wait_until([&] { return (reply = client->take_reply(number)).has_value(); })) << echo.log();
    EXPECT_TRUE(reply->success());
    EXPECT_EQ(reply->message(), "saved");
    EXPECT_FALSE(client->take_reply(number)) << "each reply can be taken once";
  }
}

// A client whose readers are only just being discovered must get its answer, too.
TEST(Wire, ServiceAnswersAClientThatCallsAsSoonAsItCan) {
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  for (int i = 0; i < 5; ++i) {
    TopicProbe probe;
    auto& client = probe.client(topics::kSaveMap);
    ASSERT_TRUE(probe.wait_until([&] { return client.is_ready(); }));
    const auto number = client.call({});
    ASSERT_TRUE(number);
    std::optional<std_srvs::srv::Trigger_Response> reply;
    ASSERT_TRUE(probe.wait_until([&] { return (reply = client.take_reply(*number)).has_value(); })) << i;
  }
}

TEST(Wire, DiagnosticsComeOnceASecondAndCount) {
  TopicProbe probe;
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  auto& color = probe.advertise(topics::kColor);
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until_matched() && probe.wait_until_known_by(kEchoNode)) << echo.log();
  color.publish(image(2'000, 10));
  ASSERT_TRUE(probe.wait_until([&] { return !odometry.empty(); }));
  color.publish(image(2'000, 10));
  color.publish(image(1'000, 10));
  const std::size_t seen = diagnostics.size();
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(probe.wait_until([&] { return diagnostics.size() >= seen + 4; }));
  const Seconds elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_GE(elapsed.count(), 2.5) << "4 in more than 2.5 s";
  const auto& status = diagnostics.back().status().at(0);
  EXPECT_EQ(status.name(), "test_echo");
  std::map<std::string, std::string> values;
  for (const auto& pair : status.values()) values[pair.key()] = pair.value();
  EXPECT_EQ(values["images"], "1") << echo.log();
  EXPECT_EQ(values["images dropped"], "2");
  EXPECT_TRUE(values.contains("cpu_s") && values.contains("peak_rss_mb"));
  const auto stamp = messages::from_message(diagnostics.back().header().stamp());
  EXPECT_GT(stamp.nanoseconds, 0);
}

TEST(Wire, SimulatedTimeComesFromClock) {
  TopicProbe probe;
  const auto& diagnostics = probe.collect(topics::kDiagnostics);
  auto& clock = probe.advertise(topics::kClock);
  ChildProcess echo(kEcho, {"--use-sim-time"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until_matched());
  rosgraph_msgs::msg::Clock now;
  now.clock(messages::to_message(time::Time{42'500'000'000}));
  clock.publish(now);
  EXPECT_TRUE(probe.wait_until([&] {
    return !diagnostics.empty() &&
           messages::from_message(diagnostics.back().header().stamp()).nanoseconds == 42'500'000'000;
  })) << echo.log();
}

TEST(Wire, PeerThatLeavesAndComesBackIsFoundAgain) {
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  for (int life = 0; life < 3; ++life) {
    TopicProbe peer;
    auto& color = peer.advertise(topics::kColor);
    const auto& odometry = peer.collect(topics::kSlamOdometry);
    ASSERT_TRUE(peer.wait_until_matched() && peer.wait_until_known_by(kEchoNode)) << echo.log();
    color.publish(image((life + 1) * 1'000'000, 100));
    EXPECT_TRUE(peer.wait_until([&] { return !odometry.empty(); })) << echo.log();
  }
}

TEST(Wire, RestartedProcessIsFoundAgain) {
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  const auto& odometry = probe.collect(topics::kSlamOdometry);
  for (int life = 0; life < 3; ++life) {
    ChildProcess echo(kEcho);
    ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
    const auto before = odometry.size();
    const auto begin = std::chrono::steady_clock::now();
    std::int64_t stamp = 0;
    // Repeated, because a VOLATILE sample from before the match is nobody's.
    ASSERT_TRUE(probe.wait_until([&] {
      color.publish(image(++stamp, 100));
      return odometry.size() > before;
    })) << echo.log();
    EXPECT_LT(Seconds(std::chrono::steady_clock::now() - begin).count(), 3.0);
    EXPECT_EQ(echo.stop(SIGKILL), -SIGKILL);
  }
}

}  // namespace
}  // namespace lapis::test
