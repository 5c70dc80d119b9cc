#include "simulator/core/robot/slab_raster.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "floor_plan.hpp"

namespace lapis::simulator {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

Corners random_triangle(std::mt19937_64& engine, double size) {
  const Eigen::Vector3d middle(draw(engine, -0.2, 1.2), draw(engine, -0.2, 1.2), draw(engine, 0, 1));
  Corners corners;
  for (auto& corner : corners)
    corner = middle + Eigen::Vector3d(draw(engine, -size, size), draw(engine, -size, size), draw(engine, -size, size));
  return corners;
}

double area(const SlabPolygon& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size; ++i) {
    sum += (polygon.corners[i - 1] - polygon.corners[0]).cross(polygon.corners[i] - polygon.corners[0]);
  }
  return 0.5 * sum.norm();
}

TEST(SlabClip, SlabsThatShareSpaceShareTheTriangle) {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 1000; ++i) {
    const Corners t = random_triangle(engine, 1.0);
    const double whole = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    double sum = 0;
    for (const Slab slab : {Slab{-9, 0.2}, Slab{0.2, 0.5}, Slab{0.5, 0.9}, Slab{0.9, 9}}) {
      const SlabPolygon part = clip(t, slab);
      sum += area(part);
      for (std::size_t k = 0; k < part.size; ++k) {
        EXPECT_GE(part.corners[k].z(), slab.low - 1e-12);
        EXPECT_LE(part.corners[k].z(), slab.high + 1e-12);
      }
    }
    EXPECT_NEAR(sum, whole, 1e-12);
  }
}

/// Separating axes of a convex polygon and a unit cell: the axes of the cell and the normals of the edges.
bool overlap(const std::vector<Eigen::Vector2d>& polygon, Cell c) {
  std::vector<Eigen::Vector2d> axes{{1, 0}, {0, 1}};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    axes.emplace_back(-edge.y(), edge.x());
  }
  return std::all_of(axes.begin(), axes.end(), [&](const Eigen::Vector2d& axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low, cell_low = low, cell_high = -low;
    for (const auto& p : polygon) {
      low = std::min(low, axis.dot(p));
      high = std::max(high, axis.dot(p));
    }
    for (const auto& p : {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 1)}) {
      const double at = axis.dot(Eigen::Vector2d(c.column, c.row) + p);
      cell_low = std::min(cell_low, at);
      cell_high = std::max(cell_high, at);
    }
    return low <= cell_high && cell_low <= high;
  });
}

class SlabMark : public testing::TestWithParam<double> {};

TEST_P(SlabMark, MarksExactlyTheCellsThatATriangleTouches) {
  std::mt19937_64 engine(2);
  const Grid grid{{0, 0}, 0.05, 20, 20};
  for (int i = 0; i < 300; ++i) {
    const SlabPolygon polygon = clip(random_triangle(engine, GetParam()), {0.2, 0.8});
    geometry::GrayImage cells(grid.width, grid.height);
    mark(polygon, grid, cells);
    std::vector<Eigen::Vector2d> corners;
    for (std::size_t k = 0; k < polygon.size; ++k) corners.emplace_back(polygon.corners[k].head<2>() / 0.05);
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        EXPECT_EQ(cells(column, row) != 0, !corners.empty() && overlap(corners, {column, row}))
            << "triangle " << i << ", cell " << column << ' ' << row;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, SlabMark, testing::Values(0.01, 0.1, 1.0));

TEST(SlabMark, VerticalWallsAreThinAndPointsAreOneCell) {
  const Grid grid{{0, 0}, 0.1, 10, 10};
  geometry::GrayImage cells(10, 10);
  mark(clip({Eigen::Vector3d(0.55, 0.15, 0), {0.55, 0.85, 0}, {0.55, 0.5, 2}}, {-1, 1}), grid, cells);
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      EXPECT_EQ(cells(column, row) != 0, column == 5 && row >= 1 && row <= 8) << column << ' ' << row;
    }
  }
  geometry::GrayImage one(10, 10);
  const Eigen::Vector3d p(0.33, 0.77, 0.5);
  mark(clip({p, p, p}, {0, 1}), grid, one);
  EXPECT_EQ(std::count(one.pixels.begin(), one.pixels.end(), 255), 1);
  EXPECT_EQ(one(3, 7), 255);
}

}  // namespace
}  // namespace lapis::simulator
