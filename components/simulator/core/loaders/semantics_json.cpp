#include "simulator/core/loaders/semantics_json.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/obj.hpp"
#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/gltf.hpp"
#include "simulator/core/loaders/json_file.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;

constexpr std::size_t kLargestListedId = 65535;

std::optional<std::string> optional_text(const json& object, const std::string& key, const std::string& file) {
  if (member(object, key).is_null()) return std::nullopt;
  return text_member(object, key, file);
}

Semantics::Entry parse_entry(const json& source, std::size_t index, const std::string& file) {
  const std::string place = file + ": instances[" + std::to_string(index) + "]";
  Semantics::Entry entry;
  const std::size_t id = index_member(source, "id", place, 0);
  if (id < 1 || id > kLargestListedId) throw std::runtime_error(place + ": 'id' must be between 1 and 65535");
  entry.id = static_cast<std::int64_t>(id);
  entry.class_name = text_member(source, "class", place);
  entry.node = optional_text(source, "node", place);
  if (!entry.node) entry.node = optional_text(source, "group", place);
  entry.material = optional_text(source, "material", place);
  if (!entry.node && !entry.material) {
    throw std::runtime_error(place + ": there must be a 'node', a 'group' or a 'material'; name one");
  }
  entry.name = text_member(source, "name", place, entry.node ? *entry.node : *entry.material);
  return entry;
}

mapping::LabelList parse_labels(const json& source, const std::string& file) {
  std::vector<std::pair<std::uint16_t, std::string>> names;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const std::string place = file + ": labels[" + std::to_string(i) + "]";
    const std::size_t id = source[i].is_string() ? i + 1 : index_member(source[i], "id", place, 0);
    std::string name = source[i].is_string() ? source[i].get<std::string>() : text_member(source[i], "name", place);
    if (id < 1 || id > kLargestListedId || name.empty()) {
      throw std::runtime_error(place + ": must be a name, or an id between 1 and 65535 and a name");
    }
    names.emplace_back(static_cast<std::uint16_t>(id), std::move(name));
  }
  try {
    return mapping::LabelList::from_names(names);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

// A model, and per group its parent node and its class; in an OBJ file, groups have neither.
struct SourceModel {
  Model model;
  std::vector<int> parents;
  std::vector<std::string> classes;
};

SourceModel read_model(const AssetStore& store, const std::string& name, int max_texture_px) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension == ".obj") {
    Model model = read_obj(store, name, max_texture_px);
    const std::size_t groups = model.groups.size();
    return {std::move(model), std::vector<int>(groups, -1), std::vector<std::string>(groups)};
  }
  GltfModel scene = read_gltf(store, name);
  finish_looks(scene, max_texture_px);
  return {std::move(scene.model), std::move(scene.parents), std::move(scene.classes)};
}

// Gives every triangle its instance.
class Labeller {
 public:
  Labeller(const SourceModel& source, const Semantics& semantics, const LoadOptions& options, const std::string& file);

  /// Replaces Triangle::part in `scene.mesh`, which is still the group, by the instance; sets the instances and labels,
  /// and adds warnings.
  void label(Scene& scene);

 private:
  void add_entries();
  std::uint32_t instance_of(std::uint32_t group, std::uint32_t material);
  bool fits(const Semantics::Entry& entry, std::uint32_t group, std::uint32_t material) const;
  std::uint16_t class_id(const std::string& name, const std::string& user) const;

  const SourceModel& source_;
  const Semantics& semantics_;
  const std::string& file_;
  mapping::LabelList labels_;
  InstanceList instances_;
  std::vector<std::uint32_t> entry_index_;             ///< index of each entry among the instances
  std::vector<bool> is_used_;                          ///< per entry: some triangle belongs to it
  std::map<std::uint32_t, std::uint32_t> node_index_;  ///< index of nodes with extras.class among the instances
};

Labeller::Labeller(const SourceModel& source, const Semantics& semantics, const LoadOptions& options,
                   const std::string& file)
    : source_(source), semantics_(semantics), file_(file),
      labels_(semantics.labels.size() > 0 ? semantics.labels : options.labels), instances_(file) {
  if (labels_.size() > 0) return;
  std::set<std::string> names(source.classes.begin(), source.classes.end());
  for (const auto& entry : semantics.instances) names.insert(entry.class_name);
  labels_ = ClassNames({}, names).labels();
}

