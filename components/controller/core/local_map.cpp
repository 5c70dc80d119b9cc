#include "controller/core/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace lapis::controller {
namespace {

constexpr double kEdge_m = 0.05;       // edge of a voxel
constexpr double kNearest_m = 0.1;     // smaller depths are no measurements
constexpr double kBehind_m = 0.15;     // an image sees through a point if its depth is larger by this,
constexpr double kBehind = 0.02;       // plus this share of the point's depth,
constexpr int kAround_px = 2;          // at its pixel and this far around it, because edges are ragged
constexpr double kTouch_m = 0.05;      // a point this near to an occupied cell explains it
constexpr double kFoot_m = 0.07;       // an obstacle may be wider by this below the image
constexpr double kFootHeight_m = 0.2;  // an obstacle seen down to this height has shown its foot
constexpr double kStands_m_s = 0.03, kStands_rad_s = 0.05;  // poses of a standing robot change less

/// Index of a voxel along any axis.
std::int32_t index_of(double metres) { return static_cast<std::int32_t>(std::floor(metres / kEdge_m)); }
double center_of(std::int32_t index) { return (index + 0.5) * kEdge_m; }

Eigen::Vector2d center_of(const PointColumn& column) { return {center_of(column.x), center_of(column.y)}; }
/// Centre of the column that contains a point.
Eigen::Vector2d center_of_column(const Eigen::Vector2d& p_map) {
  return {center_of(index_of(p_map.x())), center_of(index_of(p_map.y()))};
}

const auto is_before = [](const auto& a, const auto& b) {
  return std::pair(a.p_map.x(), a.p_map.y()) < std::pair(b.p_map.x(), b.p_map.y());
};

/// Columns are kept within a distance of the robot. A wide image may add columns beyond it, which displace kept columns
/// on the opposite side until they are forgotten.
int reach_cells(double kept_m) { return static_cast<int>(std::ceil(4.0 * kept_m / kEdge_m)); }

/// True when a depth image sees nothing at or in front of this point of the optical frame; also false when it cannot
/// tell.
bool looks_through(const DepthView& view, const Eigen::Vector3d& p_camera) {
  if (p_camera.z() < kNearest_m) return false;
  const Eigen::Vector2d pixel = view.camera.project(p_camera);
  if (!view.camera.contains(pixel, kAround_px + 1)) return false;
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  const double enough_m = p_camera.z() * (1.0 + kBehind) + kBehind_m;
  const std::pair<int, int> around[] = {{0, 0}, {-kAround_px, 0}, {kAround_px, 0}, {0, -kAround_px}, {0, kAround_px}};
  return std::all_of(std::begin(around), std::end(around), [&](const auto& offset) {
    return static_cast<double>(view.depth(u + offset.first, v + offset.second)) > enough_m;
  });
}

std::pair<int, int> cell_of(const Grid& grid, const Eigen::Vector2d& p_map) {
  const Eigen::Vector2d cell = (p_map - grid.origin) / grid.resolution_m;
  return {static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y()))};
}

}  // namespace

std::int8_t Grid::at(const Eigen::Vector2d& p_map) const {
  if (cells.empty()) return kUnknown;
  const Eigen::Vector2d cell = (p_map - origin) / resolution_m;
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < width && cell.y() < height)) return kUnknown;
  return cells[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(cell.x())];
}

LocalMap::LocalMap(const LocalMapConfig& config) : config_(config), points_(reach_cells(kept_m())) {}

void LocalMap::add(const DepthView& view, const PlanarPose& T_map_base, time::Time stamp, bool has_path) {
  pass_time(T_map_base, stamp, has_path);
  forget(T_map_base);
  look_through(view, T_map_base);
  add_hits(view, T_map_base);
}

