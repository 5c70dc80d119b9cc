#include "simulator/core/looks/shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapis::simulator {
namespace {

/// Volume inside a closed surface whose triangles are counter-clockwise from outside (divergence theorem).
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.positions[t.vertices[0]], &b = mesh.positions[t.vertices[1]],
               &c = mesh.positions[t.vertices[2]];
    sum += a.cast<double>().dot(b.cast<double>().cross(c.cast<double>())) / 6.0;
  }
  return sum;
}

TEST(Shapes, SolidsAreClosedAndLookOutwards) {
  Mesh box, cylinder, ball;
  Shapes(box).box({-1, 0, 2}, {1, 1.5F, 3}, Shapes(box).material("m", {1, 2, 3}));
  EXPECT_NEAR(volume(box), 3.0, 1e-5);
  Shapes(cylinder).cylinder({3, 1, 0}, {0.5F, 0.5F}, {0.5F, 0.5F}, 2.0F, Shapes(cylinder).material("m", {}), 100);
  EXPECT_NEAR(volume(cylinder), 2.0 * std::numbers::pi * 0.25, 0.005);
  Shapes(ball).ball({1, 2, 3}, {0.5F, 1.0F, 1.5F}, Shapes(ball).material("m", {}), 60);
  EXPECT_NEAR(volume(ball), 4.0 / 3.0 * std::numbers::pi * 0.75, 0.03);
  for (const Mesh* mesh : {&box, &cylinder, &ball}) EXPECT_EQ(problem_of(*mesh), "");
}

TEST(Shapes, GridLinesKeepTheirValuesAndFillGaps) {
  const auto lines = grid_lines({2.0, 0.0, 0.5, 2.0002}, 0.4);
  EXPECT_EQ(lines.front(), 0.0);
  EXPECT_NEAR(lines.back(), 2.0, 1e-3);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), 0.5), 1);
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    EXPECT_GT(lines[i + 1] - lines[i], 1e-3);
    EXPECT_LE(lines[i + 1] - lines[i], 0.4 + 1e-9);
  }
}

TEST(Shapes, CellsOfASheetShareCorners) {
  Mesh mesh;
  Shapes shapes(mesh);
  const auto material = shapes.material("m", {});
  const Sheet sheet{{0, 0, 1}, Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY(), 2.0};
  shapes.sheet(
      sheet, {0, 1, 2, 3}, {0, 1, 2}, [](const Eigen::AlignedBox2d& cell) { return cell.max().x() < 2.5; }, material);
  EXPECT_EQ(mesh.triangles.size(), 2U * 4U);
  EXPECT_EQ(mesh.positions.size(), 9U);
  const auto& first = mesh.triangles.front().vertices;
  const Eigen::Vector3f a = mesh.positions[first[1]] - mesh.positions[first[0]];
  EXPECT_GT(a.cross(mesh.positions[first[2]] - mesh.positions[first[0]]).z(), 0.0F);
  EXPECT_FLOAT_EQ(mesh.texture_coordinates[first[1]].x(), 0.5F);
}

TEST(Shapes, FitToBoxKeepsWhatIsFlatFlat) {
  Mesh mesh;
  mesh.positions = {{1, 1, 5}, {3, 1, 5}, {3, 2, 5}};
  fit_to_box(mesh, {1.0, 4.0, 0.5});
  const auto box = bounds(mesh);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(-0.5F, -2.0F, 0.0F)));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(0.5F, 2.0F, 0.0F)));
}

}  // namespace
}  // namespace lapis::simulator
