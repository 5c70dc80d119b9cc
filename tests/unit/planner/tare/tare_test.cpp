#include "planner/core/tare/tare.hpp"

#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using test::TextWorld;
using ::testing::_;
using ::testing::Each;
using ::testing::Pair;

// Open on all sides but the lower one; 8 x 4 m.
const std::vector<std::string> kHall = {
    "................................", "................................", "................................",
    "................................", "................................", "................................",
    "................................", "................................", "................................",
    "................................", "...............R................", "................................",
    "................................", "................................", "################################",
};
// Nothing to see near the robot; a long corridor leads to two openings.
const std::vector<std::string> kCorridor = {
    "#####################################################",  //
    "#...................................................#",  //
    "#..R.................................................",  //
    "#...................................................#",  //
    "###################################...###############",
};

struct Planner {
  explicit Planner(const std::vector<std::string>& lines) : world(lines), frontiers({}) {
    frontiers.update(world.grid, world.known);
    robot.p_map = world.grid.center_of(world.places.at('R'));
  }
  Tour plan() const {
    const CostTree paths = grow_cost_tree(world.grid, {}, {world.places.at('R')});
    return plan_tour({world.grid,
                      frontiers,
                      paths,
                      robot,
                      std::numbers::pi / 2.0,
                      {},
                      {},
                      0.5,
                      left_alone,
                      failed_views,
                      0.75,
                      goal,
                      1.2},
                     config);
  }
  // Frontier cells that no stop's camera covers.
  int uncovered(const Tour& tour) const {
    int count = 0;
    for (const auto& [id, frontier] : frontiers.frontiers()) {
      count += static_cast<int>(std::count_if(frontier.cells.begin(), frontier.cells.end(), [&](Cell c) {
        return std::none_of(tour.stops.begin(), tour.stops.end(), [&](const TourStop& stop) {
          const Eigen::Vector2d offset = world.grid.center_of(c) - stop.viewpoint.pose.p_map;
          const double off =
              std::remainder(std::atan2(offset.y(), offset.x()) - stop.viewpoint.pose.yaw_rad, 2.0 * std::numbers::pi);
          return offset.norm() <= config.range_m && std::abs(off) <= std::numbers::pi / 4.0 + 1e-9;
        });
      }));
    }
    return count;
  }

  TextWorld world;
  FrontierMap frontiers;
  TareConfig config;
  Pose2 robot;
  std::vector<LeftAlone> left_alone;
  std::vector<FailedView> failed_views;
  std::optional<Pose2> goal;
};

int all_cells(const FrontierMap& frontiers) {
  int count = 0;
  for (const auto& entry : frontiers.frontiers()) count += static_cast<int>(entry.second.cells.size());
  return count;
}

TEST(Tare, CoversWhatIsAroundWithFewViews) {
  const Planner planner(kHall);
  const Tour tour = planner.plan();
  EXPECT_EQ(tour.local_stops, tour.stops.size()) << "all of it is within the horizon";
  EXPECT_THAT(tour.missed, Each(Pair(_, Rejection::kBesideStop)));
  EXPECT_EQ(tour.stops.size() + tour.missed.size(), planner.frontiers.frontiers().size()) << "each is reported once";
  EXPECT_LE(tour.stops.size(), 12u) << "a view covers more than one frontier";
  EXPECT_LT(planner.uncovered(tour), 0.1 * all_cells(planner.frontiers)) << "of " << all_cells(planner.frontiers);
  for (const TourStop& stop : tour.stops) {
    EXPECT_TRUE(planner.world.grid.is_traversable(stop.viewpoint.cell));
    EXPECT_TRUE(planner.frontiers.frontiers().contains(stop.frontier));
    EXPECT_EQ(planner.world.grid.cell_of(stop.viewpoint.pose.p_map), stop.viewpoint.cell);
  }
}

TEST(Tare, IsTheSameEveryTimeAndAnotherWithAnotherSeed) {
  Planner planner(kHall);
  const auto cells = [&] {
    std::vector<Cell> result;
    for (const TourStop& stop : planner.plan().stops) result.push_back(stop.viewpoint.cell);
    return result;
  };
  const auto first = cells();
  EXPECT_EQ(first, cells());
  planner.config.seed = 2;
  EXPECT_NE(first, cells());
}

TEST(Tare, GoesFarWhenNothingIsLeftNearby) {
  const Planner planner(kCorridor);
  const Tour tour = planner.plan();
  EXPECT_EQ(tour.local_stops, 0u);
  ASSERT_EQ(tour.stops.size(), 2u) << "both ends";
  EXPECT_LT(tour.stops[0].viewpoint.pose.p_map.x(), 10.0) << "the lower exit is on the way to the right one";
  EXPECT_GT(tour.stops[1].viewpoint.pose.p_map.x(), 10.0);
}

TEST(Tare, KeepsItsGoalUnlessAnotherTourIsMuchShorter) {
  Planner planner(kHall);
  const Tour tour = planner.plan();
  ASSERT_GE(tour.stops.size(), 3u);
  planner.goal = tour.stops[1].viewpoint.pose;
  EXPECT_LT((planner.plan().stops[0].viewpoint.pose.p_map - planner.goal->p_map).norm(), 0.5);
  Planner far(kCorridor);
  far.goal = far.plan().stops[1].viewpoint.pose;
  EXPECT_GT((far.plan().stops[0].viewpoint.pose.p_map - far.goal->p_map).norm(), 0.5) << "there and back";
}

TEST(Tare, LeavesAloneWhatItIsAskedTo) {
  Planner planner(kCorridor);
  planner.left_alone = {{planner.world.grid.center_of(planner.plan().stops[0].viewpoint.target)}};
  const Tour tour = planner.plan();
  EXPECT_EQ(tour.stops.size(), 1u);
  ASSERT_EQ(tour.missed.size(), 1u);
  EXPECT_EQ(tour.missed[0].second, Rejection::kLeftAlone);
}

TEST(Tare, LooksFromElsewhereAtWhatAFailedViewShowed) {
  for (const auto& lines : {kHall, kCorridor}) {
    Planner planner(lines);
    const TourStop first = planner.plan().stops[0];
    const Eigen::Vector2d target_map = planner.world.grid.center_of(first.viewpoint.target);
    planner.failed_views = {{target_map, first.viewpoint.pose.p_map}};
    const Tour tour = planner.plan();
    EXPECT_FALSE(tour.stops.empty());
    for (const TourStop& stop : tour.stops) {
      const bool is_same_target = (planner.world.grid.center_of(stop.viewpoint.target) - target_map).norm() <= 0.75;
      EXPECT_FALSE(is_same_target && (stop.viewpoint.pose.p_map - first.viewpoint.pose.p_map).norm() <= 0.75);
    }
  }
}

TEST(Tare, NamesWhatCannotBeReached) {
  const Planner planner({"#######          #....", "#.....#          #....", "#..R..#          #....",
                         "#.....#          #....", "#######          #####"});
  const Tour tour = planner.plan();
  EXPECT_TRUE(tour.stops.empty());
  ASSERT_FALSE(tour.missed.empty());
  EXPECT_EQ(tour.missed[0].second, Rejection::kUnreachable);
}

}  // namespace
}  // namespace lapis::planner
