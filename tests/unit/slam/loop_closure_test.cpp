#include <gtest/gtest.h>

#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

constexpr int kLoopTurn = 120;  // frames in which the camera turns once: 3 degrees each

time::Time loop_stamp(int index) { return time::Time::from_seconds(1.0 + index / 15.0); }

// A camera that turns on the spot and moves about a little, never twice the same way.
Pose loop_turn(int index) {
  const double angle = 2.0 * 3.14159265358979 * index / kLoopTurn;
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(0.4 * std::sin(angle), 0.001 * index, 0.3 * std::cos(angle));
  T.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  return T;
}

RgbdFrame loop_frame(int index) { return test::render_room(test::small_camera(), loop_turn(index), loop_stamp(index)); }

RgbdFrame black_frame(int index) {
  return {loop_stamp(index), test::small_camera(), geometry::GrayImage(320, 240), geometry::DepthImage(320, 240, 2.0F)};
}

double error_m(const TrackingResult& result, int index) {
  return (result.T_map_keyframe * result.T_keyframe_camera * loop_turn(index).inverse()).translation().norm();
}

class LoopClosure : public ::testing::Test {
 protected:
  void run(int from, int to) {
    for (int i = from; i < to; ++i) {
      const TrackingResult result = slam_.process(loop_frame(i));
      ASSERT_EQ(result.state, TrackingState::kTracking) << "frame " << i << ": " << result.reason;
    }
  }
  RgbdSlam slam_{{}, loop_turn(0)};
};

TEST_F(LoopClosure, ASecondTurnClosesLoopsThatAreRight) {
  run(0, kLoopTurn - 30);  // the first views come into sight again after this
  EXPECT_EQ(slam_.loops().closures, 0U);
  EXPECT_FALSE(slam_.loops().last.has_value());
  run(kLoopTurn - 30, kLoopTurn + 60);
  slam_.settle();
  const PoseGraphSnapshot graph = slam_.pose_graph();
  std::size_t loops = 0;
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.type != EdgeType::kLoopClosure) continue;
    ++loops;
    const auto index = [&](std::uint64_t id) {
      return static_cast<int>(std::lround((graph.nodes[id].stamp.seconds() - 1.0) * 15.0));
    };
    const Pose truth = loop_turn(index(edge.from)).inverse() * loop_turn(index(edge.to));
    const geometry::Vector6d error = geometry::se3_log(truth.inverse() * edge.T_from_to);
    EXPECT_LT(error.norm(), 0.02) << edge.from << " to " << edge.to;
    EXPECT_LT(error.dot(edge.information * error), 6 * 6.0) << edge.from << " to " << edge.to;
    EXPECT_GE(edge.to - edge.from, 10U);
  }
  EXPECT_GE(loops, 2U);
  EXPECT_EQ(slam_.loops().closures, loops);
  ASSERT_TRUE(slam_.loops().last.has_value());
  EXPECT_GT(*slam_.loops().last, loop_stamp(kLoopTurn - 30));
}

TEST_F(LoopClosure, TakesEffectAFixedNumberOfFramesLater) {
  std::optional<int> closed, corrected;
  std::uint64_t version = 0;
  for (int i = 0; i < kLoopTurn + 60 && !corrected; ++i) {
    const TrackingResult result = slam_.process(loop_frame(i));
    if (!closed && slam_.loops().last) closed = i;
    if (result.graph_version > version + (result.is_keyframe ? 1 : 0)) corrected = i;
    version = result.graph_version;
  }
  ASSERT_TRUE(closed && corrected);
  EXPECT_EQ(*corrected - *closed, SlamConfig{}.loop.latency_frames);
}

TEST_F(LoopClosure, IsTheSameTwice) {
  RgbdSlam other({}, loop_turn(0));
  for (int i = 0; i < kLoopTurn + 40; ++i) {
    const TrackingResult a = slam_.process(loop_frame(i));
    const TrackingResult b = other.process(loop_frame(i));
    ASSERT_TRUE(a.T_map_keyframe.matrix() == b.T_map_keyframe.matrix()) << i;
    ASSERT_TRUE(a.map_covariance == b.map_covariance) << i;
  }
  EXPECT_GE(slam_.loops().closures, 2U);
}

TEST_F(LoopClosure, ALoopMakesTheNewestPoseMoreCertain) {
  SlamConfig open;
  open.loop.enabled = false;
  RgbdSlam without(open, loop_turn(0));
  run(0, kLoopTurn + 40);
  TrackingResult last;
  for (int i = 0; i < kLoopTurn + 40; ++i) last = without.process(loop_frame(i));
  EXPECT_EQ(without.loops().closures, 0U);
  const TrackingResult closed = slam_.process(loop_frame(kLoopTurn + 40));
  const TrackingResult unclosed = without.process(loop_frame(kLoopTurn + 40));
  // The determinant does not depend on where in the camera's neighbourhood the tangent is taken.
  EXPECT_LT(closed.map_covariance.determinant(), 0.5 * unclosed.map_covariance.determinant());
}

// Taken to another place in the dark, one that none of the newest key-frames shows.
TEST_F(LoopClosure, APlaceSeenLongAgoIsRecognisedWithinAFewFrames) {
  run(0, 100);
  for (int i = 100; i < 115; ++i) EXPECT_EQ(slam_.process(black_frame(i)).state, TrackingState::kLost);
  const std::size_t keyframes = slam_.keyframe_count();
  std::optional<int> found;
  for (int i = 0; i < 6 && !found; ++i) {
    RgbdFrame back = loop_frame(20 + i);
    back.stamp = loop_stamp(115 + i);
    const TrackingResult result = slam_.process(back);
    if (result.state != TrackingState::kTracking) {
      EXPECT_EQ(result.reason, "a recognised place awaits confirmation");
      continue;
    }
    found = i;
    EXPECT_LT(error_m(result, 20 + i), 0.02);
  }
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(*found, SlamConfig{}.relocalization.confirmations);
  EXPECT_EQ(slam_.keyframe_count(), keyframes) << "the map is not touched while lost";
}

TEST_F(LoopClosure, AViewThatTheMapLacksIsNotRecognised) {
  run(0, 40);
  for (int i = 0; i < 20; ++i) {
    RgbdFrame other = loop_frame(80 + i);  // the other side of the room
    other.stamp = loop_stamp(60 + i);
    const TrackingResult result = slam_.process(other);
    EXPECT_EQ(result.state, TrackingState::kLost) << i;
    EXPECT_FALSE(result.reason.empty());
  }
}

}  // namespace
}  // namespace lapis::slam
