#include "controller/core/path_track.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace lapis::controller {
namespace {

std::vector<PlanarPose> headings(const std::vector<double>& yaws_rad) {
  std::vector<PlanarPose> poses;
  for (const double yaw_rad : yaws_rad) poses.push_back(planar_pose({0.0, 0.0}, yaw_rad));
  return poses;
}

TEST(TurnOnTheSpot, IsTheSumOfShortWaysFromHeadingToHeading) {
  constexpr double kThird_rad = 2.0 * std::numbers::pi / 3.0;
  EXPECT_NEAR(turn_on_the_spot(headings({1.0})).value(), 1.0, 1e-12);
  EXPECT_NEAR(turn_on_the_spot(headings({-3.0})).value(), -3.0, 1e-12);
  EXPECT_NEAR(turn_on_the_spot(headings({kThird_rad, 2 * kThird_rad, 0.0, kThird_rad})).value(), 4 * kThird_rad, 1e-12);
  EXPECT_NEAR(turn_on_the_spot(headings({-2.0, 2.5, 1.0})).value(), 1.0 - 2.0 * std::numbers::pi, 1e-12);
}

TEST(TurnOnTheSpot, IsNoneWhereThePathLeadsAwayOrThereIsNoPath) {
  EXPECT_FALSE(turn_on_the_spot({}));
  EXPECT_FALSE(turn_on_the_spot({planar_pose({0, 0}, 1.0), planar_pose({0.0, 0.02}, 1.0)}));
}

PathTrack corner() { return PathTrack({planar_pose({0, 0}, 0), planar_pose({2, 0}, 0), planar_pose({2, 3}, 1.5)}); }

TEST(PathTrack, BeginsWithTheHeadingsOfItsFirstPlace) {
  const std::vector<PlanarPose> headings{planar_pose({0, 0}, 1.0), planar_pose({0, 0}, 2.0), planar_pose({0, 0}, 3.0)};
  std::vector<PlanarPose> poses = headings;
  poses.push_back(planar_pose({-1, 0}, 3.0));
  PathTrack track(poses);
  EXPECT_EQ(track.next_heading(0.0), 1.0);
  EXPECT_EQ(track.next_heading(0.8), 2.0);
  EXPECT_EQ(track.next_heading(0.5), 2.0) << "never back";
  EXPECT_EQ(track.next_heading(2.6), 3.0) << "it is nearer to the one after";
  EXPECT_EQ(track.next_heading(-3.1), std::nullopt);
  EXPECT_EQ(PathTrack(headings).next_heading(0.0), 1.0) << "also when it leads nowhere";
  const PlanarPose equal = planar_pose({0, 0}, 3.0);
  EXPECT_EQ(PathTrack({equal, equal, planar_pose({1, 0}, 0.0)}).next_heading(0.0), std::nullopt) << "they say nothing";
  EXPECT_EQ(corner().next_heading(3.0), std::nullopt);
}

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
