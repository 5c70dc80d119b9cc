#include "simulator/core/truth/explorable.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <utility>

#include "simulator/core/truth/mesh_voxels.hpp"

namespace lapis::simulator {
namespace {

constexpr double kPi = std::numbers::pi;

/// Directions to all sides within a range of elevation, which are at most `step_rad` apart.
std::vector<Eigen::Vector3f> directions(const ElevationRange& elevation, double step_rad) {
  std::vector<Eigen::Vector3f> out;
  const int rows = static_cast<int>(std::ceil((elevation.high_rad - elevation.low_rad) / step_rad));
  for (int row = 0; row <= rows; ++row) {
    const double share = rows == 0 ? 0.0 : static_cast<double>(row) / rows;
    const double up = elevation.low_rad + share * (elevation.high_rad - elevation.low_rad);
    const int columns = std::max(1, static_cast<int>(std::ceil(2.0 * kPi * std::cos(up) / step_rad)));
    for (int column = 0; column < columns; ++column) {
      const double around = 2.0 * kPi * column / columns;
      const Eigen::Vector3d d(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
      out.emplace_back(d.cast<float>());
    }
  }
  return out;
}

/// Marks the voxels through which rays pass [Amanatides, Woo, Eurographics 1987].
class Walker {
 public:
  explicit Walker(const VoxelBox& box) : box_(box), seen_(box) {}

  /// Marks every voxel on the line from one point of the box to another [voxels].
  void walk(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d along = to - from;
    const Eigen::Vector3i first = cell_of(from), last = cell_of(to);
    std::array<std::ptrdiff_t, 3> step{};
    Eigen::Vector3d next, pace;  // share of the line up to the next face of each axis, and between two faces
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_up = along[axis] > 0.0;
      step[static_cast<std::size_t>(axis)] = is_up ? box_.stride(axis) : -box_.stride(axis);
      pace[axis] = 1.0 / std::abs(along[axis]);
      next[axis] = first[axis] == last[axis] ? std::numeric_limits<double>::infinity()
                                             : std::abs(first[axis] + (is_up ? 1 : 0) - from[axis]) * pace[axis];
    }
    auto cell = static_cast<std::ptrdiff_t>(box_.cell(first));
    seen_.insert(static_cast<std::size_t>(cell));
    // There are as many steps as faces in between, so that rounding cannot lead beyond the end.
    Eigen::Vector3i left = (last - first).cwiseAbs();
    for (int i = left.sum(); i > 0; --i) {
      int axis = 0;
      next.minCoeff(&axis);
      cell += step[static_cast<std::size_t>(axis)];
      seen_.insert(static_cast<std::size_t>(cell));
      next[axis] = --left[axis] == 0 ? std::numeric_limits<double>::infinity() : next[axis] + pace[axis];
    }
  }

  /// Marks all voxels that contain a surface at this point.
  void meet(const Eigen::Vector3d& p) {
    for (const double dx : {-kTouch, kTouch}) {
      for (const double dy : {-kTouch, kTouch}) {
        for (const double dz : {-kTouch, kTouch}) seen_.insert(box_.cell(cell_of(p + Eigen::Vector3d(dx, dy, dz))));
      }
    }
  }

  const VoxelSet& seen() const { return seen_; }

 private:
  static Eigen::Vector3i cell_of(const Eigen::Vector3d& p) { return p.array().floor().cast<int>(); }

  const VoxelBox& box_;
  VoxelSet seen_;
};

/// Marks the voxels that are visible from a place in these directions.
void look(const SceneRaycaster& raycaster, const Eigen::Vector3d& from, const std::vector<Eigen::Vector3f>& directions,
          double range_m, const geometry::Pose& T_map_world, const VoxelBox& box, Walker& walker) {
  constexpr std::size_t kPacket = RayPacket::kSize;
  RayPacket rays{from.cast<float>()};
  rays.x.fill(1.0F);
  HitPacket hits;
  const Eigen::Vector3d origin = box.to_box(T_map_world * from);
  const Eigen::Matrix3d to_voxels = T_map_world.linear() / box.resolution_m();
  for (std::size_t begin = 0; begin < directions.size(); begin += kPacket) {
    const std::size_t count = std::min(kPacket, directions.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      rays.x[i] = directions[begin + i].x();
      rays.y[i] = directions[begin + i].y();
      rays.z[i] = directions[begin + i].z();
    }
    raycaster.cast(rays, std::numeric_limits<float>::infinity(), hits);
    for (std::size_t i = 0; i < count; ++i) {
      if (hits.triangle[i] == RayHit::kNone) continue;
      const auto distance = static_cast<double>(hits.distance[i]);
      const Eigen::Vector3d end =
          origin + std::min(distance, range_m) * (to_voxels * directions[begin + i].cast<double>());
      walker.walk(origin, end);
      if (distance <= range_m) walker.meet(end);
    }
  }
}

}  // namespace

std::vector<Eigen::Vector2d> viewpoints(const NavMap& map, const Eigen::Vector2d& start, double radius_m,
                                        double spacing_m) {
  const Grid& grid = map.grid();
  // A start that is just wide enough may be in a cell whose centre is not.
  const auto reachable = map.reachable(start, radius_m - 0.71 * grid.resolution_m);
  std::map<std::pair<int, int>, std::pair<double, Eigen::Vector2d>> nearest;  // by row and column of squares
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (reachable(column, row) == 0) continue;
      const Eigen::Vector2d p = grid.center({column, row});
      const Eigen::Vector2d square = (p / spacing_m).array().floor();
      const double distance = (p - spacing_m * (square + Eigen::Vector2d(0.5, 0.5))).norm();
      const std::pair key(static_cast<int>(square.y()), static_cast<int>(square.x()));
      const auto [it, is_new] = nearest.try_emplace(key, distance, p);
      if (!is_new && distance < it->second.first) it->second = {distance, p};
    }
  }
  std::vector<Eigen::Vector2d> points;
  for (const auto& [square, point] : nearest) points.push_back(point.second);
  return points;
}

