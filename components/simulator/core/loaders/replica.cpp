#include "simulator/core/loaders/replica.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/json_file.hpp"
#include "simulator/core/loaders/object_ply.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;

constexpr std::size_t kLargestReplicaId = std::numeric_limits<std::uint16_t>::max();

std::map<std::uint16_t, std::string> read_classes(const json& root, const std::string& file) {
  std::map<std::uint16_t, std::string> names;
  for (const auto& item : array_member(root, "classes", file)) {
    const std::size_t id = index_member(item, "id", file, 0);
    if (id == 0) continue;
    if (id > kLargestReplicaId ||
        !names.emplace(static_cast<std::uint16_t>(id), text_member(item, "name", file)).second) {
      throw std::runtime_error(file + ": class " + std::to_string(id) +
                               " occurs twice or is above 65535; download the file again");
    }
  }
  return names;
}

// Reads class and name of the objects. Classes that are negative or not listed mean "none".
std::map<std::int64_t, ObjectLabel> read_objects(const json& root, const std::map<std::uint16_t, std::string>& classes,
                                                 const std::string& file) {
  std::map<std::int64_t, ObjectLabel> objects;
  for (const auto& item : array_member(root, "objects", file)) {
    const std::size_t id = index_member(item, "id", file, kLargestReplicaId + 1);
    if (id > kLargestReplicaId)
      throw std::runtime_error(file + ": an object has no id up to 65535; download the file again");
    const json& class_id = member(item, "class_id");
    const bool is_index = class_id.is_number_unsigned() && class_id.get<std::size_t>() <= kLargestReplicaId;
    const auto known = classes.find(is_index ? class_id.get<std::uint16_t>() : std::uint16_t{0});
    ObjectLabel label{0, "object " + std::to_string(id)};
    if (known != classes.end()) label = {known->first, known->second + " " + std::to_string(id)};
    objects.emplace(static_cast<std::int64_t>(id), std::move(label));
  }
  return objects;
}

}  // namespace

Scene load_replica(const AssetStore& store, const std::string& folder) {
  const std::string info_name = folder + "info_semantic.json", ply_name = folder + "mesh_semantic.ply";
  const std::string info_file = full_name(store, info_name), file = full_name(store, ply_name);
  const auto text = read_required(store, info_name);
  const json root = parse_json_object(as_text(text), info_file);
  const auto classes = read_classes(root, info_file);
  const auto objects = read_objects(root, classes, info_file);
  Scene scene = load_object_ply(read_required(store, ply_name), file, objects);
  scene.labels = mapping::LabelList::from_names({classes.begin(), classes.end()});
  finish_scene(scene, file);
  return scene;
}

}  // namespace lapis::simulator