/// Advances the time that counts for the memory. Forgets all points when stamps go back.
void LocalMap::pass_time(const PlanarPose& T_map_base, time::Time stamp, bool has_path) {
  if (last_) {
    const PlanarPose T_last_base = last_->T_map_base.inverse() * T_map_base;
    const double elapsed_s = (stamp - last_->stamp).seconds();
    if (elapsed_s < 0.0) points_.clear();
    const bool moves = T_last_base.translation().norm() > kStands_m_s * elapsed_s ||
                       std::abs(yaw_of(T_last_base)) > kStands_rad_s * elapsed_s;
    if (moves || has_path) time_s_ += std::max(elapsed_s, 0.0);
  }
  last_ = {T_map_base, stamp};
}

void LocalMap::move_points(const PlanarPose& T_new_old) {
  RollingColumns moved(reach_cells(kept_m()));
  for (const PointColumn& column : points_.columns()) {
    const Eigen::Vector2d p_new = T_new_old * center_of(column);
    for (const ColumnPoint& point : column.points) {
      ColumnPoint& there = moved.at(index_of(p_new.x()), index_of(p_new.y()), point.z);
      if (std::pair(point.seen_s, -point.misses) > std::pair(there.seen_s, -there.misses)) there = point;
    }
  }
  points_ = std::move(moved);
  last_.reset();
}

void LocalMap::forget(const PlanarPose& T_map_base) {
  points_.keep_if([&](PointColumn& column) {
    std::erase_if(column.points, [&](const ColumnPoint& point) { return time_s_ - point.seen_s > config_.memory_s; });
    return (center_of(column) - T_map_base.translation()).norm() <= kept_m();
  });
}

void LocalMap::look_through(const DepthView& view, const PlanarPose& T_map_base) {
  const PlanarPose T_base_map = T_map_base.inverse();
  const geometry::Pose T_camera_base = view.T_base_camera.inverse();
  points_.keep_if([&](PointColumn& column) {
    const Eigen::Vector2d p_base = T_base_map * center_of(column);
    for (ColumnPoint& point : column.points) {
      if (looks_through(view, T_camera_base * Eigen::Vector3d(p_base.x(), p_base.y(), center_of(point.z))))
        ++point.misses;
    }
    std::erase_if(column.points, [&](const ColumnPoint& point) { return point.misses >= config_.misses_to_clear; });
    return true;
  });
}

void LocalMap::add_hits(const DepthView& view, const PlanarPose& T_map_base) {
  for (int row = 0; row < view.depth.height; row += config_.stride) {
    for (int column = 0; column < view.depth.width; column += config_.stride) {
      const auto depth_m = static_cast<double>(view.depth(column, row));
      if (depth_m < kNearest_m || depth_m > config_.range_m) continue;
      const Eigen::Vector3d p_base = view.T_base_camera * view.camera.unproject(column, row, depth_m);
      if (p_base.z() < config_.min_height_m || p_base.z() > config_.max_height_m) continue;
      const Eigen::Vector2d p_map = T_map_base * p_base.head<2>();
      ColumnPoint& point = points_.at(index_of(p_map.x()), index_of(p_map.y()), index_of(p_base.z()));
      point.seen_s = time_s_;
      point.misses = 0;
    }
  }
}

/// Columns within a distance of a point, sorted by x and then y.
std::vector<LocalMap::Column> LocalMap::columns_near(const Eigen::Vector2d& p_map, double distance_m) const {
  std::vector<Column> columns;
  for (const PointColumn& column : points_.columns()) {
    const Eigen::Vector2d center = center_of(column);
    if ((center - p_map).squaredNorm() > distance_m * distance_m) continue;
    const auto is_lower = [](const ColumnPoint& a, const ColumnPoint& b) { return a.z < b.z; };
    const auto lowest = std::min_element(column.points.begin(), column.points.end(), is_lower);
    columns.push_back({center, lowest->z * kEdge_m});
  }
  std::sort(columns.begin(), columns.end(), is_before);
  return columns;
}

