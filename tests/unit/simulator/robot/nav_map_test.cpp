#include "simulator/core/robot/nav_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "floor_plan.hpp"
#include "simulator/core/robot/nav_map_picture.hpp"
#include "simulator/core/robot/regions.hpp"

namespace lapis::simulator {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

NavMap random_map(std::mt19937_64& engine, int width, int height, double share) {
  geometry::GrayImage blocked(width, height);
  for (auto& pixel : blocked.pixels) pixel = draw(engine, 0, 1) < share ? 255 : 0;
  return NavMap({{-1.0, 2.0}, 0.1, width, height}, blocked);
}

/// Distance in cells to the nearest cell whose state differs, by trying all.
double brute_force(const NavMap& map, Cell c) {
  double best = std::numeric_limits<double>::infinity();
  for (int row = 0; row < map.grid().height; ++row) {
    for (int column = 0; column < map.grid().width; ++column) {
      if (map.is_blocked({column, row}) != map.is_blocked(c))
        best = std::min(best, std::hypot(column - c.column, row - c.row));
    }
  }
  return best;
}

TEST(NavMap, DistanceIsThatOfBruteForce) {
  std::mt19937_64 engine(3);
  for (const double share : {0.01, 0.1, 0.6}) {
    const NavMap map = random_map(engine, 41, 29, share);
    for (int row = 0; row < 29; ++row) {
      for (int column = 0; column < 41; ++column) {
        const Cell c{column, row};
        const double cells = brute_force(map, c) - 0.5;
        EXPECT_NEAR(map.distance_at(c), 0.1 * (map.is_blocked(c) ? -cells : cells), 1e-5) << column << ' ' << row;
        EXPECT_NEAR(map.distance_m(map.grid().center(c)), map.distance_at(c), 1e-6);
      }
    }
  }
}

TEST(NavMap, GradientIsTheDerivativeOfDistance) {
  std::mt19937_64 engine(4);
  const NavMap map = random_map(engine, 40, 40, 0.05);
  const auto is_near_kink = [](double x) { return std::abs(x / 0.1 - 0.5 - std::round(x / 0.1 - 0.5)) < 1e-3; };
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d p(draw(engine, -0.9, 2.9), draw(engine, 2.1, 5.9));
    if (is_near_kink(p.x()) || is_near_kink(p.y())) continue;  // between centres of cells the slope jumps
    const double h = 1e-6;
    const Eigen::Vector2d dx(h, 0), dy(0, h);
    EXPECT_NEAR(map.gradient(p).x(), (map.distance_m(p + dx) - map.distance_m(p - dx)) / (2 * h), 1e-6);
    EXPECT_NEAR(map.gradient(p).y(), (map.distance_m(p + dy) - map.distance_m(p - dy)) / (2 * h), 1e-6);
  }
}

TEST(NavMap, PointsOutsideAreNotFree) {
  const NavMap map = map_of(2, 2, {});
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(-5, 1), Eigen::Vector2d(1, 1e9), Eigen::Vector2d(99, -99)}) {
    EXPECT_LT(map.distance_m(p), 0.0) << p.transpose();
  }
}

TEST(NavMap, ReachableIsFreeConnectedAndShrinksWithTheRadius) {
  std::mt19937_64 engine(5);
  const NavMap map = random_map(engine, 80, 80, 0.02);
  const Eigen::Vector2d start = map.grid().center({40, 40});
  geometry::GrayImage before = map.reachable(start, 0.0);
  for (const double radius : {0.05, 0.15, 0.25}) {
    const geometry::GrayImage now = map.reachable(start, radius);
    const geometry::GrayImage free = map.free_cells(radius);
    for (std::size_t i = 0; i < now.pixels.size(); ++i) {
      EXPECT_LE(now.pixels[i], before.pixels[i]);
      EXPECT_LE(now.pixels[i], free.pixels[i]);
    }
    EXPECT_LE(find_regions(now, Neighbours::kFour).sizes.size(), 1U);
    before = now;
  }
}

