// A map that is saved and resumed.
#include <algorithm>
#include <set>

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

SlamFile file_of(SlamState state) { return {7, 7, {}, std::move(state)}; }

// The bytes of a run through the room.
const std::vector<std::uint8_t>& saved_run() {
  static const std::vector<std::uint8_t> bytes = [] {
    RgbdSlam slam({}, test::room_path(0));
    for (int i = 0; i < kSavedFrames; ++i)
      EXPECT_EQ(slam.process(resume_frame(i)).state, TrackingState::kTracking) << i;
    return encode_slam_file(file_of(slam.state()));
  }();
  return bytes;
}

SlamState whole_saved_state() {
  std::string error;
  auto file = decode_slam_file(saved_run(), error);
  EXPECT_TRUE(file) << error;
  return file->state;
}

// The same in a later run, in which nobody knows how the robot has moved since.
SlamState saved_state() {
  SlamState state = whole_saved_state();
  state.motion.reset();
  return state;
}

TEST(Resume, AMapThatWasOnlyLoadedIsSavedAsItWas) {
  const RgbdSlam slam({}, Pose::Identity(), whole_saved_state());
  EXPECT_EQ(encode_slam_file(file_of(slam.state())), saved_run());
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

// A run with odometry, saved at a frame that is no key-frame.
SlamState state_with_odometry(int frames) {
  RgbdSlam slam({}, test::room_path(0));
  slam.add_odometry(resume_stamp(-1), test::room_path(-1));
  for (int i = 0; i < frames; ++i) {
    slam.add_odometry(resume_stamp(i), test::room_path(i));
    EXPECT_EQ(slam.process(resume_frame(i)).state, TrackingState::kTracking) << i;
  }
  std::string error;
  const auto file = decode_slam_file(encode_slam_file(file_of(slam.state())), error);
  EXPECT_TRUE(file) << error;
  return file->state;
}

// Dies at frame 50 and is back at frame 110: the two seconds between are bridged by odometry, so the first frame has a
// pose, also one that shows nothing, and no place has to be recognised.
TEST(Resume, WithinTheRunOdometryLeadsOnFromTheSavedPose) {
  constexpr int kBack = kSavedFrames + 60;
  const SlamState saved = state_with_odometry(kSavedFrames);
  ASSERT_TRUE(saved.motion);
  EXPECT_EQ(saved.motion->stamp, resume_stamp(kSavedFrames - 1));
  RgbdSlam slam({}, Pose::Identity(), saved);
  slam.add_odometry(resume_stamp(kBack), test::room_path(kBack));
  RgbdFrame dark = resume_frame(kBack);
  dark.gray = geometry::GrayImage(dark.camera.width, dark.camera.height);
  dark.depth = geometry::DepthImage(dark.camera.width, dark.camera.height);
  const TrackingResult reckoned = slam.process(dark);
  EXPECT_EQ(reckoned.state, TrackingState::kDeadReckoning) << reckoned.reason;
  EXPECT_LT(resume_distance_m(reckoned, kBack), 0.02);
  EXPECT_GT(reckoned.drift_m, 0.0);
  for (int i = kBack + 1; i < kBack + 20; ++i) {
    slam.add_odometry(resume_stamp(i), test::room_path(i));
    const TrackingResult result = slam.process(resume_frame(i));
    EXPECT_EQ(result.state, TrackingState::kTracking) << i << ": " << result.reason;
    EXPECT_LT(resume_distance_m(result, i), 0.02) << i;
  }
  const auto edges = slam.pose_graph().edges;
  const bool is_joined = std::any_of(edges.begin(), edges.end(), [&](const PoseGraphEdge& edge) {
    return edge.type == EdgeType::kWheelOdometry && edge.from == saved.keyframes.size() - 1 &&
           edge.to == saved.keyframes.size();
  });
  EXPECT_TRUE(is_joined) << "odometry joins the last saved key-frame and the first new one";
}

TEST(Resume, AfterALongOutageOrAResetOfOdometryThePlaceHasToBeFound) {
  const SlamState saved = state_with_odometry(kSavedFrames);
  const auto first_result = [&](time::Time stamp, const Pose& T_odom_base) {
    RgbdSlam slam({}, Pose::Identity(), saved);
    slam.add_odometry(stamp, T_odom_base);
    return slam.skip(stamp, "dark");
  };
  const time::Time soon = resume_stamp(kSavedFrames + 60);
  EXPECT_EQ(first_result(soon, test::room_path(kSavedFrames + 60)).state, TrackingState::kDeadReckoning);
  const time::Time late = resume_stamp(kSavedFrames) + time::Duration::from_seconds(OdometryTrack::kLongestOutage_s);
  EXPECT_EQ(first_result(late, test::room_path(kSavedFrames)).state, TrackingState::kLost);
  Pose far_away = test::room_path(kSavedFrames);
  far_away.translation().x() += 3.0;
  EXPECT_EQ(first_result(soon, far_away).state, TrackingState::kLost);
  ASSERT_GT(saved.motion->odometry.back().T_odom_base.translation().norm(), 0.1);
  EXPECT_EQ(first_result(soon, Pose::Identity()).state, TrackingState::kLost) << "odometry began anew, not far away";
}

TEST(PublishedIds, AreIndicesUntilAMapIsResumedAndNeverTheSameAgain) {
  PublishedIds ids;
  EXPECT_EQ(ids.of(0), 0U);
  EXPECT_EQ(ids.of(123), 123U);
  std::set<std::uint64_t> published;
  std::uint64_t saved = 0;
  for (int restart = 0; restart < 5; ++restart) {
    for (std::uint64_t i = 0; i < 10; ++i) {
      EXPECT_TRUE(published.insert(ids.of(saved + i)).second) << restart << " " << i;
    }
    saved += static_cast<std::uint64_t>(restart % 3 == 0 ? 0 : 6);  // of ten new ones so many were saved
    ids.skip(saved);
    EXPECT_TRUE(ids.are_sound());
    for (std::uint64_t i = 1; i < saved + 3; ++i) EXPECT_GT(ids.of(i), ids.of(i - 1));
  }
  EXPECT_FALSE((PublishedIds{{{5, 10}, {4, 20}}}.are_sound()));
  EXPECT_FALSE((PublishedIds{{{5, 10}, {20, 12}}}.are_sound()));
  EXPECT_FALSE((PublishedIds{{{5, PublishedIds::kEnd}}}.are_sound()));
}

TEST(Resume, AStateDoesNotChangeWhileTheMapContinues) {
  RgbdSlam slam({}, Pose::Identity(), saved_state());
  for (int i = kSavedFrames; i < kSavedFrames + 5; ++i) slam.process(resume_frame(i));
  const SlamState state = slam.state();
  const auto before = encode_slam_file(file_of(state));
  for (int i = kSavedFrames + 5; i < kSavedFrames + 25; ++i) slam.process(resume_frame(i));
  EXPECT_EQ(encode_slam_file(file_of(state)), before);
  EXPECT_NE(encode_slam_file(file_of(slam.state())), before);
}

}  // namespace
}  // namespace lapis::slam
