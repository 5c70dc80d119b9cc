#include "controller/core/path_track.hpp"

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

PathTrack corner() { return PathTrack({planar_pose({0, 0}, 0), planar_pose({2, 0}, 0), planar_pose({2, 3}, 1.5)}); }

TEST(PathTrack, FollowsTheRobotAndNeverGoesBack) {
  PathTrack track = corner();
  EXPECT_DOUBLE_EQ(track.left_m(), 5.0);
  track.advance({0.7, 0.2}, 1.0);
  EXPECT_DOUBLE_EQ(track.progress_m(), 0.7);
  track.advance({0.1, 0.0}, 1.0);
  EXPECT_DOUBLE_EQ(track.progress_m(), 0.7);
  track.advance({2.1, 0.4}, 2.0);
  EXPECT_DOUBLE_EQ(track.progress_m(), 2.4);
  EXPECT_DOUBLE_EQ(track.left_m(), 2.6);
}

TEST(PathTrack, LooksOnlyAsFarAheadAsTheWindow) {
  PathTrack track({planar_pose({0, 0}, 0), planar_pose({4, 0}, 0), planar_pose({4, 0.2}, 0), planar_pose({0, 0.2}, 0)});
  track.advance({0.5, 0.2}, 1.0);  // its path back passes here, too
  EXPECT_DOUBLE_EQ(track.progress_m(), 0.5);
}

TEST(PathTrack, PointAheadGoesAroundTheCornerAndEndsAtTheEnd) {
  PathTrack track = corner();
  track.advance({1.5, 0.0}, 2.0);
  EXPECT_TRUE(track.ahead(0.25).isApprox(Eigen::Vector2d(1.75, 0.0)));
  EXPECT_TRUE(track.ahead(1.0).isApprox(Eigen::Vector2d(2.0, 0.5)));
  EXPECT_TRUE(track.ahead(99.0).isApprox(Eigen::Vector2d(2.0, 3.0)));
  EXPECT_DOUBLE_EQ(yaw_of(track.end()), 1.5);
}

TEST(PathTrack, OfOnePoseOrOfEqualOnesIsAtItsEnd) {
  for (const int copies : {1, 3}) {
    PathTrack track(std::vector<PlanarPose>(static_cast<std::size_t>(copies), planar_pose({1, 2}, 0.5)));
    track.advance({1.1, 2.0}, 1.0);
    EXPECT_DOUBLE_EQ(track.left_m(), 0.0);
    EXPECT_TRUE(track.ahead(1.0).isApprox(Eigen::Vector2d(1.0, 2.0)));
  }
}

}  // namespace
}  // namespace lapis::controller
