#include "simulator/core/world.hpp"

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/render/light_cache.hpp"
#include "simulator/core/robot/starts.hpp"

namespace lapis::simulator {
namespace {

void require_sound(const Scene& scene) {
  if (scene.mesh.triangles.empty()) throw std::runtime_error("scene " + scene.name + ": holds no triangles");
  const std::string problem = problem_of(scene.mesh);
  if (!problem.empty()) throw std::runtime_error("scene " + scene.name + ": " + problem);
  const auto names_no_instance = [&](const Triangle& t) { return t.part >= scene.instances.size(); };
  if (std::any_of(scene.mesh.triangles.begin(), scene.mesh.triangles.end(), names_no_instance)) {
    throw std::runtime_error("scene " + scene.name + ": a triangle belongs to no instance");
  }
}

StartPose draw_anywhere(const World& world, double radius_m, const Random& random) {
  const NavMap& map = world.nav_map();
  const auto cells = open_cells(map, radius_m);
  if (cells.empty()) throw std::runtime_error("scene " + world.scene().name + ": the robot fits nowhere");
  const auto drawn = static_cast<std::size_t>(random.uniform(1) * static_cast<double>(cells.size()));
  return {map.grid().center(cells[drawn]), random.uniform(2, -std::numbers::pi, std::numbers::pi)};
}

std::string place(const StartPose& start) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f)", start.position.x(), start.position.y());
  return text;
}

}  // namespace

World::World(Scene scene, const WorldConfig& config) : scene_(std::move(scene)) {
  require_sound(scene_);
  hash_ = scene_hash(scene_);
  raycaster_ = std::make_unique<SceneRaycaster>(scene_.mesh);
  const auto light = cached_light(scene_, *raycaster_, std::max(config.threads, 1), config.light_folder);
  renderer_ = std::make_unique<Renderer>(scene_, *raycaster_, light, RendererConfig{config.threads});
  nav_map_ = std::make_unique<NavMap>(build_nav_map(scene_, {}, config.passable_classes));
}

StartPose draw_start(const World& world, double radius_m, std::uint64_t seed) {
  const Random random(seed, RandomStream::kStartPose);
  const auto& starts = world.scene().starts;
  if (starts.empty()) return draw_anywhere(world, radius_m, random);
  const StartPose& start = starts[static_cast<std::size_t>(random.uniform(0) * static_cast<double>(starts.size()))];
  if (world.nav_map().distance_m(start.position) < radius_m) {
    throw std::runtime_error("scene " + world.scene().name + ": start " + place(start) +
                             " is in a wall, or too near to one; move it");
  }
  return start;
}

}  // namespace lapis::simulator
