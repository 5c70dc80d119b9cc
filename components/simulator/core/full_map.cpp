#include "simulator/core/full_map.hpp"

#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "simulator/core/truth/explorable.hpp"
#include "simulator/core/truth/voxel_truth.hpp"
#include "simulator/core/views.hpp"

namespace lapis::simulator {
namespace {

constexpr double kPlaceSpacing_m = 1.0;  // between neighbouring places
constexpr double kOverlapping = 0.75;    // turn from one view to the next, as a share of the field of view
constexpr int kVersion = 1;              // has to be raised when other views or other code change the map

int views_all_round(const geometry::PinholeCamera& camera) {
  const double field_rad = 2.0 * std::atan(0.5 * camera.width / camera.fx);
  return static_cast<int>(std::ceil(2.0 * std::numbers::pi / (kOverlapping * field_rad)));
}

}  // namespace

IdealMap make_full_map(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config) {
  IdealMap map(config.resolution_m, config.frames);
  const auto places =
      viewpoints(world.nav_map(), T_world_base.translation().head<2>(), config.robot_radius_m, kPlaceSpacing_m);
  if (places.empty()) throw std::runtime_error("ground truth: the robot does not fit at its start");
  const int views = views_all_round(config.camera);
  for (const Eigen::Vector2d& place : places) {
    for (int view = 0; view < views && !config.cancelled.stop_requested(); ++view) {
      const geometry::Pose T = T_world_camera(world, config.mount, place, 2.0 * std::numbers::pi * view / views);
      const RenderedFrame frame = world.renderer().render(config.camera, T, false);
      map.add(config.camera, T_map_world(T_world_base) * T, frame.depth, frame.labels);
    }
  }
  return map;
}

std::string made_of(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config) {
  const auto& [integration, stride] = config.frames;
  const geometry::PinholeCamera& camera = config.camera;
  std::ostringstream text;
  text.precision(17);
  text << "version " << kVersion << ", scene " << world.hash() << ", " << world.raycaster().instruction_set()
       << ", start " << T_world_base.matrix().reshaped().transpose() << ", radius_m " << config.robot_radius_m
       << ", camera " << camera.width << ' ' << camera.height << ' ' << camera.fx << ' ' << camera.fy << ' '
       << camera.cx << ' ' << camera.cy << ", mount " << config.mount.height_m << ' ' << config.mount.pitch_down_rad
       << ", voxels " << config.resolution_m << ", frames " << integration.min_range_m << ' ' << integration.max_range_m
       << ' ' << integration.min_height_m << ' ' << integration.max_height_m << ' ' << integration.end_margin_voxels
       << ' ' << integration.depth_noise_per_m << ' ' << stride;
  return text.str();
}

}  // namespace lapis::simulator
