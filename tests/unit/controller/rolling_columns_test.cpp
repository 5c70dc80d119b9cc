#include "controller/core/rolling_columns.hpp"

#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

using Voxel = std::tuple<std::int32_t, std::int32_t, std::int32_t>;

std::map<Voxel, int> content(const RollingColumns& columns) {
  std::map<Voxel, int> all;
  for (const PointColumn& column : columns.columns()) {
    EXPECT_FALSE(column.points.empty());
    for (const ColumnPoint& point : column.points) {
      EXPECT_TRUE(all.emplace(Voxel{column.x, column.y, point.z}, point.misses).second) << "twice";
    }
  }
  return all;
}

// Beside a map, while a window moves over the plane, beyond zero too.
TEST(RollingColumns, HoldWhatAMapHolds) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> aside(-10, 10), height(-3, 3);
  RollingColumns columns(24);
  std::map<Voxel, int> expected;
  for (int step = 0; step < 400; ++step) {
    const std::int32_t middle = step / 4 - 50;
    for (int i = 0; i < 20; ++i) {
      const Voxel voxel{middle + aside(random), aside(random), height(random)};
      const auto& [x, y, z] = voxel;
      columns.at(x, y, z).misses = step;
      expected[voxel] = step;
    }
    columns.keep_if([&](PointColumn& column) {
      std::erase_if(column.points, [&](const ColumnPoint& point) { return point.misses % 7 == 3; });
      return std::abs(column.x - middle) <= 10;
    });
    std::erase_if(expected, [&](const auto& entry) {
      return entry.second % 7 == 3 || std::abs(std::get<0>(entry.first) - middle) > 10;
    });
    ASSERT_EQ(content(columns), expected) << step;
  }
  columns.clear();
  EXPECT_TRUE(columns.columns().empty());
  EXPECT_EQ(columns.at(1, 2, 3).misses, 0);
}

TEST(RollingColumns, ANewColumnTakesThePlaceOfOneAWholeTurnAway) {
  RollingColumns columns(16);
  columns.at(3, -2, 0).misses = 1;
  columns.at(3, -2, 5).misses = 2;
  columns.at(3 + 16, -2, 1).misses = 3;
  EXPECT_EQ(content(columns), (std::map<Voxel, int>{{{19, -2, 1}, 3}}));
}

}  // namespace
}  // namespace lapis::controller
