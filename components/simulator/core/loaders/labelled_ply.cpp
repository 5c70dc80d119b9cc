#include "simulator/core/loaders/labelled_ply.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "simulator/core/assets/obj.hpp"
#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/csv_table.hpp"
#include "simulator/core/loaders/ply.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {
namespace {

constexpr std::size_t kLargestClassId = std::numeric_limits<std::uint16_t>::max();
constexpr float kBoxTolerance_m = 1e-3F;

// The model of an instance in instances.csv, and its pose.
struct Placement {
  std::string model;
  Eigen::Affine3f T_world_model = Eigen::Affine3f::Identity();
};

// False for triangles that are a line except for rounding: models are written with few decimals.
bool has_area(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  constexpr double kLeastHeight_m = 1e-4;
  const Eigen::Vector3d ab = (b - a).cast<double>(), ac = (c - a).cast<double>(), bc = ac - ab;
  return ab.cross(ac).norm() > kLeastHeight_m * std::max({ab.norm(), ac.norm(), bc.norm()});
}

// Copies vertices from a PLY file into a mesh, once per colour that the faces of a vertex give it.
class VertexDivider {
 public:
  VertexDivider(const PlyMesh& ply, Mesh& mesh) : ply_(ply), mesh_(mesh), first_(ply.positions.size(), kNone) {}

  std::uint32_t index_of(std::uint32_t vertex, const std::optional<geometry::Rgb8>& color) {
    for (std::uint32_t i = first_[vertex]; i != kNone; i = next_[i]) {
      if (!color || mesh_.colors[i] == *color) return i;
    }
    mesh_.positions.push_back(ply_.positions[vertex]);
    if (color) mesh_.colors.push_back(*color);
    next_.push_back(first_[vertex]);
    return first_[vertex] = static_cast<std::uint32_t>(next_.size() - 1);
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const PlyMesh& ply_;
  Mesh& mesh_;
  std::vector<std::uint32_t> first_;  ///< newest copy in the mesh, per vertex of the file
  std::vector<std::uint32_t> next_;   ///< another copy of the same vertex, per vertex of the mesh
};

class LabelledPlyLoader {
 public:
  LabelledPlyLoader(const AssetStore& store, const std::string& ply_name, const LoadOptions& options)
      : store_(store), options_(options), folder_(std::filesystem::path(ply_name).parent_path().generic_string()),
        file_(full_name(store, ply_name)), bytes_(read_required(store, ply_name)), instances_(file_) {
    if (!folder_.empty()) folder_ += '/';
  }

  Scene load();

 private:
  void read_classes();
  void read_instances();
  void read_placement(const CsvTable& table, const CsvTable::Row& row, std::uint32_t index);
  void sort_triangles(const PlyMesh& ply);
  std::uint32_t instance_of(std::int64_t id, std::int64_t class_id);
  void build_mesh(const PlyMesh& ply);
  bool has_fitting_model(std::uint32_t index, const PlyMesh& ply);
  void add_plain(std::uint32_t index, const PlyMesh& ply, VertexDivider& vertices);
  const Model* model(const std::string& name);
  void warn_about_models();

