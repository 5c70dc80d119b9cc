// Carried elsewhere without odometry: mapping goes on in a sub-map, which becomes one with the map later.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "slam/core/map/landmark_tiles.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

constexpr int kRound = 150;                 // frames in which the camera has looked around
constexpr int kSeen = 40, kElsewhere = 85;  // frames before it is covered, and view from which it goes on
constexpr int kLast = kSeen - 1;            // view before it is covered
constexpr int kCovered = 10;
constexpr int kAfter = 8;  // frames until a sub-map begins

time::Time stamp_at(int frame) { return time::Time::from_seconds(1.0 + frame / 15.0); }

// A camera on a circle that looks outwards, a little higher in each round.
Pose look_around(int view) {
  const double angle = 2.0 * std::numbers::pi * view / kRound;
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(1.2 * std::sin(angle), 0.001 * view, 1.2 * std::cos(angle));
  T.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  return T;
}

double error_m(const Pose& T_map_camera, int view) {
  return (T_map_camera * look_around(view).inverse()).translation().norm();
}

class SubMap : public ::testing::Test {
 protected:
  static SlamConfig for_one_room() {
    SlamConfig config;
    config.sub_map.after_frames = kAfter;
    config.sub_map.evidence_m = 1.0;
    config.sub_map.room_m = 2.0;
    return config;
  }
  TrackingResult look(RgbdSlam& slam, int view) {
    return slam.process(test::render_room(test::small_camera(), look_around(view), stamp_at(frame_++)));
  }
  void cover(RgbdSlam& slam, int frames) {
    for (int i = 0; i < frames; ++i) {
      const RgbdFrame black{stamp_at(frame_++), test::small_camera(), geometry::GrayImage(320, 240),
                            geometry::DepthImage(320, 240, 2.0F)};
      EXPECT_EQ(slam.process(black).state, TrackingState::kLost);
    }
  }
  // Maps a part of the room, and goes on in another one until slam does so, too. Returns the next view.
  int carry_elsewhere(RgbdSlam& slam) {
    for (int view = 0; view < kSeen; ++view) EXPECT_EQ(look(slam, view).state, TrackingState::kTracking) << view;
    cover(slam, kCovered);
    for (int i = 1; i < kAfter; ++i) EXPECT_EQ(look(slam, kElsewhere).state, TrackingState::kLost) << i;
    const TrackingResult begun = look(slam, kElsewhere);
    EXPECT_EQ(begun.state, TrackingState::kUnconnected);
    EXPECT_TRUE(begun.is_keyframe);
    EXPECT_FALSE(has_pose(begun)) << "nobody knows where in the map it is";
    return kElsewhere + 1;
  }
  // Looks on until there is a pose in the map; the view that gave it, or nothing.
  std::optional<int> look_until_joined(RgbdSlam& slam, int view) {
    for (; view < kRound + kSeen; ++view) {
      const TrackingResult result = look(slam, view);
      if (!has_pose(result)) {
        EXPECT_EQ(result.state, TrackingState::kUnconnected) << view << ": " << result.reason;
        continue;
      }
      EXPECT_LT(error_m(result.T_map_keyframe * result.T_keyframe_camera, view), 0.05) << view;
      return view;
    }
    return std::nullopt;
  }
  static int view_of(const PoseGraphNode& node) {
    const int frame = static_cast<int>(std::lround((node.stamp.seconds() - 1.0) * 15.0));
    if (frame < kSeen) return frame;
    return kElsewhere + std::max(0, frame - kSeen - kCovered - kAfter + 1);
  }

  int frame_ = 0;
};

