#include "simulator/core/robot/nav_map.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "simulator/core/robot/regions.hpp"

namespace lapis::simulator {
namespace {

/// Distance from each pixel that is not 0 to the nearest one that is, in pixels; exact.
cv::Mat distance_to_zero(const cv::Mat& mask) {
  cv::Mat distance;
  cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  return distance;
}

void block_border(geometry::GrayImage& blocked) {
  for (int column = 0; column < blocked.width; ++column) {
    blocked(column, 0) = blocked(column, blocked.height - 1) = 255;
  }
  for (int row = 0; row < blocked.height; ++row) blocked(0, row) = blocked(blocked.width - 1, row) = 255;
}

geometry::Image<float> signed_distance(geometry::GrayImage& blocked, double resolution_m) {
  const cv::Mat mask(blocked.height, blocked.width, CV_8UC1, blocked.pixels.data());
  const cv::Mat inside = distance_to_zero(mask), outside = distance_to_zero(mask == 0);
  const auto scale = static_cast<float>(resolution_m);
  geometry::Image<float> distance(blocked.width, blocked.height);
  for (int row = 0; row < blocked.height; ++row) {
    for (int column = 0; column < blocked.width; ++column) {
      const float in = inside.at<float>(row, column), out = outside.at<float>(row, column);
      distance(column, row) = scale * (in > 0 ? 0.5F - in : out - 0.5F);
    }
  }
  return distance;
}

}  // namespace

NavMap::NavMap(const Grid& grid, geometry::GrayImage blocked) : grid_(grid), blocked_(std::move(blocked)) {
  block_border(blocked_);
  distance_ = signed_distance(blocked_, grid_.resolution_m);
}

NavMap::Corners NavMap::corners(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d q = (p - grid_.origin) / grid_.resolution_m - Eigen::Vector2d(0.5, 0.5);
  const double x = std::clamp(q.x(), 0.0, grid_.width - 1.0), y = std::clamp(q.y(), 0.0, grid_.height - 1.0);
  const int column = std::min(static_cast<int>(x), grid_.width - 2);
  const int row = std::min(static_cast<int>(y), grid_.height - 2);
  return {distance_at({column, row}),
          distance_at({column + 1, row}),
          distance_at({column, row + 1}),
          distance_at({column + 1, row + 1}),
          x - column,
          y - row};
}

double NavMap::distance_m(const Eigen::Vector2d& p) const {
  const Corners c = corners(p);
  return (1 - c.v) * ((1 - c.u) * c.d00 + c.u * c.d10) + c.v * ((1 - c.u) * c.d01 + c.u * c.d11);
}

Eigen::Vector2d NavMap::gradient(const Eigen::Vector2d& p) const {
  const Corners c = corners(p);
  const Eigen::Vector2d per_cell((1 - c.v) * (c.d10 - c.d00) + c.v * (c.d11 - c.d01),
                                 (1 - c.u) * (c.d01 - c.d00) + c.u * (c.d11 - c.d10));
  return per_cell / grid_.resolution_m;
}

geometry::GrayImage NavMap::free_cells(double radius_m) const {
  geometry::GrayImage cells(grid_.width, grid_.height);
  const auto is_free = [&](float distance) { return static_cast<double>(distance) >= radius_m; };
  std::transform(distance_.pixels.begin(), distance_.pixels.end(), cells.pixels.begin(),
                 [&](float distance) { return is_free(distance) ? std::uint8_t{255} : std::uint8_t{0}; });
  return cells;
}

geometry::GrayImage NavMap::reachable(const Eigen::Vector2d& start, double radius_m) const {
  if (distance_m(start) < radius_m) return geometry::GrayImage(grid_.width, grid_.height);
  const Cell c = grid_.cell_of(start - 0.5 * grid_.resolution_m * Eigen::Vector2d::Ones());
  // One of the four centres around the start is free, because the distance there is a mean of theirs.
  Cell seed = c;
  for (const Cell other : {Cell{c.column + 1, c.row}, Cell{c.column, c.row + 1}, Cell{c.column + 1, c.row + 1}}) {
    if (grid_.contains(other) && distance_at(other) > distance_at(seed)) seed = other;
  }
  return region_around(free_cells(radius_m), seed);
}

}  // namespace lapis::simulator