  const AssetStore& store_;
  const LoadOptions& options_;
  std::string folder_;
  std::string file_;
  std::vector<std::uint8_t> bytes_;
  Scene scene_;
  InstanceList instances_;
  std::map<std::int64_t, std::uint32_t> index_by_id_;                             ///< by id in instances.csv
  std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> index_by_pair_;  ///< by instance id and class id
  std::vector<std::vector<std::size_t>> triangles_;                               ///< per instance, in the PLY file
  std::map<std::uint32_t, Placement> placements_;
  std::map<std::string, std::optional<Model>> models_;
  std::size_t divided_ = 0;
  std::vector<std::string> unfit_models_;
};

Scene LabelledPlyLoader::load() {
  read_classes();
  read_instances();
  const PlyMesh ply = read_ply(bytes_, file_, {"class_id", "instance_id"});
  sort_triangles(ply);
  build_mesh(ply);
  if (divided_ > 0) {
    scene_.warnings.push_back(file_ + ": " + std::to_string(divided_) +
                              " parts of instances have another class than instances.csv says; each became its own");
  }
  warn_about_models();
  scene_.instances = instances_.take();
  finish_scene(scene_, file_);
  return std::move(scene_);
}

void LabelledPlyLoader::read_classes() {
  const std::string name = folder_ + "classes.csv", file = full_name(store_, name);
  const auto bytes = read_required(store_, name);
  const CsvTable table(as_text(bytes), ',', file);
  std::map<std::uint16_t, std::string> names;
  for (const auto& row : table.rows()) {
    const auto id = static_cast<std::uint16_t>(table.index_at(row, "class_id", kLargestClassId));
    if (id != 0 && !names.emplace(id, table.at(row, "class")).second) table.fail(row, "this class_id occurs twice");
  }
  scene_.labels = mapping::LabelList::from_names({names.begin(), names.end()});
}

void LabelledPlyLoader::read_instances() {
  const std::string name = folder_ + "instances.csv", file = full_name(store_, name);
  const auto bytes = read_required(store_, name);
  const CsvTable table(as_text(bytes), ',', file);
  const bool has_models = table.has("model") && table.has("m00");
  for (const auto& row : table.rows()) {
    const std::size_t id = table.index_at(row, "instance_id", kLargestClassId);
    const auto class_id = static_cast<std::uint16_t>(table.index_at(row, "class_id", kLargestClassId));
    if (id == 0 || index_by_id_.count(static_cast<std::int64_t>(id)) > 0) {
      table.fail(row, "instance_id must not be 0 nor occur twice; renumber it here and in the PLY file");
    }
    const std::uint32_t index = instances_.add(static_cast<std::int64_t>(id), class_id, table.at(row, "name"));
    index_by_id_.emplace(static_cast<std::int64_t>(id), index);
    if (has_models) read_placement(table, row, index);
  }
}

void LabelledPlyLoader::read_placement(const CsvTable& table, const CsvTable::Row& row, std::uint32_t index) {
  Placement placement;
  placement.model = table.at(row, "model");
  if (placement.model.empty()) return;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c)
      placement.T_world_model(r, c) = table.float_at(row, "m" + std::to_string(r) + std::to_string(c));
  }
  placements_.emplace(index, std::move(placement));
}

void LabelledPlyLoader::sort_triangles(const PlyMesh& ply) {
  for (std::size_t i = 0; i < ply.triangles.size(); ++i) {
    const std::uint32_t index = instance_of(ply.face_labels[1][i], ply.face_labels[0][i]);
    if (triangles_.size() <= index) triangles_.resize(index + 1);
    triangles_[index].push_back(i);
  }
}

std::uint32_t LabelledPlyLoader::instance_of(std::int64_t id, std::int64_t class_id) {
  const auto [entry, is_new] = index_by_pair_.try_emplace({id, class_id}, 0);
  if (!is_new) return entry->second;
  const bool is_listed = class_id == 0 || (class_id > 0 && class_id <= static_cast<std::int64_t>(kLargestClassId) &&
                                           scene_.labels.contains(static_cast<std::uint16_t>(class_id)));
  if (!is_listed) {
    throw std::runtime_error(file_ + ": there are faces of class " + std::to_string(class_id) +
                             "; add it to classes.csv");
  }
  const auto small = static_cast<std::uint16_t>(class_id);
  if (id == 0) {
    return entry->second =
               small == 0 ? instances_.unlabelled() : instances_.add_with_free_id(small, scene_.labels.name(small));
  }
  const auto known = index_by_id_.find(id);
  if (known == index_by_id_.end()) {
    throw std::runtime_error(file_ + ": there are faces of instance " + std::to_string(id) +
                             "; add it to instances.csv");
  }
  const Instance& instance = instances_[known->second];
  if (instance.class_id == small) return entry->second = known->second;
  ++divided_;
  return entry->second = instances_.add_with_free_id(small, instance.name + " (" + scene_.labels.name(small) + ")");
}

