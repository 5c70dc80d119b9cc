#include "controller/core/local_map.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "common/geometry/camera_mount.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::controller {
namespace {

using lapis::test::Box;

const geometry::PinholeCamera kCamera{160, 90, 80, 80, 79.5, 44.5};
const geometry::Pose kT_base_camera = geometry::T_base_camera({1.0, 0.15});

geometry::Pose in_space(const PlanarPose& T) {
  const Eigen::Vector2d& p = T.translation();
  return geometry::make_pose({p.x(), p.y(), 0.0},
                             Eigen::Quaterniond(Eigen::AngleAxisd(yaw_of(T), Eigen::Vector3d::UnitZ())));
}

Box box_at(double x, double y, double height_m = 0.8, double low_m = 0.0) {
  return {{x - 0.2, y - 0.2, low_m}, {x + 0.2, y + 0.2, height_m}, 9};
}
const Box kFloor{{-9, -9, -0.3}, {9, 9, 0}, 2};
const Box kWall{{3, -9, 0}, {3.3, 9, 2.6}, 1};

class LocalMapTest : public ::testing::Test {
 protected:
  void look(const std::vector<Box>& boxes, const PlanarPose& T_map_base = PlanarPose::Identity()) {
    const auto image = lapis::test::render(boxes, kCamera, in_space(T_map_base) * kT_base_camera);
    map.add({image.depth, kCamera, kT_base_camera}, T_map_base, now, has_path);
    now = now + time::Duration{66'666'667};
  }
  bool has_point(const Eigen::Vector2d& p_base, double within_m = 0.06,
                 const PlanarPose& T_map_base = PlanarPose::Identity()) const {
    const auto points = map.near(T_map_base, 4.0).obstacles;
    return std::any_of(points.begin(), points.end(), [&](const auto& p) { return (p - p_base).norm() < within_m; });
  }
  /// 3 x 3 m around the origin, of 0.25 m, unknown but for one value at (1.125, 0.125).
  static Grid grid(int value, int elsewhere = Grid::kUnknown) {
    Grid g{0.25, {-1.5, -1.5}, 12, 12, std::vector<std::int8_t>(144, static_cast<std::int8_t>(elsewhere))};
    g.cells[6 * 12 + 10] = static_cast<std::int8_t>(value);
    return g;
  }

