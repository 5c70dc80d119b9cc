#include "simulator/core/truth/truth_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "simulator/core/robot/nav_map_picture.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::ordered_json;

constexpr const char* kMadeOf = "made_of";

void save(const std::filesystem::path& file, const Scene& scene, const mapping::VoxelMap& map,
          const std::string& source, const std::optional<mapping::FrameSettings>& frames = std::nullopt,
          const std::string& made_of = "") {
  mapping::SensorModel model;
  model.class_count = std::max<int>(scene.labels.max_id(), 1);
  mapping::MapFile content{map, model, scene.labels, {{"scene", scene.name}, {"source", source}}, frames};
  if (!made_of.empty()) content.provenance[kMadeOf] = made_of;
  if (const auto problem = mapping::save_map(file.string(), content)) throw std::runtime_error(*problem);
}

std::string classes_json(const Scene& scene, const mapping::VoxelMap& mesh) {
  ordered_json document = {{"scene", scene.name}, {"top_classes", most_frequent_classes(mesh)}};
  document["classes"] = ordered_json::array();
  for (const auto& label : scene.labels.labels()) {
    document["classes"].push_back({{"id", label.id}, {"name", label.name}});
  }
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

ordered_json corners(const Room& room, const geometry::Pose& T) {
  ordered_json out = ordered_json::array();
  for (const auto& corner : room.polygon) {
    const Eigen::Vector3d p = T * Eigen::Vector3d(corner.x(), corner.y(), 0.0);
    out.push_back({p.x(), p.y()});
  }
  return out;
}

std::string rooms_json(const Scene& scene, const geometry::Pose& T) {
  const Eigen::Vector3d t = T.translation();
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  ordered_json document = {{"scene", scene.name},
                           {"floor_z_m", scene.floor_z_m},
                           {"T_map_world", {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}}};
  document["rooms"] = ordered_json::array();
  for (const auto& room : scene.rooms) {
    document["rooms"].push_back({{"id", room.id},
                                 {"type", room.type},
                                 {"height_m", room.height_m},
                                 {"polygon_map", corners(room, T)},
                                 {"polygon_world", corners(room, geometry::Pose::Identity())}});
  }
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string nav_map_yaml(const Grid& grid) {
  char text[256];
  std::snprintf(text, sizeof text,
                "image: navmap.png\nmode: trinary\nresolution: %.6g\norigin: [%.6f, %.6f, 0.0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.25\n",
                grid.resolution_m, grid.origin.x(), grid.origin.y());
  return text;
}

}  // namespace

void write_scene_truth(const std::filesystem::path& folder, const Scene& scene, const NavMap& nav_map,
                       const geometry::Pose& T_world_base, const VoxelTruth& truth) {
  files::require_writable_folder(folder.string(), "ground truth");
  save(folder / "flood.lapis", scene, truth.flood, "mesh, what can be flooded");
  save(folder / "with_margin.lapis", scene, truth.with_margin, "mesh, what can be seen with a planner's margin");
  files::replace_text(folder / "classes.json", classes_json(scene, truth.mesh));
  files::replace_text(folder / "rooms.json", rooms_json(scene, T_map_world(T_world_base)));
  files::replace_text(folder / "navmap.yaml", nav_map_yaml(nav_map.grid()));
  const auto picture = encode_png(draw_nav_map(nav_map, {}));
  if (const auto problem = files::replace_file((folder / "navmap.png").string(), picture)) {
    throw std::runtime_error(*problem);
  }
  // This file is written last: to readers its presence means that the others are there.
  save(folder / "mesh.lapis", scene, truth.mesh, "mesh, what can be seen");
}

void write_ideal_map(const std::filesystem::path& folder, const Scene& scene, const IdealMap& ideal) {
  save(folder / "ideal.lapis", scene, ideal.map(), "frames without noise at true poses", ideal.frame_settings());
}

void write_full_map(const std::filesystem::path& file, const Scene& scene, const IdealMap& full,
                    const std::string& made_of) {
  save(file, scene, full.map(), "frames without noise from all over the building", full.frame_settings(), made_of);
}

std::optional<std::vector<std::uint8_t>> read_full_map(const std::filesystem::path& file, const std::string& made_of) {
  std::string problem;
  auto bytes = files::read_file(file.string(), problem);
  const auto map = bytes ? mapping::decode_map(*bytes, problem) : std::nullopt;
  if (!map) return std::nullopt;
  const auto note = map->provenance.find(kMadeOf);
  return note != map->provenance.end() && note->second == made_of ? bytes : std::nullopt;
}

}  // namespace lapis::simulator
