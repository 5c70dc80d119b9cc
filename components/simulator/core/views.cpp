#include "simulator/core/views.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kSpacing_m = 0.4;  // between candidate places
constexpr int kHeadings = 12;
constexpr double kRoomAround_m = 0.15;
constexpr int kThumbnail_px = 48;
constexpr float kFarEnough_m = 8.0F;  // greater depths add no interest

/// Measure of how much a view has in sight: the sum over instances of the root of their pixels, times the mean depth.
double interest(const RenderedFrame& frame) {
  std::vector<int> pixels(65536, 0);
  double depth = 0.0;
  for (std::size_t i = 0; i < frame.depth.pixels.size(); ++i) {
    ++pixels[frame.instances.pixels[i]];
    depth += std::min(frame.depth.pixels[i], kFarEnough_m);
  }
  double sum = 0.0;
  for (std::size_t id = 1; id < pixels.size(); ++id) sum += std::sqrt(pixels[id]);
  return sum * depth / static_cast<double>(frame.depth.pixels.size());
}

struct Candidate {
  double interest = 0.0;
  Eigen::Vector2d position;
  double yaw_rad = 0.0;
};

geometry::PinholeCamera thumbnail_of(const geometry::PinholeCamera& camera) {
  const double scale = static_cast<double>(kThumbnail_px) / camera.width;
  const int height = std::max(static_cast<int>(camera.height * scale), 1);
  return {kThumbnail_px, height, camera.fx * scale, camera.fy * scale, 0.5 * (kThumbnail_px - 1), 0.5 * (height - 1)};
}

std::vector<Candidate> candidates_in(const Room& room, const World& world, const geometry::PinholeCamera& camera,
                                     const geometry::CameraMount& mount, double radius_m) {
  Eigen::AlignedBox2d box;
  for (const auto& corner : room.polygon) box.extend(corner);
  std::vector<Candidate> out;
  for (double x = box.min().x() + kSpacing_m / 2; x < box.max().x(); x += kSpacing_m) {
    for (double y = box.min().y() + kSpacing_m / 2; y < box.max().y(); y += kSpacing_m) {
      const Eigen::Vector2d p(x, y);
      if (!contains(room.polygon, p) || world.nav_map().distance_m(p) < radius_m + kRoomAround_m) continue;
      for (int i = 0; i < kHeadings; ++i) {
        const double yaw_rad = 2.0 * std::numbers::pi * i / kHeadings;
        const auto frame = world.renderer().render(camera, T_world_camera(world, mount, p, yaw_rad), false);
        out.push_back({interest(frame), p, yaw_rad});
      }
    }
  }
  return out;
}

std::vector<Room> rooms_of(const World& world) {
  if (!world.scene().rooms.empty()) return world.scene().rooms;
  const Grid& grid = world.nav_map().grid();
  const Eigen::Vector2d size(grid.width * grid.resolution_m, grid.height * grid.resolution_m), low = grid.origin;
  return {
      {"scene", "", {low, low + Eigen::Vector2d(size.x(), 0), low + size, low + Eigen::Vector2d(0, size.y())}, 2.6}};
}

}  // namespace

geometry::Pose T_world_camera(const World& world, const geometry::CameraMount& mount, const Eigen::Vector2d& position,
                              double yaw_rad) {
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d base(position.x(), position.y(), world.scene().floor_z_m);
  return geometry::make_pose(base, rotation) * geometry::T_base_camera(mount);
}

std::vector<ViewPoint> choose_views(const World& world, const geometry::PinholeCamera& camera,
                                    const geometry::CameraMount& mount, double robot_radius_m, int per_room) {
  std::vector<ViewPoint> views;
  for (const Room& room : rooms_of(world)) {
    auto candidates = candidates_in(room, world, thumbnail_of(camera), mount, robot_radius_m);
    for (int i = 1; i <= per_room && !candidates.empty(); ++i) {
      const auto best = *std::max_element(candidates.begin(), candidates.end(),
                                          [](const auto& a, const auto& b) { return a.interest < b.interest; });
      views.push_back({room.id + "_" + std::to_string(i), best.position, best.yaw_rad});
      // The next view has to look in another direction.
      std::erase_if(candidates, [&](const Candidate& c) { return std::cos(c.yaw_rad - best.yaw_rad) > -0.2; });
    }
  }
  return views;
}

}  // namespace lapis::simulator
