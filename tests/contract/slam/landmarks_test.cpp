// What lapis_slam publishes of its landmarks: tiles and the state that announces them, read as a planner reads them.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <set>

#include "common/mapping/wire/landmark_mirror.hpp"
#include "common/messages/landmarks.hpp"
#include "common/messages/time.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/slam/slam_contract.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"

namespace lapis::test {
namespace {

using lapis_msgs::msg::LandmarkState;
using lapis_msgs::msg::LandmarkTile;
using lapis_msgs::msg::PoseGraph;
using lapis_msgs::msg::TrackedFrame;

const std::string kManyKeyframes = "slam.keyframe.max_translation_m=0.02";
const std::vector<std::string> kEveryVersion = {
    "--set", "slam.landmark_period_s=0", "--set", "slam.graph_period_s=0", "--set", kManyKeyframes};

/// Mirrors the landmarks and keeps the pose graphs that it has seen.
struct LandmarkClient {
  explicit LandmarkClient(TopicProbe& probe) : graphs(probe.collect(topics::kPoseGraph)) {
    probe.listen<LandmarkTile>(topics::kLandmarks, [this](auto& message) {
      auto tile = messages::from_message(message);
      ASSERT_TRUE(tile) << tile.reason;
      mirror.apply_tile(message.epoch(), std::move(*tile));
      epochs.insert(message.epoch());
    });
    probe.listen<LandmarkState>(topics::kLandmarkState, [this](auto& message) {
      stamps.push_back(messages::from_message(message.header().stamp()));
      mirror.apply_state(messages::from_message(message));
    });
  }
  /// True when all landmarks of the newest version that slam announced are here.
  bool is_up_to_date(const TrackedFrame& newest) const {
    return mirror.is_consistent() && mirror.state()->session == newest.session() &&
           mirror.state()->graph_version == newest.graph_version();
  }
  /// The pose graph of the mirror's version, if it has come.
  const PoseGraph* graph() const {
    const auto& state = *mirror.state();
    const auto it = std::find_if(graphs.begin(), graphs.end(), [&](const PoseGraph& graph) {
      return graph.session() == state.session && graph.version() == state.graph_version;
    });
    return it == graphs.end() ? nullptr : &*it;
  }

  const std::vector<PoseGraph>& graphs;
  mapping::LandmarkMirror mirror;
  std::set<std::int64_t> epochs;   // of all tiles that came
  std::vector<time::Time> stamps;  // of the announced versions
};

/// slam, a camera, and a reader that was there before the first landmark.
class SlamLandmarks : public ::testing::Test {
 protected:
  explicit SlamLandmarks(const std::vector<std::string>& arguments = kEveryVersion) : slam(kSlam, arguments) {}

  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(slam)) << slam.log();
    ASSERT_TRUE(probe.wait_until([&] { return feed.is_matched_by_slam(); })) << slam.log();
    ASSERT_TRUE(probe.wait_until_known_by("slam")) << slam.log();
  }
  /// Sends a frame; true when it was answered.
  bool track(int index, Seconds deadline = Seconds(10)) { return answers(feed.frame(index), index, deadline); }
  bool answers(const CameraFrame& frame, int index, Seconds deadline = Seconds(10)) {
    feed.send(frame);
    return probe.wait_until(
        [&] {
          return !frames.empty() && messages::from_message(frames.back().header().stamp()) == CameraFeed::stamp(index);
        },
        deadline);
  }
  /// Tracks frames from `index` on until a session after `session` has a few key-frames and the early reader has their
  /// landmarks. Frames that a slam which is just starting misses are followed by others.
  bool map_after(std::int64_t session, int& index) {
    const auto is_mapped = [&] {
      if (!track(index++, Seconds(0.5)) || frames.back().session() <= session) return false;
      if (!probe.wait_until([&] { return early.is_up_to_date(frames.back()); }, Seconds(2))) return false;
      return early.graph() != nullptr && early.graph()->nodes().size() >= 4;
    };
    return probe.wait_until(is_mapped, Seconds(30));
  }

  TopicProbe probe;
  CameraFeed feed{probe};
  const std::vector<TrackedFrame>& frames = probe.collect(topics::kTrackedFrame);
  LandmarkClient early{probe};
  ChildProcess slam;
};

/// A late joiner gets the same from slam as the early reader has.
void expect_same_for_a_late_joiner(const LandmarkClient& early, const TrackedFrame& newest) {
  TopicProbe late("late");
  const LandmarkClient client(late);
  ASSERT_TRUE(late.wait_until([&] { return client.is_up_to_date(newest) && client.graph() != nullptr; }));
  EXPECT_EQ(client.mirror.tiles(), early.mirror.tiles());
  EXPECT_EQ(client.epochs, std::set<std::int64_t>{client.mirror.state()->epoch})
      << "ended keys leave no samples behind";
}