  LocalMap map{{}};
  time::Time now{1'000'000'000};
  bool has_path = true;
};

// A shelf whose legs are below the image may lean on something wider.
TEST_F(LocalMapTest, LooksForFeetUnderWhatHasNotShownItsOwn) {
  look({kFloor, box_at(1.5, 0.0, 0.8, 0.5)});
  const Surroundings around = map.near(PlanarPose::Identity(), 4.0);
  ASSERT_FALSE(around.unseen_feet.empty());
  double farthest_m = 0.0;
  for (const auto& p : around.obstacles) farthest_m = std::max(farthest_m, p.norm());
  for (const auto& foot : around.unseen_feet) {
    const auto nearest = std::min_element(around.obstacles.begin(), around.obstacles.end(),
                                          [&](auto& a, auto& b) { return (a - foot).norm() < (b - foot).norm(); });
    EXPECT_NEAR((*nearest - foot).norm(), 0.05, 0.025) << foot.transpose() << ": beside a column, not in one";
    EXPECT_LT(foot.norm(), farthest_m + 0.04) << "nothing is behind all of it";
  }
}

TEST_F(LocalMapTest, WhatHasShownItsFootHasNoOther) {
  look({kFloor, {{1.52, -9, 0}, {1.8, 9, 2.6}, 1}});
  const Surroundings around = map.near(PlanarPose::Identity(), 4.0);
  EXPECT_TRUE(has_point({1.52, 0.0}));
  for (const auto& foot : around.unseen_feet)  // aside, points of an image's column are not of one column of the map
    EXPECT_GT(std::abs(foot.y()), 0.05) << foot.transpose();
}

TEST_F(LocalMapTest, SeesWhatStandsInTheBandAndNotTheFloor) {
  look({kFloor, kWall, box_at(1.5, 0.0)});
  EXPECT_TRUE(has_point({1.3, 0.0}));
  EXPECT_TRUE(has_point({3.0, 1.0}));
  for (const auto& p : map.near(PlanarPose::Identity(), 9.0).obstacles) {
    EXPECT_TRUE(p.x() > 2.9 || (p - Eigen::Vector2d(1.5, 0.0)).norm() < 0.4) << p.transpose() << " is floor";
  }
}

TEST_F(LocalMapTest, LowThingsAreDrivenOverAndHighOnesPassedUnder) {
  look({kFloor, box_at(1.8, 0.0, 0.06), box_at(1.8, 0.8, 1.6, 1.3)});
  EXPECT_TRUE(map.near(PlanarPose::Identity(), 4.0).obstacles.empty());
}

TEST_F(LocalMapTest, RemembersWhatTheCameraDoesNotSeeAnyMore) {
  const std::vector<Box> boxes{kFloor, box_at(2.0, 0.0, 0.3)};
  look(boxes);
  ASSERT_TRUE(has_point({1.8, 0.0}));
  const PlanarPose T_near = planar_pose({1.2, 0.0}, 0.0);  // it is below the image now
  for (int i = 0; i < 15 * 59; ++i) look(boxes, T_near);
  EXPECT_TRUE(has_point({0.6, 0.0}, 0.06, T_near));
  for (int i = 0; i < 30; ++i) look(boxes, T_near);
  EXPECT_FALSE(has_point({0.6, 0.0}, 0.06, T_near)) << "forgotten after 60 s";
}

TEST_F(LocalMapTest, WithoutAPathOnlyMovingMakesItForget) {
  const std::vector<Box> boxes{kFloor, box_at(2.0, 0.0, 0.3)};
  look(boxes);
  has_path = false;
  const PlanarPose T_near = planar_pose({1.2, 0.0}, 0.0);
  for (int i = 0; i < 15 * 90; ++i) look(boxes, planar_pose({1.2 + 0.001 * (i % 2), 0.0}, 0.001 * (i % 2)));
  EXPECT_TRUE(has_point({0.6, 0.0}, 0.06, T_near)) << "still in front of it when it is sent on";
  for (int i = 0; i < 15 * 61; ++i) look(boxes, planar_pose({1.2, 0.0}, 0.03 * (i % 2)));
  EXPECT_FALSE(has_point({0.6, 0.0}, 0.06, T_near)) << "forgotten after 60 s of turning";
}

TEST_F(LocalMapTest, PointsKeepTheirPlaceFromTheRobotWhenTheMapJumps) {
  look({kFloor, box_at(1.5, 0.0)});
  const PlanarPose T_new = planar_pose({3.0, -1.0}, 0.7);
  map.move_points(T_new);  // it was at the origin
  EXPECT_TRUE(has_point({1.3, 0.0}, 0.06, T_new));
  EXPECT_FALSE(has_point({1.3, 0.0}, 0.3));
}

TEST_F(LocalMapTest, NothingIsKnownWhenTimeBeginsAgain) {
  look({kFloor, box_at(1.5, 0.0)});
  now = time::Time{500'000'000};
  look({kFloor});
  EXPECT_FALSE(has_point({1.3, 0.0}, 0.3));
}

TEST_F(LocalMapTest, ThreeImagesThroughAnObstacleClearIt) {
  for (int i = 0; i < 30; ++i) look({kFloor, kWall, box_at(1.5, 0.0)});
  look({kFloor, kWall});
  look({kFloor, kWall});
  EXPECT_TRUE(has_point({1.3, 0.0}));
  look({kFloor, kWall});
  EXPECT_FALSE(has_point({1.3, 0.0}, 0.15));
  EXPECT_TRUE(has_point({3.0, 0.0})) << "the wall stays";
}

TEST_F(LocalMapTest, WhatHidesBehindSomethingStays) {
  look({kFloor, box_at(2.5, 0.0)});
  for (int i = 0; i < 10; ++i) look({kFloor, box_at(1.0, 0.0, 1.4)});
  EXPECT_TRUE(has_point({2.3, 0.0}));
}

TEST_F(LocalMapTest, NoDepthSaysNothing) {
  look({kFloor, box_at(1.5, 0.0)});
  for (int i = 0; i < 10; ++i) {
    map.add({geometry::DepthImage(kCamera.width, kCamera.height), kCamera, kT_base_camera}, PlanarPose::Identity(), now,
            has_path);
  }
  EXPECT_TRUE(has_point({1.3, 0.0}));
}

TEST_F(LocalMapTest, PointsStayInTheMapWhileTheRobotTurns) {
  look({kFloor, box_at(1.5, 0.0)});
  const PlanarPose T_turned = planar_pose({0.0, 0.0}, 1.5707963);
  EXPECT_TRUE(has_point({0.0, -1.3}, 0.06, T_turned));
}

TEST_F(LocalMapTest, GridCellsAreTheirCentresUnlessPointsTellMore) {
  map.set_plan(grid(100));
  EXPECT_TRUE(has_point({1.125, 0.125}, 1e-9));
  look({kFloor, {{1.2, -0.2, 0.0}, {1.4, 0.3, 0.8}, 9}});  // its front is at the far side of the cell
  EXPECT_FALSE(has_point({1.125, 0.125}, 1e-9));
  EXPECT_TRUE(has_point({1.22, 0.125}));
}

TEST_F(LocalMapTest, NewestEvidenceOverrulesThePlanWhereThereIsAny) {
  map.set_plan(grid(100));
  map.set_obstacles(grid(0));
  EXPECT_FALSE(has_point({1.125, 0.125}, 1e-9)) << "it is gone";
  EXPECT_TRUE(map.is_known_free({1.125, 0.125}));
  map.set_obstacles(grid(Grid::kUnknown));
  EXPECT_TRUE(has_point({1.125, 0.125}, 1e-9));
  map.set_plan(grid(0));
  map.set_obstacles(grid(100));
  EXPECT_TRUE(has_point({1.125, 0.125}, 1e-9)) << "it is new";
  EXPECT_FALSE(map.is_known_free({1.125, 0.125}));
}

TEST_F(LocalMapTest, UnknownIsNotFree) {
  EXPECT_FALSE(map.is_known_free({0.0, 0.0}));
  map.set_plan(grid(0, 0));
  EXPECT_TRUE(map.is_known_free({0.0, 0.0}));
  EXPECT_FALSE(map.is_known_free({1.6, 0.0})) << "outside";
  EXPECT_FALSE(map.is_known_free({-1.6, 0.0}));
}

}  // namespace
}  // namespace lapis::controller
