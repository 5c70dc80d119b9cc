#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/robot/nav_map.hpp"
#include "simulator/core/scene/scene.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/truth/voxel_truth.hpp"

namespace lapis::simulator {

/// Writes the ground truth that is known before the run: mesh.lapis, flood.lapis, with_margin.lapis (map frame),
/// classes.json (names of the classes, and the most frequent ones of mesh.lapis), rooms.json (rooms in both frames,
/// T_map_world), navmap.png and navmap.yaml (world frame, for ROS's map_server). The folder is made when its parent
/// exists.
/// @throws std::runtime_error naming the file that cannot be written.
void write_scene_truth(const std::filesystem::path& folder, const Scene& scene, const NavMap& nav_map,
                       const geometry::Pose& T_world_base, const VoxelTruth& truth);

/// Writes ideal.lapis, the ideal map of the frames so far.
/// @throws std::runtime_error naming the file that cannot be written.
void write_ideal_map(const std::filesystem::path& folder, const Scene& scene, const IdealMap& ideal);

/// Writes a map of the whole building, with everything that it depends on (`made_of`) in its provenance.
/// @throws std::runtime_error naming the file that cannot be written.
void write_full_map(const std::filesystem::path& file, const Scene& scene, const IdealMap& full,
                    const std::string& made_of);

/// The bytes of a file that write_full_map wrote with the same `made_of`; nothing for any other file.
std::optional<std::vector<std::uint8_t>> read_full_map(const std::filesystem::path& file, const std::string& made_of);

}  // namespace lapis::simulator
