#include "simulator/core/building/placement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "small_building.hpp"

namespace lapis::simulator {
namespace {

const std::vector<ItemExtent> kChairs(8, ItemExtent{{0.46, 0.5, 0.9}, 0.0});

SceneSpec chairs_in_a_row(double step) {
  SceneSpec spec = test::two_rooms();
  for (int i = 0; i < 8; ++i) {
    FurnitureSpec chair;
    chair.class_name = "chair";
    chair.is_movable = true;
    chair.place = AtPoint{{0.3 + step * i, 1.5}, 0.0};
    spec.furniture.push_back(chair);
  }
  return normalised(spec);
}

TEST(Placement, BackToEveryWallFrontToTheRoom) {
  SceneSpec spec = test::two_rooms();
  spec.rooms[0].polygon = {{0, 0}, {4, 0}, {4, 3}, {1, 2.5}};
  for (int edge = 0; edge < 4; ++edge) {
    for (const double turn : {0.0, 0.4}) {
      FurnitureSpec item;
      item.class_name = "cabinet";
      item.place = AgainstWall{"left", edge, 1.3, 0.05, turn};
      spec.furniture.push_back(item);
    }
  }
  spec = normalised(spec);
  const auto plan = plan_walls(spec);
  const std::vector<ItemExtent> extents(spec.furniture.size(), {{1.0, 0.4, 1.2}, 0.0});
  const auto poses = place_furniture(spec, plan, extents);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& place = std::get<AgainstWall>(spec.furniture[i].place);
    const Wall& wall = plan[0].walls[static_cast<std::size_t>(place.edge)];
    double nearest = 1e9;
    for (const auto& corner : poses[i].footprint(extents[i]))
      nearest = std::min(nearest, (corner - wall.start).dot(wall.inward));
    EXPECT_NEAR(nearest, 0.05, 1e-9) << "wall " << place.edge;
    EXPECT_NEAR((poses[i].at - wall.start).dot(wall.direction), 1.3, 1e-9);
    const Eigen::Vector2f front = (poses[i].T_world_item().linear() * -Eigen::Vector3f::UnitY()).head<2>();
    EXPECT_NEAR(front.cast<double>().dot(wall.inward), std::cos(place.turn_rad), 1e-6);
  }
}

TEST(Placement, WhatStandsOnAnItemGoesWithIt) {
  SceneSpec spec = test::two_rooms();
  FurnitureSpec desk, lamp;
  desk.id = "desk";
  desk.class_name = "table";
  desk.is_movable = true;
  desk.place = AtPoint{{2, 1.5}, 0.5 * std::numbers::pi};
  lamp.class_name = "lighting";
  lamp.place = OnItem{"desk", {0.3, 0.1}, 0.2};
  spec.furniture = {desk, lamp};
  spec = normalised(spec);
  const std::vector<ItemExtent> extents{{{1.4, 0.7, 0.74}, 0.1}, {{0.2, 0.2, 0.4}, -0.04}};
  const auto plan = plan_walls(spec);
  const auto still = place_furniture(spec, plan, extents);
  EXPECT_TRUE(still[1].at.isApprox(Eigen::Vector2d(1.9, 1.8), 1e-9)) << still[1].at.transpose();
  EXPECT_NEAR(still[1].bottom_m, 0.1 + 0.74 - 0.04, 1e-9);
  const auto moved = place_furniture_with_jitter(spec, plan, extents, 4);
  EXPECT_NE(moved[0].at, still[0].at);
  const auto on_desk = [](const std::vector<ItemPose>& poses) {
    return (poses[0].T_world_item().inverse() * poses[1].T_world_item()).matrix();
  };
  EXPECT_TRUE(on_desk(moved).isApprox(on_desk(still), 1e-5F));
}

TEST(Placement, JitterIsBoundedAndDrawnFromTheSeed) {
  const SceneSpec spec = chairs_in_a_row(0.49);
  const auto plan = plan_walls(spec);
  const auto still = place_furniture(spec, plan, kChairs);
  int moves = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto moved = place_furniture_with_jitter(spec, plan, kChairs, seed);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Eigen::Vector2d by = moved[i].at - still[i].at;
      EXPECT_LE(by.cwiseAbs().maxCoeff(), 0.05);
      EXPECT_LE(std::abs(moved[i].yaw_rad - still[i].yaw_rad), 10.0 * std::numbers::pi / 180.0);
      moves += by.norm() > 0.0 ? 1 : 0;
      EXPECT_TRUE(contains(spec.rooms[0].polygon, moved[i].footprint(kChairs[i])));
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_FALSE(overlap(moved[i].footprint(kChairs[i]), moved[k].footprint(kChairs[k]))) << i << " and " << k;
    }
    const auto again = place_furniture_with_jitter(spec, plan, kChairs, seed);
    for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_EQ(again[i].at, moved[i].at);
  }
  EXPECT_GT(moves, 40);  // of 160: the row is narrow
}