TEST_F(SubMap, MappingGoesOnAndTheMapIsOneAgain) {
  RgbdSlam slam(for_one_room(), look_around(0));
  int view = carry_elsewhere(slam);
  const std::size_t known = slam.pose_graph().nodes.size();
  for (; view < kElsewhere + 20; ++view) ASSERT_EQ(look(slam, view).state, TrackingState::kUnconnected) << view;
  EXPECT_GT(slam.keyframe_count(), known + 2);
  EXPECT_EQ(slam.pose_graph().nodes.size(), known) << "a sub-map is not in the graph of the map";

  const auto joined = look_until_joined(slam, view);
  ASSERT_TRUE(joined);
  EXPECT_EQ(slam.sub_maps().begun, 1U);
  for (view = *joined + 1; view < *joined + 30; ++view) {
    const TrackingResult result = look(slam, view);
    ASSERT_EQ(result.state, TrackingState::kTracking) << view << ": " << result.reason;
    EXPECT_LT(error_m(result.T_map_keyframe * result.T_keyframe_camera, view), 0.03) << view;
  }
  EXPECT_EQ(slam.sub_maps().joined, 1U);
  slam.settle();
  const PoseGraphSnapshot graph = slam.pose_graph();
  ASSERT_EQ(graph.nodes.size(), slam.keyframe_count());
  for (const PoseGraphNode& node : graph.nodes) {
    EXPECT_EQ(node.id, static_cast<std::uint64_t>(&node - graph.nodes.data()));
    EXPECT_LT(error_m(node.T_map_camera, view_of(node)), 0.03) << node.id;
  }
}

TEST_F(SubMap, IsTheSameTwice) {
  RgbdSlam a(for_one_room(), look_around(0)), b(for_one_room(), look_around(0));
  const int view = carry_elsewhere(a);
  frame_ = 0;
  carry_elsewhere(b);
  const int frame = frame_;
  const auto joined = look_until_joined(a, view);
  frame_ = frame;
  EXPECT_EQ(look_until_joined(b, view), joined);
  a.settle();
  b.settle();
  for (std::size_t i = 0; i < a.keyframe_count(); ++i) {
    EXPECT_TRUE(a.pose_graph().nodes[i].T_map_camera.matrix() == b.pose_graph().nodes[i].T_map_camera.matrix()) << i;
  }
}

// Rooms are copies of each other: this may be another one that looks the same.
TEST_F(SubMap, OneRoomIsNotEnough) {
  SlamConfig config = for_one_room();
  config.sub_map.evidence_m = 1.5;
  config.sub_map.room_m = SlamConfig{}.sub_map.room_m;
  RgbdSlam slam(config, look_around(0));
  const int view = carry_elsewhere(slam);
  EXPECT_FALSE(look_until_joined(slam, view));
  EXPECT_EQ(slam.sub_maps().joined, 0U);
}

// A map of so few views could never be joined with what comes.
TEST_F(SubMap, TheMapItselfIsGivenUpWhereItIsTooSmall) {
  RgbdSlam slam(for_one_room(), look_around(0));
  constexpr int kFew = 10;
  for (int view = 0; view < kFew; ++view) ASSERT_EQ(look(slam, view).state, TrackingState::kTracking) << view;
  cover(slam, kCovered);
  for (int i = 0; i < kAfter; ++i) {
    EXPECT_FALSE(slam.is_given_up()) << i;
    EXPECT_EQ(look(slam, kElsewhere).state, TrackingState::kLost) << i;
  }
  EXPECT_TRUE(slam.is_given_up());
  EXPECT_EQ(slam.sub_maps().begun, 0U);
}

TEST_F(SubMap, AResumedMapIsKeptHoweverSmallItIs) {
  RgbdSlam before(for_one_room(), look_around(0));
  for (int view = 0; view < 10; ++view) ASSERT_EQ(look(before, view).state, TrackingState::kTracking) << view;
  SlamState state = before.state();
  state.motion.reset();
  RgbdSlam slam(for_one_room(), look_around(0), std::move(state));
  TrackingResult result;
  for (int i = 0; i < kAfter; ++i) result = look(slam, kElsewhere);
  EXPECT_EQ(result.state, TrackingState::kUnconnected) << result.reason;
  EXPECT_FALSE(slam.is_given_up());
}

TEST_F(SubMap, ItsLandmarksAreNotThoseOfTheMap) {
  RgbdSlam slam(for_one_room(), look_around(0));
  const int view = carry_elsewhere(slam);
  LandmarkTiles tiles{{}};
  const auto count = [&](std::uint64_t version) {
    std::size_t landmarks = 0;
    for (const auto& tile : tiles.update(slam.map(), version)) landmarks += tile.ids.size();
    return landmarks;
  };
  const std::size_t before = count(1);
  EXPECT_GT(before, 0U);
  EXPECT_LT(before, slam.landmark_count());
  ASSERT_TRUE(look_until_joined(slam, view));
  slam.settle();
  EXPECT_GT(count(2), before);
}