/// The mirror's landmarks are on the walls of the synthetic box, each in one tile, and every key-frame of the pose
/// graph sees some. `first`: index of the frame at which the map began.
void expect_landmarks_of_the_box(const LandmarkClient& client, int first) {
  const geometry::Pose T_box_map = slow_motion(first) * T_base_camera().inverse();
  const auto& mirror = client.mirror;
  std::set<std::uint64_t> observers;
  std::set<std::uint32_t> ids;
  std::size_t landmarks = 0;
  std::size_t near_a_wall = 0;
  for (const auto& [index, tile] : mirror.tiles()) {
    observers.insert(tile.observers.begin(), tile.observers.end());
    ids.insert(tile.ids.begin(), tile.ids.end());
    for (const Eigen::Vector3f& p_map : tile.positions_m) {
      EXPECT_EQ(mapping::landmark_tile_of(p_map, mirror.state()->tile_edge_m), index);
      const Eigen::Vector3d p_box = T_box_map * p_map.cast<double>();
      const Eigen::Vector3d to_walls = (p_box.cwiseAbs() - Eigen::Vector3d(2.0, 1.5, 3.0)).cwiseAbs();
      near_a_wall += to_walls.minCoeff() < 0.05 ? 1 : 0;
      ++landmarks;
    }
  }
  EXPECT_EQ(ids.size(), landmarks) << "a landmark in two tiles";
  EXPECT_GT(landmarks, 100U);
  EXPECT_GT(static_cast<double>(near_a_wall), 0.95 * static_cast<double>(landmarks));
  std::set<std::uint64_t> keyframes;
  for (const auto& node : client.graph()->nodes()) keyframes.insert(node.id());
  EXPECT_EQ(observers, keyframes);
}

/// Index of the frame with which the session began.
int first_frame_of(std::int64_t session) {
  int index = 0;
  while (CameraFeed::stamp(index).nanoseconds < session) ++index;
  return index;
}

TEST_F(SlamLandmarks, FitThePoseGraphOfTheirVersionAndLateJoinersHaveThemAll) {
  int index = 0;
  ASSERT_TRUE(map_after(-1, index)) << slam.log();
  EXPECT_GE(early.stamps.size(), 4U) << "they came in several versions";
  expect_landmarks_of_the_box(early, 0);
  expect_same_for_a_late_joiner(early, frames.back());
}

TEST_F(SlamLandmarks, OfARestartedSlamReplaceAll) {
  int index = 0;
  ASSERT_TRUE(map_after(-1, index)) << slam.log();
  const auto old_session = early.mirror.state()->session;
  EXPECT_EQ(slam.stop(SIGKILL), -SIGKILL);
  ChildProcess second(kSlam, kEveryVersion);
  ASSERT_TRUE(wait_until_ready(second)) << second.log();
  ASSERT_TRUE(map_after(old_session, index)) << second.log();
  expect_landmarks_of_the_box(early, first_frame_of(early.mirror.state()->session));
  expect_same_for_a_late_joiner(early, frames.back());
}

TEST_F(SlamLandmarks, OfANewMapAfterStampsWentBackReplaceAll) {
  int index = 150;  // the wall is near; from frame 0 it is further away than a tile is long
  ASSERT_TRUE(map_after(-1, index)) << slam.log();
  const auto before = early.mirror.tiles();
  index = 0;
  ASSERT_TRUE(begin_anew(slam, feed, index, [this](const auto& frame, int i) { return answers(frame, i); }));
  const int first = index;
  ASSERT_TRUE(map_after(early.mirror.state()->session, index)) << slam.log();
  const auto is_left = [&](const auto& tile) { return early.mirror.tiles().contains(tile.first); };
  ASSERT_FALSE(std::all_of(before.begin(), before.end(), is_left)) << "the test needs a tile of the old map only";
  expect_landmarks_of_the_box(early, first);
  expect_same_for_a_late_joiner(early, frames.back());
}

class SlamLandmarkRate : public SlamLandmarks {
 protected:
  SlamLandmarkRate() : SlamLandmarks({"--set", kManyKeyframes}) {}
};

TEST_F(SlamLandmarkRate, IsOneVersionInTwoSecondsAndTheNewestAtTheEnd) {
  constexpr int kFrames = 70;  // 2.3 s
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(track(i)) << slam.log();
  EXPECT_EQ(slam.stop(SIGTERM), 0) << slam.log();
  ASSERT_TRUE(probe.wait_until([&] { return early.is_up_to_date(frames.back()); })) << slam.log();
  ASSERT_EQ(early.stamps.size(), 3U) << "the first, one 2 s later, the last";
  EXPECT_GE((early.stamps[1] - early.stamps[0]).seconds(), 2.0);
  EXPECT_EQ(early.stamps[2], CameraFeed::stamp(kFrames - 1));
}

}  // namespace
}  // namespace lapis::test