ElevationRange elevation_range(const geometry::PinholeCamera& camera, double pitch_down_rad) {
  const Eigen::Matrix3d R = geometry::T_base_camera({0.0, pitch_down_rad}).linear();
  ElevationRange range{kPi / 2, -kPi / 2};
  const auto include = [&](double u, double v) {
    const double up = std::asin((R * camera.unproject(u, v, 1.0)).normalized().z());
    range = {std::min(range.low_rad, up), std::max(range.high_rad, up)};
  };
  // The image is connected, so its elevations are an interval; its ends are on the border, or at the zenith or nadir.
  for (int u = 0; u < camera.width; ++u) {
    include(u, 0);
    include(u, camera.height - 1);
  }
  for (int v = 0; v < camera.height; ++v) {
    include(0, v);
    include(camera.width - 1, v);
  }
  for (const double pole : {-1.0, 1.0}) {
    const Eigen::Vector3d p = R.transpose() * Eigen::Vector3d(0, 0, pole);
    if (p.z() <= 0.0 || !camera.contains(camera.project(p))) continue;
    (pole < 0.0 ? range.low_rad : range.high_rad) = pole * kPi / 2;
  }
  return range;
}

VoxelSet visible_voxels(const SceneRaycaster& raycaster, const std::vector<Eigen::Vector3d>& positions,
                        const VisibilityConfig& config, const geometry::Pose& T_map_world, const VoxelBox& box) {
  for (const auto& p : positions) {
    const Eigen::Vector3d v = box.to_box(T_map_world * p);
    if (!box.contains(v.array().floor().cast<int>())) throw std::invalid_argument("a place to see from is outside");
  }
  const auto rays = directions(config.elevation, box.resolution_m() / config.range_m);
  std::vector<Walker> walkers(static_cast<std::size_t>(std::max(config.threads, 1)), Walker(box));
  const auto work = [&](std::size_t thread) {
    for (std::size_t i = thread; i < positions.size() && !config.cancelled.stop_requested(); i += walkers.size()) {
      look(raycaster, positions[i], rays, config.range_m, T_map_world, box, walkers[thread]);
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < walkers.size(); ++i) threads.emplace_back(work, i);
  work(0);
  for (auto& thread : threads) thread.join();
  VoxelSet seen(box);
  for (const auto& walker : walkers) seen.insert(walker.seen());
  return seen;
}

VoxelSet flooded_voxels(const VoxelSet& solid, const std::vector<Eigen::Vector3d>& seeds,
                        const geometry::Pose& T_map_world, const VoxelBox& box) {
  VoxelSet flooded(box);
  std::vector<std::size_t> open;
  const auto take = [&](const Eigen::Vector3i& v) {
    if (!box.contains(v)) return;
    const std::size_t cell = box.cell(v);
    if (flooded.contains(cell)) return;
    flooded.insert(cell);
    if (!solid.contains(cell)) open.push_back(cell);
  };
  for (const auto& seed : seeds) {
    const Eigen::Vector3i v = box.to_box(T_map_world * seed).array().floor().cast<int>();
    if (box.contains(v) && !solid.contains(box.cell(v))) take(v);
  }
  while (!open.empty()) {
    const Eigen::Vector3i v = box.offset_of(open.back());
    open.pop_back();
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const bool is_over_face = step.cwiseAbs().sum() == 1;
      if (is_over_face || (box.contains(v + step) && solid.contains(box.cell(v + step)))) take(v + step);
    }
  }
  return flooded;
}

}  // namespace lapis::simulator
