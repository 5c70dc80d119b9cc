#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "simulator/core/render/light.hpp"

namespace lapis::simulator {

/// Fingerprint of what a run takes from a scene: geometry, looks, classes, lamps, rooms, starts, tour, floor.
std::uint64_t scene_hash(const Scene& scene);

/// bake_light(), or what it gave before for the same geometry, lamps and cut-out textures with this version of it on
/// the same instruction set: kept in `folder`, a file of a byte per corner each, of which the newest 256 MiB stay. An
/// empty folder name: nothing is kept. A file that is damaged or cannot be written costs time, nothing else.
std::vector<std::uint8_t> cached_light(const Scene& scene, const SceneRaycaster& raycaster, int threads,
                                       const std::filesystem::path& folder);

}  // namespace lapis::simulator
