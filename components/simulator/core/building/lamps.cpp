#include "simulator/core/building/lamps.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/core/building/structure.hpp"
#include "simulator/core/looks/shapes.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kAreaPerLamp_m2 = 12.0, kBelowCeiling_m = 0.35, kFromWall_m = 0.25;

/// Points on a grid of at most 0.25 m inside a polygon, row by row along its longer side.
std::vector<Eigen::Vector2d> floor_points(const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const auto& corner : polygon) box.extend(corner);
  const bool is_wide = box.sizes().x() >= box.sizes().y();
  const double step = std::min(0.25, box.sizes().minCoeff() / 4.0);
  const double longer = box.sizes().maxCoeff(), shorter = box.sizes().minCoeff();
  std::vector<Eigen::Vector2d> points;
  for (double a = 0.5 * step; a < longer; a += step) {
    for (double b = 0.5 * step; b < shorter; b += step) {
      const Eigen::Vector2d point = box.min() + (is_wide ? Eigen::Vector2d(a, b) : Eigen::Vector2d(b, a));
      if (contains(polygon, point)) points.push_back(point);
    }
  }
  return points;
}

bool is_far_from_walls(const Polygon& polygon, const Eigen::Vector2d& p) {
  return contains(polygon, p) && distance_to_border(polygon, p) > kFromWall_m;
}

/// Moves each centre that is too near to a wall to the nearest of `points` that is not, if there is one.
void leave_walls(std::vector<Eigen::Vector2d>& centers, std::vector<Eigen::Vector2d> points, const Polygon& polygon) {
  std::erase_if(points, [&](const auto& point) { return !is_far_from_walls(polygon, point); });
  for (Eigen::Vector2d& center : centers) {
    if (points.empty() || is_far_from_walls(polygon, center)) continue;
    center = *std::min_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return (a - center).squaredNorm() < (b - center).squaredNorm();
    });
  }
}

/// `count` centres that divide the floor among them, by Lloyd's algorithm.
std::vector<Eigen::Vector2d> spread(const Polygon& polygon, std::size_t count) {
  const auto points = floor_points(polygon);
  std::vector<Eigen::Vector2d> centers;
  for (std::size_t i = 0; i < count && !points.empty(); ++i)
    centers.push_back(points[(2 * i + 1) * points.size() / (2 * count)]);
  for (int round = 0; round < 20; ++round) {
    std::vector<Eigen::Vector2d> sums(centers.size(), Eigen::Vector2d::Zero());
    std::vector<double> counts(centers.size(), 0.0);
    for (const auto& point : points) {
      const auto nearest = std::min_element(centers.begin(), centers.end(), [&](const auto& a, const auto& b) {
        return (a - point).squaredNorm() < (b - point).squaredNorm();
      });
      const auto i = static_cast<std::size_t>(nearest - centers.begin());
      sums[i] += point;
      counts[i] += 1.0;
    }
    for (std::size_t i = 0; i < centers.size(); ++i) {
      // The centroid of a share that is not convex may be in a wall or outside the room; then the lamp stays.
      const Eigen::Vector2d middle = counts[i] > 0.0 ? sums[i] / counts[i] : centers[i];
      if (is_far_from_walls(polygon, middle)) centers[i] = middle;
    }
  }
  leave_walls(centers, points, polygon);
  return centers;
}

}  // namespace

std::vector<LampSpec> lamps_of(const SceneSpec& spec) {
  if (!spec.lamps.empty()) return spec.lamps;
  std::vector<LampSpec> lamps;
  for (const RoomSpec& room : spec.rooms) {
    const long count = std::max(1L, std::lround(signed_area(room.polygon) / kAreaPerLamp_m2));
    for (const auto& at : spread(room.polygon, static_cast<std::size_t>(count))) lamps.push_back({at, {}, 1.0});
  }
  return lamps;
}

void add_lamp(Scene& scene, const SceneSpec& spec, const LampSpec& lamp) {
  constexpr float kRadius_m = 0.18F, kShade_m = 0.1F, kGap_m = 0.05F;
  const auto room = std::find_if(spec.rooms.begin(), spec.rooms.end(),
                                 [&](const RoomSpec& candidate) { return contains(candidate.polygon, lamp.at); });
  const double ceiling = room->height_m.value_or(spec.height_m);
  const auto top = static_cast<float>(ceiling),
             z = static_cast<float>(lamp.height_m.value_or(ceiling - kBelowCeiling_m));
  const Eigen::Vector3f foot(static_cast<float>(lamp.at.x()), static_cast<float>(lamp.at.y()), z);
  // The light is below its shade, which would block it otherwise.
  scene.lamps.push_back({foot - kGap_m * Eigen::Vector3f::UnitZ(), static_cast<float>(lamp.intensity)});
  Shapes shapes(scene.mesh);
  shapes.part = add_instance(scene, "lighting", "lamp " + std::to_string(scene.lamps.size()));
  const auto shade = shapes.emissive_material("shade", {255, 246, 224});
  const float height = std::max(0.02F, std::min(kShade_m, top - z));
  shapes.cylinder(foot, {kRadius_m, kRadius_m}, {0.7F * kRadius_m, 0.7F * kRadius_m}, height, shade, 16);
  if (top - z - height < 0.02F) return;
  shapes.cylinder(foot + height * Eigen::Vector3f::UnitZ(), {0.01F, 0.01F}, {0.01F, 0.01F}, top - z - height,
                  shapes.material("cord", {60, 60, 60}), 6);
}

}  // namespace lapis::simulator
