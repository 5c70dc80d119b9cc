// What the components show on the wire, all of it: names, types and QoS are those of the topic table, and nobody but
// the evaluator reads ground truth. History depth is not on the wire; tests/unit/dds checks it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "common/topics.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/color_network.hpp"
#include "tests/support/endpoint_watcher.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/support/topic_probe.hpp"
#include "tests/unit/sensor_replay/synthetic_dataset.hpp"

namespace lapis::test {
namespace {

using ::testing::StartsWith;
using Lines = std::vector<std::string>;

// A line per endpoint: GoogleTest shows texts that differ as a list of what is missing and what is too much.
std::string line(const SeenEndpoint& seen) {
  return std::string(seen.is_writer ? "writes " : "reads ") + seen.topic + " " + seen.type +
         (seen.is_reliable ? " reliable" : " best-effort") + (seen.is_latched ? " latched" : "") +
         (seen.is_keyed ? " keyed " : " ") + seen.user_data;
}

template <class Message>
std::string line(bool is_writer, const std::string& dds_name, const dds::Qos& qos) {
  using Support = idl::TypeSupport<Message>;
  const std::string user_data = "typehash=" + std::string(Support::kHash) + ";";
  return line({is_writer, dds_name, Support::kDdsName, true, qos.latched, qos.keyed, user_data, {}});
}

template <class... Messages>
Lines writers(const dds::Topic<Messages>&... topics) {
  return {line<Messages>(true, dds::dds_name(topics, {}), topics.qos)...};
}

template <class... Messages>
Lines readers(const dds::Topic<Messages>&... topics) {
  return {line<Messages>(false, dds::dds_name(topics, {}), topics.qos)...};
}

template <class Service>
Lines server(const dds::ServiceTopic<Service>& service, const std::string& node = "") {
  using Support = idl::ServiceSupport<Service>;
  return {line<typename Support::Request>(false, dds::request_dds_name(node + service.name), dds::kService),
          line<typename Support::Response>(true, dds::reply_dds_name(node + service.name), dds::kService)};
}

/// What every process has as a node of ROS 2.
Lines node_endpoints(const std::string& name) {
  Lines lines = writers(topics::kRosout, topics::kParameterEvents);
  topics::for_each_node_service([&](const auto& service) {
    const Lines more = server(service, "/" + name);
    lines.insert(lines.end(), more.begin(), more.end());
  });
  return lines;
}

struct Process {
  std::string name;
  std::string component;
  Lines arguments;  ///< "DATASET" and "FOLDER" stand for a data set and a folder for results
  std::vector<Lines> endpoints;
};

void PrintTo(const Process& process, std::ostream* out) { *out << process.name; }

const std::vector<Lines> kReplay = {writers(topics::kColor, topics::kDepth, topics::kColorInfo, topics::kDepthInfo,
                                            topics::kLabels, topics::kLabelInfo, topics::kStaticTransforms,
                                            topics::kClock, topics::kGroundTruth)};

const std::vector<Lines> kSimulator = {kReplay[0],
                                       writers(topics::kWheelOdometry, topics::kTransforms, topics::kCollision),
                                       readers(topics::kCommand),
                                       server(topics::kPause),
                                       server(topics::kRun),
                                       server(topics::kStep),
                                       server(topics::kReset)};

std::vector<Lines> joined(std::vector<Lines> a, const std::vector<Lines>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::vector<Process> kProcesses = {
    {"slam",
     "slam",
     {},
     {readers(topics::kColor, topics::kDepth, topics::kColorInfo, topics::kDepthInfo, topics::kStaticTransforms,
              topics::kWheelOdometry),
      writers(topics::kSlamOdometry, topics::kTrackedFrame, topics::kTransforms, topics::kKeyframePath,
              topics::kPoseGraph, topics::kLandmarks, topics::kLandmarkState, topics::kSlamStatus)}},
    {"segmenter",
     "segmenter",
     {"FOLDER/model.yaml"},
     {readers(topics::kColor), writers(topics::kLabels, topics::kLabelConfidence, topics::kLabelInfo)}},
    {"segmenter_of_compressed_images",
     "segmenter",
     {"FOLDER/model.yaml", "--set", "dds.color_transport=compressed"},
     {readers(topics::kCompressedColor), writers(topics::kLabels, topics::kLabelConfidence, topics::kLabelInfo)}},
    {"semantic_mapper",
     "semantic_mapper",
     {},
     {readers(topics::kTrackedFrame, topics::kDepth, topics::kLabels, topics::kLabelConfidence, topics::kColorInfo,
              topics::kDepthInfo, topics::kDepthEstimate, topics::kStaticTransforms, topics::kLabelInfo,
              topics::kPoseGraph),
      writers(topics::kMapDescription, topics::kVoxelTiles, topics::kMapState, topics::kObstacles,
              topics::kProvisionalArea, topics::kOctomap, topics::kMapPoints, topics::kOccupancyGrid),
      server(topics::kSaveMap)}},
    {"evaluator",
     "evaluator",
     {"--set", "evaluator.output_dir=FOLDER"},
     {readers(topics::kTrackedFrame, topics::kGroundTruth, topics::kCollision, topics::kDepth, topics::kLabels,
              topics::kColorInfo, topics::kDepthInfo, topics::kDepthEstimate, topics::kStaticTransforms,
              topics::kPoseGraph, topics::kVoxelTiles, topics::kMapState, topics::kDiagnostics, topics::kMapDescription,
              topics::kPlannerStatus, topics::kSlamOdometry)}},
    {"planner",
     "planner",
     {},
     {readers(topics::kMapDescription, topics::kVoxelTiles, topics::kMapState, topics::kObstacles,
              topics::kProvisionalArea, topics::kPoseGraph, topics::kLandmarks, topics::kLandmarkState,
              topics::kTrackedFrame, topics::kSlamOdometry, topics::kSlamStatus, topics::kControllerStatus,
              topics::kGoal),
      writers(topics::kPlannerPath, topics::kCandidates, topics::kPlannerMarkers, topics::kPlannerStatus),
      server(topics::kStartExploring), server(topics::kStopExploring), server(topics::kPauseExploring),
      server(topics::kReturnHome)}},
    {"controller",
     "controller",
     {},
     {readers(topics::kSlamOdometry, topics::kTrackedFrame, topics::kDepth, topics::kDepthInfo,
              topics::kStaticTransforms, topics::kPlannerPath, topics::kPlannerStatus, topics::kOccupancyGrid,
              topics::kObstacles, topics::kTeleop),
      writers(topics::kCommand, topics::kLocalPath, topics::kControllerStatus)}},
    {"replay_at_a_rate",
     "sensor_replay",
     {"DATASET", "--rate", "1", "--set", "sensor_replay.wait_for_readers=1"},
     kReplay},
    {"replay_without_labels",
     "sensor_replay",
     {"DATASET", "--rate", "1", "--set", "sensor_replay.wait_for_readers=1", "--set", "sensor_replay.labels=false"},
     {writers(topics::kColor, topics::kDepth, topics::kColorInfo, topics::kDepthInfo, topics::kStaticTransforms,
              topics::kClock, topics::kGroundTruth)}},
    {"replay_in_lockstep", "sensor_replay", {"DATASET"}, {kReplay[0], writers(topics::kTick), readers(topics::kAck)}},
    {"simulator_with_a_run_folder",
     "simulator",
     {"FOLDER/scene.yaml", "--mode", "freerun", "--set", "simulator.output_dir=FOLDER"},
     joined(kSimulator, {readers(topics::kMapDescription)})},
    {"simulator_by_the_wall_clock", "simulator", {"FOLDER/scene.yaml", "--mode", "freerun"}, kSimulator},
    {"simulator_without_labels",
     "simulator",
     {"FOLDER/scene.yaml", "--mode", "freerun", "--set", "simulator.labels=false"},
     {writers(topics::kColor, topics::kDepth, topics::kColorInfo, topics::kDepthInfo, topics::kStaticTransforms,
              topics::kClock, topics::kGroundTruth, topics::kWheelOdometry, topics::kTransforms, topics::kCollision),
      readers(topics::kCommand), server(topics::kPause), server(topics::kRun), server(topics::kStep),
      server(topics::kReset)}},
    {"simulator_in_lockstep_with_imu",
     "simulator",
     {"FOLDER/scene.yaml", "--set", "simulator.imu=true"},
     joined(kSimulator, {writers(topics::kTick, topics::kImu), readers(topics::kAck)})}};

class Endpoints : public ::testing::TestWithParam<Process> {
 protected:
  Lines arguments() const {
    Lines words = GetParam().arguments;
    for (auto& word : words) {
      for (const std::string place : {"DATASET", "FOLDER"}) {
        const auto at = word.find(place);
        if (at != std::string::npos) word.replace(at, place.size(), folder_.path().string());
      }
    }
    return words;
  }
  static Lines expected() {
    Lines lines = writers(topics::kDiagnostics, topics::kHeartbeat, topics::kAck, kRosGraph);
    for (const Lines& more : {readers(topics::kTick), node_endpoints(GetParam().component)}) {
      lines.insert(lines.end(), more.begin(), more.end());
    }
    for (const Lines& more : GetParam().endpoints) lines.insert(lines.end(), more.begin(), more.end());
    return lines;
  }
  static std::string sorted_text(Lines lines) {
    std::sort(lines.begin(), lines.end());
    std::string text;
    for (const auto& one : lines) text += one + "\n";
    return text;
  }

  sensor_replay::test::TemporaryFolder folder_;
};

TEST_P(Endpoints, AreThoseOfTheTopicTableAndNoOthers) {
  sensor_replay::test::write_dataset(folder_.path(), 2);
  write_small_scene(folder_.path());
  write_color_model(folder_.path(), {.colors = {{200, 0, 0}, {0, 0, 200}}});
  TopicProbe probe;
  const EndpointWatcher watcher(probe.participant());
  const auto& graph = probe.collect(kRosGraph);
  ChildProcess process("lapis_" + GetParam().component, arguments());
  // The node lists what it has, but for the writer of that list, when all of it exists.
  const auto is_complete = [&] {
    if (graph.empty() || graph.back().node_entities_info_seq().empty()) return false;
    const auto& node = graph.back().node_entities_info_seq()[0];
    return watcher.endpoints().size() > node.reader_gid_seq().size() + node.writer_gid_seq().size();
  };
  ASSERT_TRUE(probe.wait_until(is_complete)) << process.log();
  EXPECT_EQ(graph.back().node_entities_info_seq()[0].node_name(), GetParam().component);
  Lines seen;
  for (const auto& endpoint : watcher.endpoints()) seen.push_back(line(endpoint));
  EXPECT_EQ(sorted_text(seen), sorted_text(expected()));
  if (GetParam().component == "evaluator") return;
  for (const auto& endpoint : seen) EXPECT_THAT(endpoint, Not(StartsWith("reads rt/ground_truth/")));
}

INSTANTIATE_TEST_SUITE_P(Components, Endpoints, ::testing::ValuesIn(kProcesses),
                         [](const auto& process) { return process.param.name; });

}  // namespace
}  // namespace lapis::test