void Labeller::label(Scene& scene) {
  add_entries();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;  // by group and material
  for (auto& triangle : scene.mesh.triangles) {
    const auto [entry, is_new] = known.try_emplace({triangle.part, triangle.material}, 0);
    if (is_new) entry->second = instance_of(triangle.part, triangle.material);
    triangle.part = entry->second;
  }
  for (std::size_t i = 0; i < is_used_.size(); ++i) {
    if (is_used_[i]) continue;
    scene.warnings.push_back(file_ + ": nothing belongs to instance " + std::to_string(semantics_.instances[i].id) +
                             " ('" + semantics_.instances[i].name + "'); check the names in semantics.json");
  }
  scene.instances = instances_.take();
  scene.labels = labels_;
}

void Labeller::add_entries() {
  for (const auto& entry : semantics_.instances) {
    const std::uint16_t id = class_id(entry.class_name, "instance " + std::to_string(entry.id));
    entry_index_.push_back(instances_.add(entry.id, id, entry.name));
  }
  is_used_.resize(entry_index_.size(), false);
}

std::uint32_t Labeller::instance_of(std::uint32_t group, std::uint32_t material) {
  for (std::size_t i = 0; i < entry_index_.size(); ++i) {
    if (!fits(semantics_.instances[i], group, material)) continue;
    is_used_[i] = true;
    return entry_index_[i];
  }
  for (int node = static_cast<int>(group); node >= 0; node = source_.parents[static_cast<std::size_t>(node)]) {
    const auto index = static_cast<std::uint32_t>(node);
    if (source_.classes[index].empty()) continue;
    const auto [known, is_new] = node_index_.try_emplace(index, 0);
    const std::string& name = source_.model.groups[index];
    if (is_new) {
      known->second = instances_.add_with_free_id(class_id(source_.classes[index], "node '" + name + "'"), name);
    }
    return known->second;
  }
  return instances_.unlabelled();
}

bool Labeller::fits(const Semantics::Entry& entry, std::uint32_t group, std::uint32_t material) const {
  if (entry.material && source_.model.mesh.materials[material].name != *entry.material) return false;
  if (!entry.node) return true;
  for (int node = static_cast<int>(group); node >= 0; node = source_.parents[static_cast<std::size_t>(node)]) {
    if (source_.model.groups[static_cast<std::size_t>(node)] == *entry.node) return true;
  }
  return false;
}

std::uint16_t Labeller::class_id(const std::string& name, const std::string& user) const {
  if (name.empty()) return 0;
  const auto id = labels_.id_of(name);
  if (!id) {
    throw std::runtime_error(file_ + ": " + user + " has the unknown class '" + name +
                             "'; name it in 'labels' of semantics.json or in the label list");
  }
  return *id;
}

}  // namespace

Semantics parse_semantics(std::string_view text, const std::string& file) {
  const json root = parse_json_object(text, file);
  Semantics result;
  const json& instances = array_member(root, "instances", file);
  for (std::size_t i = 0; i < instances.size(); ++i) result.instances.push_back(parse_entry(instances[i], i, file));
  result.labels = parse_labels(array_member(root, "labels", file), file);
  const auto up = optional_text(root, "up", file);
  if (up && *up != "y" && *up != "z") throw std::runtime_error(file + ": 'up' must be 'y' or 'z'");
  if (up == "z") result.up = UpAxis::kZ;
  return result;
}

Scene load_model_scene(const AssetStore& store, const std::string& name, const LoadOptions& options) {
  const std::string file = full_name(store, name);
  const std::string semantics_name = (std::filesystem::path(name).parent_path() / "semantics.json").generic_string();
  Semantics semantics;
  const auto text = store.read(semantics_name);
  if (text) semantics = parse_semantics(as_text(*text), full_name(store, semantics_name));
  SourceModel source = read_model(store, name, options.max_texture_px);
  Scene scene;
  scene.mesh = std::move(source.model.mesh);
  source.model.mesh.materials = scene.mesh.materials;
  scene.warnings = source.model.warnings;
  const bool has_labels = text || std::any_of(source.classes.begin(), source.classes.end(),
                                              [](const std::string& c) { return !c.empty(); });
  if (!has_labels) {
    scene.warnings.push_back(file +
                             ": nothing is labelled; put a semantics.json beside it, or extras.class into nodes");
  }
  Labeller(source, semantics, options, file).label(scene);
  if (semantics.up == UpAxis::kY) turn_upright(scene.mesh);
  finish_scene(scene, file);
  return scene;
}

}  // namespace lapis::simulator