Surroundings LocalMap::near(const PlanarPose& T_map_base, double distance_m) const {
  const PlanarPose T_base_map = T_map_base.inverse();
  const double cell_m = std::max(plan_.resolution_m, obstacles_.resolution_m);
  const auto columns = columns_near(T_map_base.translation(), distance_m + cell_m);
  Surroundings around;
  for (const Column& column : columns) {
    const Eigen::Vector2d p_base = T_base_map * column.p_map;
    if (p_base.norm() > distance_m) continue;
    around.obstacles.push_back(p_base);
    add_unseen_feet(column, columns, T_base_map, around.unseen_feet);
  }
  add_occupied(plan_, T_map_base, distance_m, columns, around.obstacles);
  add_occupied(obstacles_, T_map_base, distance_m, columns, around.obstacles);
  return around;
}

/// Adds a point on each side of a column, except where another column stands or where this column is between the point
/// and the robot.
void LocalMap::add_unseen_feet(const Column& column, const std::vector<Column>& columns, const PlanarPose& T_base_map,
                               std::vector<Eigen::Vector2d>& points) const {
  const double shown_m = std::max(kFootHeight_m, config_.min_height_m + 2.0 * kEdge_m);  // lower points are not kept
  if (column.lowest_m < shown_m) return;
  const double behind_m = (T_base_map * column.p_map).norm() + 0.5 * kFoot_m;
  for (const int quarter : {0, 1, 2, 3}) {
    const Eigen::Vector2d aside = Eigen::Rotation2Dd(0.5 * std::numbers::pi * quarter) * Eigen::Vector2d(kFoot_m, 0.0);
    const Eigen::Vector2d p_map = column.p_map + aside, p_base = T_base_map * p_map;
    const Column there{center_of_column(p_map), 0.0};
    const bool is_taken = std::binary_search(columns.begin(), columns.end(), there, is_before);
    if (p_base.norm() < behind_m && !is_taken) points.push_back(p_base);
  }
}

void LocalMap::add_occupied(const Grid& grid, const PlanarPose& T_map_base, double distance_m,
                            const std::vector<Column>& columns, std::vector<Eigen::Vector2d>& points) const {
  if (grid.cells.empty()) return;
  std::set<std::pair<int, int>> explained;
  for (const Column& column : columns) {
    for (const double dx : {-kTouch_m, kTouch_m}) {
      for (const double dy : {-kTouch_m, kTouch_m})
        explained.insert(cell_of(grid, column.p_map + Eigen::Vector2d(dx, dy)));
    }
  }
  const PlanarPose T_base_map = T_map_base.inverse();
  const auto [west, south] = cell_of(grid, T_map_base.translation() - Eigen::Vector2d::Constant(distance_m));
  const auto [east, north] = cell_of(grid, T_map_base.translation() + Eigen::Vector2d::Constant(distance_m));
  for (int row = std::max(south, 0); row <= std::min(north, grid.height - 1); ++row) {
    for (int column = std::max(west, 0); column <= std::min(east, grid.width - 1); ++column) {
      const Eigen::Vector2d p_map = grid.origin + grid.resolution_m * Eigen::Vector2d(column + 0.5, row + 0.5);
      const bool is_overruled = &grid == &plan_ && obstacles_.at(p_map) != Grid::kUnknown;
      if (is_overruled || grid.at(p_map) < Grid::kOccupiedFrom || explained.contains({column, row})) continue;
      const Eigen::Vector2d p_base = T_base_map * p_map;
      if (p_base.norm() <= distance_m) points.push_back(p_base);
    }
  }
}

bool LocalMap::is_known_free(const Eigen::Vector2d& p_map) const {
  const std::int8_t lately = obstacles_.at(p_map);
  const std::int8_t value = lately != Grid::kUnknown ? lately : plan_.at(p_map);
  return value != Grid::kUnknown && value < Grid::kOccupiedFrom;
}

}  // namespace lapis::controller