TEST(Placement, JitterKeepsDoorsStartsAndPathsClear) {
  SceneSpec spec = test::two_rooms();
  spec.starts = {{{1.0, 0.6}, 0.0}};
  spec.tour = {{0.5, 2.6}, {2.5, 2.6}};
  const auto put = [&](double x, double y) {
    FurnitureSpec chair;
    chair.class_name = "chair";
    chair.is_movable = true;
    chair.place = AtPoint{{x, y}, 0.0};
    spec.furniture.push_back(chair);
  };
  put(4.0 - 0.7 - 0.24, 1.0);   // a centimetre before the clear floor of the door
  put(1.0 + 0.35 + 0.24, 0.6);  // ... around the start
  put(1.5, 2.6 - 0.35 - 0.26);  // ... along the path
  put(0.6, 2.6);                // in the way, by the author's will
  spec = normalised(spec);
  const auto plan = plan_walls(spec);
  const std::vector<ItemExtent> extents(spec.furniture.size(), {{0.46, 0.5, 0.9}, 0.0});
  const auto still = place_furniture(spec, plan, extents);
  std::vector<int> moves(still.size());
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto moved = place_furniture_with_jitter(spec, plan, extents, seed);
    for (std::size_t i = 0; i < moved.size(); ++i) moves[i] += moved[i].at == still[i].at ? 0 : 1;
    EXPECT_FALSE(overlap(moved[0].footprint(extents[0]), rectangle({3.65, 1.0}, {0.7, 0.9}, 0.0)));
    EXPECT_FALSE(overlap(moved[1].footprint(extents[1]), rectangle({1.0, 0.6}, {0.7, 0.7}, 0.0)));
    EXPECT_FALSE(overlap(moved[2].footprint(extents[2]), rectangle({1.5, 2.6}, {2.7, 0.7}, 0.0)));
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(moves[i], 5) << "item " << i;
  EXPECT_EQ(moves[3], 0);
}

TEST(Placement, WhatIsNotMovableStays) {
  SceneSpec spec = chairs_in_a_row(0.49);
  for (auto& chair : spec.furniture) chair.is_movable = false;
  const auto plan = plan_walls(spec);
  const auto still = place_furniture(spec, plan, kChairs), moved = place_furniture_with_jitter(spec, plan, kChairs, 3);
  for (std::size_t i = 0; i < still.size(); ++i) EXPECT_EQ(moved[i].at, still[i].at);
}

TEST(Placement, PicturesMoveAlongTheirWallAndNeverMeet) {
  SceneSpec spec = test::two_rooms();
  for (const double along : {0.4, 1.1, 1.8, 3.5}) {
    PictureSpec picture;
    picture.room = "left";
    picture.edge = 2;
    picture.along_m = along;
    spec.pictures.push_back(picture);
  }
  spec = normalised(spec);
  const auto plan = plan_walls(spec);
  const auto still = place_pictures(spec, plan);
  double largest = 0.0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    auto moved = place_pictures_with_jitter(spec, plan, seed);
    for (std::size_t i = 0; i < moved.size(); ++i) largest = std::max(largest, std::abs(moved[i] - still[i]));
    EXPECT_GE(moved.front(), 0.3);
    for (std::size_t i = 0; i + 1 < moved.size(); ++i) EXPECT_GE(moved[i + 1] - moved[i], 0.6);
  }
  EXPECT_GT(largest, 0.08);
  EXPECT_LE(largest, 0.1);
}

}  // namespace
}  // namespace lapis::simulator