TEST(NavMap, WhereADiscFitsItReachesSomething) {
  std::mt19937_64 engine(11);
  const NavMap map = random_map(engine, 80, 80, 0.02);
  int fits = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d p(draw(engine, -1, 7), draw(engine, 2, 10));
    const double radius = map.distance_m(p) - 1e-6;  // just wide enough
    if (radius <= 0) continue;
    ++fits;
    const auto has_cells = [](const geometry::GrayImage& image) {
      return std::find(image.pixels.begin(), image.pixels.end(), 255) != image.pixels.end();
    };
    EXPECT_TRUE(has_cells(map.reachable(p, radius))) << p.transpose();
    EXPECT_FALSE(has_cells(map.reachable(p, radius + 2e-6))) << p.transpose();
  }
  EXPECT_GT(fits, 100);
}

TEST(NavMap, ADiscPassesAGapOnlyWhenItIsNarrower) {
  const NavMap map = map_of(4, 2, {{1.9, 0, 2.1, 0.7}, {1.9, 1.3, 2.1, 2}});  // a gap of 0.6 m
  const auto arrives = [&](double radius) {
    const Cell goal = map.grid().cell_of({3, 1});
    return map.reachable({1, 1}, radius)(goal.column, goal.row) != 0;
  };
  EXPECT_TRUE(arrives(0.28));
  EXPECT_FALSE(arrives(0.32));
}

TEST(Regions, FindsWhatIsConnected) {
  geometry::GrayImage cells(4, 3);
  for (const Cell c : {Cell{0, 0}, Cell{1, 0}, Cell{2, 1}, Cell{3, 2}}) cells(c.column, c.row) = 1;
  EXPECT_THAT(find_regions(cells, Neighbours::kFour).sizes, testing::ElementsAre(2, 1, 1));
  EXPECT_THAT(find_regions(cells, Neighbours::kEight).sizes, testing::ElementsAre(4));
}

/// A room of 4 x 3 m with floor at 1 m: a wall with a closed door, and things of all heights.
struct Building {
  enum Part : std::uint32_t { kFloor, kWall, kDoor, kThings };
  Scene scene;

  Building() {
    Mesh& mesh = scene.mesh;
    mesh.materials.emplace_back();
    add_level(mesh, {0, 0, 4, 1.4}, 1.0, kFloor);  // with a hole: 1.4 < y < 1.6, 3.4 < x < 3.6
    add_level(mesh, {0, 1.6, 4, 3}, 1.0, kFloor);
    add_level(mesh, {0, 1.4, 3.4, 1.6}, 1.0, kFloor);
    add_level(mesh, {3.6, 1.4, 4, 1.6}, 1.0, kFloor);
    add_box(mesh, {1.95, 0, 2.05, 1}, 1.0, 3.6, kWall);
    add_box(mesh, {1.95, 2, 2.05, 3}, 1.0, 3.6, kWall);
    add_box(mesh, {1.98, 1, 2.02, 2}, 1.0, 3.0, kDoor);
    add_box(mesh, {0.5, 0.5, 1.0, 1.0}, 1.0, 1.04, kThings);  // a mat
    add_level(mesh, {0.5, 2.0, 1.0, 2.5}, 1.7, kThings);      // a table
    add_box(mesh, {3.0, 0.5, 3.5, 1.0}, 2.3, 3.0, kThings);   // a cupboard that hangs high
    add_level(mesh, {-9, -9, 9, 9}, 0.8, kThings);            // the ground outside
    for (std::uint16_t i = 0; i < 4; ++i) scene.instances.push_back({static_cast<std::uint16_t>(i + 1), i, ""});
    scene.floor_z_m = 1.0;
  }
};

bool is_blocked(const NavMap& map, double x, double y) { return map.is_blocked(map.grid().cell_of({x, y})); }

