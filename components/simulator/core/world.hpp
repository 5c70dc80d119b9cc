#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/render/renderer.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/robot/robot.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

struct WorldConfig {
  int threads = 1;                              ///< for rendering, and for baking light
  std::filesystem::path light_folder;           ///< where baked light is kept; empty: nowhere
  std::vector<std::uint16_t> passable_classes;  ///< of instances that the robot drives through, such as closed doors
};

/// A scene with the structures that rendering and driving need. It is immutable, and all functions may be called from
/// several threads.
class World {
 public:
  /// @throws std::runtime_error when its mesh is empty or broken (naming the scene), or has no floor at floor_z_m.
  World(Scene scene, const WorldConfig& config);

  const Scene& scene() const { return scene_; }
  const SceneRaycaster& raycaster() const { return *raycaster_; }
  const Renderer& renderer() const { return *renderer_; }
  const NavMap& nav_map() const { return *nav_map_; }
  std::uint64_t hash() const { return hash_; }

 private:
  Scene scene_;
  std::uint64_t hash_ = 0;
  std::unique_ptr<SceneRaycaster> raycaster_;
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<NavMap> nav_map_;
};

/// Pose where the robot begins: the seed chooses among the scene's starts or, when the scene names none, among all
/// places with room around them.
/// @throws std::runtime_error naming the scene when a disc of `radius_m` does not fit at the chosen start, or fits
///   nowhere.
StartPose draw_start(const World& world, double radius_m, std::uint64_t seed);

}  // namespace lapis::simulator
