#include "planner/core/exploration/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

constexpr double kResolution_m = 0.25;

/// Three free cells side by side, x = 0 to 2 and y = 0; all around is unknown but for what lies below and at the ends,
/// so that each has one unknown neighbour, above it.
class FrontierOfThreeCells : public ::testing::Test {
 protected:
  FrontierOfThreeCells() {
    test::FlatMap map(kResolution_m);
    for (std::int32_t x = -1; x <= 3; ++x) map.set({x, -1}, mapping::kOccupied);
    for (const std::int32_t x : {-1, 3}) map.set({x, 0}, mapping::kOccupied);
    for (std::int32_t x = 0; x <= 2; ++x) map.set({x, 0}, mapping::kFree);
    surroundings_.update_map(map.map(), map.flush());
  }
  /// Seen are the cells above, from the left.
  static ObstacleGrid area(int cells) {
    ObstacleGrid area{{0.0, kResolution_m}, kResolution_m, 3, 1, {-1, -1, -1}};
    std::fill_n(area.cells.begin(), cells, mapping::kFree);
    return area;
  }
  const Frontier& frontier() const { return surroundings_.frontiers().frontiers().begin()->second; }

  Surroundings surroundings_{{}, mapping::SensorModel{}, kResolution_m};
};

TEST_F(FrontierOfThreeCells, WaitsWhileMostOfWhatLiesBeyondHasBeenSeen) {
  ASSERT_EQ(surroundings_.frontiers().frontiers().size(), 1U);
  ASSERT_EQ(frontier().cells.size(), 3U);
  for (const int seen : {0, 1, 2, 3, 1}) {
    ASSERT_TRUE(surroundings_.set_provisional_area(area(seen)));
    EXPECT_EQ(surroundings_.is_awaited(frontier()), seen >= 2) << seen;
    EXPECT_EQ(surroundings_.awaited_targets().size(), seen >= 2 ? frontier().representatives.size() : 0U) << seen;
  }
  EXPECT_EQ(surroundings_.frontiers().frontiers().size(), 1U) << "it is one all the time";
}

TEST_F(FrontierOfThreeCells, ItsTargetsAreItsRepresentatives) {
  ASSERT_TRUE(surroundings_.set_provisional_area(area(3)));
  const auto targets = surroundings_.awaited_targets();
  ASSERT_FALSE(targets.empty());
  EXPECT_EQ(targets.front(), Eigen::Vector2d(0.375, 0.125)) << "the middle";
}

TEST_F(FrontierOfThreeCells, WaitsNoLongerWhenTheAreaIsGone) {
  ASSERT_TRUE(surroundings_.set_provisional_area(area(3)));
  ASSERT_TRUE(surroundings_.set_provisional_area({}));
  EXPECT_FALSE(surroundings_.is_awaited(frontier()));
}

TEST_F(FrontierOfThreeCells, AnAreaOfOtherCellsChangesNothing) {
  ASSERT_TRUE(surroundings_.set_provisional_area(area(3)));
  for (const double resolution_m : {0.1, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    ObstacleGrid other = area(0);
    other.resolution_m = resolution_m;
    EXPECT_FALSE(surroundings_.set_provisional_area(other));
    EXPECT_TRUE(surroundings_.is_awaited(frontier()));
  }
}

}  // namespace
}  // namespace lapis::planner