TEST(BuildNavMap, SeesWhatStandsInTheWayOfTheRobot) {
  const NavMap map = build_nav_map(Building().scene);
  EXPECT_TRUE(is_blocked(map, 1.951, 0.5)) << "wall";
  EXPECT_TRUE(is_blocked(map, 1.981, 1.5)) << "door";
  EXPECT_TRUE(is_blocked(map, 0.75, 2.25)) << "table";
  EXPECT_TRUE(is_blocked(map, 3.5, 1.5)) << "hole in the floor";
  EXPECT_TRUE(is_blocked(map, -0.04, 1.5)) << "outside";
  EXPECT_FALSE(is_blocked(map, 0.75, 0.75)) << "mat";
  EXPECT_FALSE(is_blocked(map, 3.25, 0.75)) << "hanging cupboard";
  EXPECT_FALSE(is_blocked(map, 0.1, 0.1)) << "floor";
}

TEST(BuildNavMap, DoorsCanBeLeftOut) {
  const Building building;
  const auto arrives = [&](const NavMap& map) {
    const Cell goal = map.grid().cell_of({3, 1.5});
    return map.reachable({1, 1.5}, 0.2)(goal.column, goal.row) != 0;
  };
  EXPECT_FALSE(arrives(build_nav_map(building.scene)));
  EXPECT_TRUE(arrives(build_nav_map(building.scene, {}, {Building::kDoor})));
}

TEST(BuildNavMap, DistancesAreThoseOfTheGeometryWithinACell) {
  Mesh mesh;
  add_level(mesh, {0.013, 0.007, 5.021, 4.017}, 0, 0);
  add_box(mesh, {2.011, 1.492, 2.519, 2.513}, 0, 1, 0);
  const NavMap map = build_nav_map(mesh, 0, {}, [](std::uint32_t) { return true; });
  std::mt19937_64 engine(6);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d p(draw(engine, 0.1, 4.9), draw(engine, 0.1, 3.9));
    const double dx = std::max({2.011 - p.x(), p.x() - 2.519, 0.0}), dy = std::max({1.492 - p.y(), p.y() - 2.513, 0.0});
    if (dx == 0 && dy == 0) continue;  // in the box
    const double truth = std::min({std::hypot(dx, dy), p.x() - 0.013, 5.021 - p.x(), p.y() - 0.007, 4.017 - p.y()});
    EXPECT_LE(map.distance_m(p), truth + 0.026) << p.transpose();
    EXPECT_GE(map.distance_m(p), truth - 0.04) << p.transpose();
  }
}

TEST(BuildNavMap, SaysWhatIsWrong) {
  const auto all = [](std::uint32_t) { return true; };
  Mesh mesh;
  add_level(mesh, {0, 0, 4, 3}, 0, 0);
  EXPECT_THAT([&] { build_nav_map(mesh, 5.0, {}, all); }, ThrowsMessage<std::runtime_error>(HasSubstr("no floor")));
  add_level(mesh, {0, 0, 4e6, 3}, 0, 0);
  EXPECT_THAT([&] { build_nav_map(mesh, 0.0, {}, all); }, ThrowsMessage<std::runtime_error>(HasSubstr("units")));
}

TEST(NavMapPicture, ShowsNorthUpAndSurvivesPng) {
  const NavMap map = map_of(1, 0.5, {{0.8, 0.1, 0.9, 0.4}}, 0.05);
  const auto image = draw_nav_map(map, map.reachable({0.3, 0.25}, 0.05), {{{0.1, 0.4}, {0.4, 0.4}}});
  ASSERT_EQ(image.width, 20);
  ASSERT_EQ(image.height, 10);
  EXPECT_EQ(image(17, 5), (geometry::Rgb8{0, 0, 0}));
  EXPECT_EQ(image(14, 5).b, 245) << "reachable";
  EXPECT_EQ(image(5, 1).r, 200) << "line in the upper half";
  const auto bytes = encode_png(image);
  const cv::Mat back = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(back.cols, 20);
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 20; ++column) {
      const auto& bgr = back.at<cv::Vec3b>(row, column);
      EXPECT_EQ((geometry::Rgb8{bgr[2], bgr[1], bgr[0]}), image(column, row)) << column << ' ' << row;
    }
  }
}

}  // namespace
}  // namespace lapis::simulator
