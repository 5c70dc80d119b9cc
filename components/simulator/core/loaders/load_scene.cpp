#include "simulator/core/loaders/load_scene.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/hm3d.hpp"
#include "simulator/core/loaders/labelled_ply.hpp"
#include "simulator/core/loaders/matterport.hpp"
#include "simulator/core/loaders/replica.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"
#include "simulator/core/loaders/semantics_json.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;

// In the order of precedence.
enum class Layout { kMatterport, kHm3d, kReplica, kModel, kLabelledPly };

/// A scene in the folder. `id` is the beginning of its files' names, its sub-folder with '/', or the name of its file.
struct Candidate {
  Layout layout;
  std::string id;
  bool operator==(const Candidate&) const = default;
};

using Names = std::vector<std::string>;  // of the files in the folder, sorted

bool contains(const Names& names, const std::string& name) {
  return std::binary_search(names.begin(), names.end(), name);
}

std::optional<std::string> without_ending(const std::string& name, std::string_view ending) {
  if (name.size() <= ending.size() || !std::string_view(name).ends_with(ending)) return std::nullopt;
  return name.substr(0, name.size() - ending.size());
}

Names list_files(const fs::path& folder) {
  Names names;
  std::error_code error;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator(); it.increment(error)) {
    std::error_code unreadable;
    if (it->is_regular_file(unreadable)) names.push_back(it->path().filename().string());
  }
  if (error) throw std::runtime_error(folder.string() + ": cannot be listed: " + error.message());
  std::sort(names.begin(), names.end());
  return names;
}

// The scene to which a file belongs.
std::optional<Candidate> scene_of(const std::string& file, const Names& names) {
  for (const char* ending : {".house", "_semantic.ply", ".glb"}) {
    const auto id = without_ending(file, ending);
    if (id && contains(names, *id + ".house")) return Candidate{Layout::kMatterport, *id};
  }
  for (const char* ending : {".semantic.glb", ".semantic.txt", ".basis.glb", ".glb"}) {
    const auto id = without_ending(file, ending);
    if (id && (contains(names, *id + ".semantic.glb") || contains(names, *id + ".semantic.txt")))
      return Candidate{Layout::kHm3d, *id};
  }
  if (file == "mesh_semantic.ply" || file == "info_semantic.json") return Candidate{Layout::kReplica, ""};
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".ply") return Candidate{Layout::kLabelledPly, file};
  if (extension == ".obj" || extension == ".gltf" || extension == ".glb") return Candidate{Layout::kModel, file};
  return std::nullopt;
}

Candidate only_scene(const fs::path& folder, const Names& names) {
  std::vector<Candidate> found;
  std::error_code error;
  if (fs::exists(folder / "habitat" / "mesh_semantic.ply", error)) found.push_back({Layout::kReplica, "habitat/"});
  for (const auto& name : names) {
    const auto scene = scene_of(name, names);
    if (scene && std::find(found.begin(), found.end(), *scene) == found.end()) found.push_back(*scene);
  }
  // A labelled PLY file may have models beside it, and other scenes may have stray PLY files.
  const auto usual = std::find(found.begin(), found.end(), Candidate{Layout::kLabelledPly, "scene_labelled.ply"});
  if (usual != found.end()) return *usual;
  if (found.empty()) {
    throw std::runtime_error(folder.string() +
                             ": there is no scene in it: neither .ply, .obj, .gltf, .glb nor .house; check the folder");
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.layout < b.layout; });
  if (found.size() > 1 && found[1].layout == found[0].layout) {
    throw std::runtime_error(folder.string() + ": there are several scenes in it, '" + found[0].id + "' and '" +
                             found[1].id + "' for example; name the file");
  }
  return found[0];
}

// Often one table serves all scenes; it is then one or two folders further up.
std::optional<std::map<std::string, std::string>> find_mapping(const fs::path& folder) {
  const std::string name = "hm3dsem_category_mappings.tsv";
  const fs::path above = folder.parent_path();
  for (const fs::path& place : {folder, above, above.parent_path()}) {
    const FolderStore store(place);
    if (const auto text = store.read(name)) return parse_hm3d_mapping(as_text(*text), full_name(store, name));
  }
  return std::nullopt;
}

Scene load(const fs::path& folder, const Candidate& scene, const LoadOptions& options) {
  const FolderStore store(folder);
  switch (scene.layout) {
    case Layout::kMatterport: return load_matterport(store, scene.id, options);
    case Layout::kHm3d: return load_hm3d(store, scene.id, find_mapping(folder), options);
    case Layout::kReplica: return load_replica(store, scene.id);
    case Layout::kLabelledPly: return load_labelled_ply(store, scene.id, options);
    case Layout::kModel: return load_model_scene(store, scene.id, options);
  }
  return {};
}

std::string scene_name(const fs::path& folder, const Candidate& scene) {
  if (scene.layout == Layout::kMatterport || scene.layout == Layout::kHm3d) return scene.id;
  if (scene.layout == Layout::kModel) return fs::path(scene.id).stem().string();
  const bool is_inner = folder.filename() == "habitat";
  return (is_inner ? folder.parent_path() : folder).filename().string();
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const LoadOptions& options) {
  std::error_code error;
  const fs::path full = fs::canonical(path, error);
  if (error) throw std::runtime_error(path.string() + ": there is no such file or folder; check the path");
  const bool is_folder = fs::is_directory(full, error);
  const fs::path folder = is_folder ? full : full.parent_path();
  const Names names = list_files(folder);
  const auto scene = is_folder ? only_scene(folder, names) : scene_of(full.filename().string(), names);
  if (!scene) {
    throw std::runtime_error(full.string() +
                             ": is no kind of scene that can be read; name a .ply, .obj, .gltf, .glb or .house file");
  }
  Scene result = load(folder, *scene, options);
  result.name = scene_name(folder, *scene);
  return result;
}

}  // namespace lapis::simulator
