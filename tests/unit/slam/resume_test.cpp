// A map that is saved and resumed.
#include <gtest/gtest.h>

#include "slam/core/files/slam_file.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

constexpr int kSavedFrames = 50;  // of the run that is saved
const int kConfirmations = SlamConfig{}.relocalization.confirmations;

// The first frames in a saved map only say where the camera could be.
void expect_placed(const TrackingResult& result, int frame) {
  if (frame < kConfirmations) {
    EXPECT_EQ(result.state, TrackingState::kLost) << frame;
    EXPECT_EQ(result.reason, "looking for a place in the saved map: a recognised place awaits confirmation");
  } else {
    EXPECT_EQ(result.state, TrackingState::kTracking) << frame << ": " << result.reason;
  }
}

time::Time resume_stamp(int index) { return time::Time::from_seconds(1.0 + index / 30.0); }

RgbdFrame resume_frame(int index) {
  return test::render_room(test::small_camera(), test::room_path(index), resume_stamp(index));
}

double resume_distance_m(const TrackingResult& result, int index) {
  const Pose T_map_camera = result.T_map_keyframe * result.T_keyframe_camera;
  return (T_map_camera.translation() - test::room_path(index).translation()).norm();
}

// The bytes of a run through the room.
const std::vector<std::uint8_t>& saved_run() {
  static const std::vector<std::uint8_t> bytes = [] {
    RgbdSlam slam({}, test::room_path(0));
    for (int i = 0; i < kSavedFrames; ++i)
      EXPECT_EQ(slam.process(resume_frame(i)).state, TrackingState::kTracking) << i;
    return encode_slam_file({7, slam.state()});
  }();
  return bytes;
}

SlamState saved_state() {
  std::string error;
  auto file = decode_slam_file(saved_run(), error);
  EXPECT_TRUE(file) << error;
  return file->state;
}

TEST(Resume, AMapThatWasOnlyLoadedIsSavedAsItWas) {
  const RgbdSlam slam({}, Pose::Identity(), saved_state());
  EXPECT_EQ(encode_slam_file({7, slam.state()}), saved_run());
  EXPECT_EQ(slam.graph_version(), saved_state().graph_version);
  EXPECT_EQ(slam.pose_graph().nodes.size(), saved_state().keyframes.size());
  EXPECT_EQ(slam.pose_graph().edges.size(), saved_state().edges.size());
}

TEST(Resume, IsLostUntilItFindsItsPlaceAndThenContinues) {
  const SlamState saved = saved_state();
  RgbdSlam slam({}, Pose::Identity(), saved);
  RgbdFrame dark = resume_frame(kSavedFrames);
  dark.gray = geometry::GrayImage(dark.camera.width, dark.camera.height);
  const TrackingResult lost = slam.process(dark);
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_EQ(lost.reason, "looking for a place in the saved map: 0 features, 15 needed");
  EXPECT_EQ(slam.skip(resume_stamp(kSavedFrames), "no depth").reason, "looking for a place in the saved map: no depth");
  EXPECT_EQ(slam.graph_version(), saved.graph_version);

  for (int i = kSavedFrames; i < kSavedFrames + 30; ++i) {
    const TrackingResult result = slam.process(resume_frame(i));
    expect_placed(result, i - kSavedFrames);
    if (!has_pose(result)) continue;
    EXPECT_LT(resume_distance_m(result, i), 0.02) << i;
    EXPECT_TRUE(!result.is_keyframe || result.keyframe_id >= saved.keyframes.size()) << "an id is used again";
  }
  const PoseGraphSnapshot graph = slam.pose_graph();
  EXPECT_GT(graph.version, saved.graph_version);
  ASSERT_GT(graph.nodes.size(), saved.keyframes.size());
  EXPECT_EQ(graph.edges[saved.edges.size()].from, saved.keyframes.size() - 1) << "old and new map are joined";
  EXPECT_GT(slam.state().landmarks.size(), saved.landmarks.size());
  EXPECT_FALSE(find_fault(slam.state()));
}

TEST(Resume, StampsFromBeforeTheSavedOnesAreNoProblem) {
  RgbdSlam slam({}, Pose::Identity(), saved_state());
  for (int i = 0; i < 12; ++i) {
    RgbdFrame frame = resume_frame(kSavedFrames + i);
    frame.stamp = resume_stamp(i);
    const TrackingResult result = slam.process(frame);
    expect_placed(result, i);
    if (!has_pose(result)) continue;
    EXPECT_LT(resume_distance_m(result, kSavedFrames + i), 0.02) << i;
  }
}

// Odometry that was read before and after the stamp of the newest saved key-frame, in another run, does not say how the
// robot got from there to here.
TEST(Resume, NoOdometryLeadsFromASavedKeyframe) {
  const SlamState saved = saved_state();
  RgbdSlam slam({}, Pose::Identity(), saved);
  const auto is_odometry = [](const PoseGraphEdge& edge) { return edge.type == EdgeType::kWheelOdometry; };
  for (int i = kSavedFrames - 40; i < kSavedFrames + 100; ++i) {
    slam.add_odometry(resume_stamp(i), test::room_path(i));
    if (i >= kSavedFrames) slam.process(resume_frame(i));
  }
  const auto edges = slam.pose_graph().edges;
  const auto first = std::find_if(edges.begin(), edges.end(), is_odometry);
  ASSERT_NE(first, edges.end());
  EXPECT_GE(first->from, saved.keyframes.size());
}

TEST(Resume, AStateDoesNotChangeWhileTheMapContinues) {
  RgbdSlam slam({}, Pose::Identity(), saved_state());
  for (int i = kSavedFrames; i < kSavedFrames + 5; ++i) slam.process(resume_frame(i));
  const SlamState state = slam.state();
  const auto before = encode_slam_file({7, state});
  for (int i = kSavedFrames + 5; i < kSavedFrames + 25; ++i) slam.process(resume_frame(i));
  EXPECT_EQ(encode_slam_file({7, state}), before);
  EXPECT_NE(encode_slam_file({7, slam.state()}), before);
}

}  // namespace
}  // namespace lapis::slam