TEST_F(SubMap, IsGivenUpWhenTheCameraIsSoonLostAgain) {
  RgbdSlam slam(for_one_room(), look_around(0));
  int view = carry_elsewhere(slam);
  for (; view < kElsewhere + 5; ++view) look(slam, view);
  cover(slam, kCovered);
  for (int i = 0; i < kAfter; ++i) {
    EXPECT_EQ(look(slam, kElsewhere + 42).state, TrackingState::kLost) << i;
  }
  EXPECT_EQ(slam.sub_maps().given_up, 1U);
  for (int i = 0; i < SlamConfig{}.relocalization.confirmations; ++i) look(slam, kLast - i);
  const TrackingResult back = look(slam, kLast);
  ASSERT_EQ(back.state, TrackingState::kTracking) << back.reason;
  EXPECT_LT(error_m(back.T_map_keyframe * back.T_keyframe_camera, kLast), 0.03);
}

TEST_F(SubMap, OfASavedMapIsJoinedInALaterRun) {
  RgbdSlam before(for_one_room(), look_around(0));
  int view = carry_elsewhere(before);
  for (; view < kRound; ++view) look(before, view);
  ASSERT_EQ(before.sub_maps().joined, 0U);
  SlamState state = before.state();
  ASSERT_FALSE(find_fault(state));
  state.motion.reset();
  RgbdSlam after(for_one_room(), Pose::Identity(), std::move(state));
  EXPECT_EQ(after.pose_graph().nodes.size(), before.pose_graph().nodes.size());
  EXPECT_EQ(after.keyframe_count(), before.keyframe_count());
  for (view = kLast; view < kRound && after.sub_maps().joined == 0; ++view) {
    const TrackingResult result = look(after, view);
    if (!has_pose(result)) continue;
    EXPECT_LT(error_m(result.T_map_keyframe * result.T_keyframe_camera, view), 0.03) << view;
  }
  EXPECT_EQ(after.sub_maps().joined, 1U);
  EXPECT_EQ(after.pose_graph().nodes.size(), after.keyframe_count());
}

// What it sees it has seen before, but it may be a copy: many places have to agree.
TEST_F(SubMap, BeginsWhereAPlaceIsRecognisedThatIsOutOfReach) {
  RgbdSlam slam(for_one_room(), look_around(0));
  for (int view = 0; view < kSeen; ++view) look(slam, view);
  cover(slam, kCovered);
  for (int i = 1; i < kAfter; ++i) {
    const TrackingResult result = look(slam, 0);
    EXPECT_EQ(result.state, TrackingState::kLost) << i;
    EXPECT_NE(result.reason, "a recognised place awaits confirmation") << i;
  }
  EXPECT_EQ(look(slam, 0).state, TrackingState::kUnconnected);
  EXPECT_TRUE(look_until_joined(slam, 1));
}

TEST_F(SubMap, DoesNotBeginWhereTheCameraIsBackWhereItWas) {
  RgbdSlam slam(for_one_room(), look_around(0));
  for (int view = 0; view < kSeen; ++view) look(slam, view);
  cover(slam, 60 * 15);
  for (int i = 0; i < SlamConfig{}.relocalization.confirmations; ++i) {
    const TrackingResult result = look(slam, kLast);
    EXPECT_EQ(result.reason, "a recognised place awaits confirmation");
  }
  const TrackingResult back = look(slam, kLast);
  EXPECT_EQ(back.state, TrackingState::kTracking) << back.reason;
  EXPECT_LT(error_m(back.T_map_keyframe * back.T_keyframe_camera, kLast), 0.03);
}

TEST_F(SubMap, DoesNotBeginWithoutItsKey) {
  SlamConfig config = for_one_room();
  config.sub_map.after_frames = 0;
  RgbdSlam slam(config, look_around(0));
  for (int view = 0; view < kSeen; ++view) look(slam, view);
  for (int i = 0; i < 2 * kAfter; ++i) EXPECT_EQ(look(slam, kElsewhere + 10).state, TrackingState::kLost) << i;
}

}  // namespace
}  // namespace lapis::slam
