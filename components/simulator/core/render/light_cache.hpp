#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "simulator/core/render/light.hpp"

namespace lapis::simulator {

/// Hash of what a run takes from a scene: geometry, appearance, classes, lamps, rooms, starts, tour, floor.
std::uint64_t scene_hash(const Scene& scene);

/// Result of bake_light(). It is taken from `folder` when this version has baked it before, for the same geometry,
/// lamps and cut-out textures, with the same instruction set; otherwise it is baked and kept there. A file has a byte
/// per corner; the newest 256 MiB of files stay. With an empty folder name nothing is kept. A file that is damaged or
/// cannot be written costs only time.
std::vector<std::uint8_t> cached_light(const Scene& scene, const SceneRaycaster& raycaster, int threads,
                                       const std::filesystem::path& folder);

}  // namespace lapis::simulator