void LabelledPlyLoader::build_mesh(const PlyMesh& ply) {
  std::vector<std::uint32_t> shown_by_model;
  VertexDivider vertices(ply, scene_.mesh);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    if (has_fitting_model(i, ply)) {
      shown_by_model.push_back(i);
    } else if (!triangles_[i].empty()) {
      add_plain(i, ply, vertices);
    }
  }
  for (const std::uint32_t i : shown_by_model) {
    const Placement& placement = placements_.at(i);
    append(scene_.mesh, model(placement.model)->mesh, placement.T_world_model, i);
  }
}

// True when the model is the same surface as the instance in the PLY file. Triangles without area may be missing,
// because the reader of models leaves them out.
bool LabelledPlyLoader::has_fitting_model(std::uint32_t index, const PlyMesh& ply) {
  const auto placement = placements_.find(index);
  if (placement == placements_.end() || triangles_[index].empty()) return false;
  const Model* const found = model(placement->second.model);
  if (!found) return false;
  Eigen::AlignedBox3f box;
  std::size_t visible = 0;
  for (const std::size_t i : triangles_[index]) {
    const auto& [a, b, c] = ply.triangles[i];
    for (const std::uint32_t v : {a, b, c}) box.extend(ply.positions[v]);
    if (has_area(ply.positions[a], ply.positions[b], ply.positions[c])) ++visible;
  }
  Eigen::AlignedBox3f placed;
  for (const auto& p : found->mesh.positions) placed.extend(placement->second.T_world_model * p);
  const std::size_t triangles = found->mesh.triangles.size();
  const bool fits = triangles >= visible && triangles <= triangles_[index].size() &&
                    (placed.min() - box.min()).cwiseAbs().maxCoeff() <= kBoxTolerance_m &&
                    (placed.max() - box.max()).cwiseAbs().maxCoeff() <= kBoxTolerance_m;
  if (!fits) unfit_models_.push_back(placement->second.model);
  return fits;
}

void LabelledPlyLoader::add_plain(std::uint32_t index, const PlyMesh& ply, VertexDivider& vertices) {
  const bool is_colored = !ply.face_colors.empty() || !ply.vertex_colors.empty();
  Material material;
  material.name = instances_[index].name;
  if (!is_colored) material.color = scene_.labels.color(instances_[index].class_id);
  const std::uint32_t material_index = add_material(scene_.mesh, std::move(material), nullptr);
  for (const std::size_t i : triangles_[index]) {
    Triangle triangle{{}, material_index, index};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = ply.triangles[i][k];
      std::optional<geometry::Rgb8> color;
      if (is_colored) color = ply.face_colors.empty() ? ply.vertex_colors[v] : ply.face_colors[i];
      triangle.vertices[k] = vertices.index_of(v, color);
    }
    scene_.mesh.triangles.push_back(triangle);
  }
}

const Model* LabelledPlyLoader::model(const std::string& name) {
  const auto [entry, is_new] = models_.try_emplace(name);
  if (is_new) {
    try {
      entry->second = read_obj(store_, folder_ + "models/" + name + ".obj", options_.max_texture_px);
      for (auto& warning : entry->second->warnings) scene_.warnings.push_back(std::move(warning));
    } catch (const std::runtime_error& error) {
      scene_.warnings.push_back(std::string(error.what()) + "; a plain colour stands in");
    }
  }
  return entry->second ? &*entry->second : nullptr;
}

void LabelledPlyLoader::warn_about_models() {
  if (unfit_models_.empty()) return;
  scene_.warnings.push_back(file_ + ": " + std::to_string(unfit_models_.size()) + " models differ from the surface, '" +
                            unfit_models_.front() + "' for one; a plain colour stands in");
}

}  // namespace

Scene load_labelled_ply(const AssetStore& store, const std::string& ply_name, const LoadOptions& options) {
  return LabelledPlyLoader(store, ply_name, options).load();
}

}  // namespace lapis::simulator
