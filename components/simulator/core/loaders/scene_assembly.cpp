#include "simulator/core/loaders/scene_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

namespace lapis::simulator {
namespace {

constexpr float kFarthest_m = 1e5F;
constexpr std::uint32_t kLargestNamedId = std::numeric_limits<std::uint16_t>::max();

bool is_sound(const Eigen::Vector3f& p) { return (p.array().abs() <= kFarthest_m).all(); }  // false for NaN

std::size_t drop_unsound_triangles(Mesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle& triangle) {
    return !std::all_of(triangle.vertices.begin(), triangle.vertices.end(),
                        [&](std::uint32_t v) { return is_sound(mesh.positions[v]); });
  });
  return before - mesh.triangles.size();
}

// Moves unsound vertices, which no triangle uses any more, to a vertex that is used, so that bounds() is right.
void move_unsound_vertices(Mesh& mesh) {
  const Eigen::Vector3f used = mesh.positions[mesh.triangles.front().vertices[0]];
  for (auto& p : mesh.positions) {
    if (!is_sound(p)) p = used;
  }
}

// Some exported files have unsound coordinates: a picture that is wrong there is better than none.
void clear_unsound_texture_coordinates(Mesh& mesh) {
  constexpr float kLargest = 1e4F;
  for (auto& uv : mesh.texture_coordinates) {
    if (!(uv.cwiseAbs().maxCoeff() <= kLargest) || !uv.allFinite()) uv.setZero();
  }
}

// Lowest height at which there is a fifth of the level floor, by its area per 5 cm of height. Closed slabs have a lower
// side, too: when some normals point up, only their triangles count. Nothing when nothing of class "floor" is level.
std::optional<double> find_floor(const Scene& scene) {
  constexpr double kBin_m = 0.05;
  const auto floor = scene.labels.id_of("floor");
  if (!floor) return std::nullopt;
  std::map<long, double> upward, any;
  double upward_area = 0, any_area = 0;
  for (const auto& triangle : scene.mesh.triangles) {
    if (scene.instances[triangle.part].class_id != *floor) continue;
    const auto& p = scene.mesh.positions;
    const Eigen::Vector3d a = p[triangle.vertices[0]].cast<double>(), b = p[triangle.vertices[1]].cast<double>(),
                          c = p[triangle.vertices[2]].cast<double>();
    const Eigen::Vector3d normal = (b - a).cross(c - a) / 2;
    if (std::abs(normal.z()) < 0.9 * normal.norm()) continue;
    const long bin = std::lround((a.z() + b.z() + c.z()) / 3 / kBin_m);
    any[bin] += std::abs(normal.z());
    any_area += std::abs(normal.z());
    if (normal.z() > 0) upward[bin] += normal.z(), upward_area += normal.z();
  }
  const bool has_upward = upward_area > any_area / 10;
  for (const auto& [bin, area] : has_upward ? upward : any) {
    if (area >= 0.2 * (has_upward ? upward_area : any_area)) return static_cast<double>(bin) * kBin_m;
  }
  return std::nullopt;
}

}  // namespace

std::string full_name(const AssetStore& store, const std::string& name) { return store.description() + "/" + name; }

std::vector<std::uint8_t> read_required(const AssetStore& store, const std::string& name) {
  auto bytes = store.read(name);
  if (!bytes) throw std::runtime_error(full_name(store, name) + ": no readable file of that name; put it there");
  if (bytes->empty()) {
    throw std::runtime_error(full_name(store, name) + ": the file is empty (0 bytes); copy or download it again");
  }
  return std::move(*bytes);
}

mapping::LabelList number_classes(const std::set<std::string>& names) {
  std::vector<std::pair<std::uint16_t, std::string>> numbered;
  for (const auto& name : names) {
    if (numbered.size() < kLargestNamedId) numbered.emplace_back(static_cast<std::uint16_t>(numbered.size() + 1), name);
  }
  return mapping::LabelList::from_names(numbered);
}

ClassNames::ClassNames(const mapping::LabelList& wanted, const std::set<std::string>& names) : labels_(wanted) {
  if (labels_.size() > 0) return;
  std::set<std::string> classes = names;
  for (const char* none : {"", "void", "unlabeled", "unlabelled"}) classes.erase(none);
  labels_ = number_classes(classes);
}

std::uint16_t ClassNames::id_of(const std::string& name) {
  if (name.empty() || name == "void" || name == "unlabeled" || name == "unlabelled") return 0;
  const auto id = labels_.id_of(name);
  if (!id) unknown_.insert(name);
  return id.value_or(0);
}

std::optional<std::string> ClassNames::warning() const {
  if (unknown_.empty()) return std::nullopt;
  return std::to_string(unknown_.size()) + " classes are not in the label list, '" + *unknown_.begin() +
         "' for one; what belongs to them is unlabelled";
}

std::uint32_t InstanceList::add(std::int64_t id, std::uint16_t class_id, std::string name) {
  if (id < 1 || id > kLargestNamedId) {
    throw std::runtime_error(file_ + ": instance " + std::to_string(id) + " is not between 1 and 65535; renumber it");
  }
  const auto small = static_cast<std::uint16_t>(id);
  if (!ids_.insert(small).second) {
    throw std::runtime_error(file_ + ": there are two instances " + std::to_string(id) + "; renumber one");
  }
  instances_.push_back({small, class_id, std::move(name)});
  return static_cast<std::uint32_t>(instances_.size() - 1);
}

std::uint32_t InstanceList::add_with_free_id(std::uint16_t class_id, std::string name) {
  while (lowest_free_ <= kLargestNamedId && ids_.count(static_cast<std::uint16_t>(lowest_free_)) > 0) ++lowest_free_;
  if (lowest_free_ > kLargestNamedId) {
    throw std::runtime_error(file_ + ": there are more than 65535 instances; split the scene");
  }
  return add(lowest_free_, class_id, std::move(name));
}

std::uint32_t InstanceList::unlabelled() {
  if (!unlabelled_) unlabelled_ = add_with_free_id(0, "unlabelled");
  return *unlabelled_;
}

void turn_upright(Mesh& mesh) {
  for (auto& p : mesh.positions) p = Eigen::Vector3f(p.x(), -p.z(), p.y());
}

void finish_scene(Scene& scene, const std::string& file) {
  if (scene.mesh.triangles.empty()) throw std::runtime_error(file + ": there are no triangles; export the scene again");
  const std::size_t dropped = drop_unsound_triangles(scene.mesh);
  if (scene.mesh.triangles.empty()) {
    throw std::runtime_error(file + ": no triangle has finite coordinates; export the scene again");
  }
  if (dropped > 0) {
    scene.warnings.push_back(file + ": " + std::to_string(dropped) +
                             " triangles are left out: their vertices are not finite or more than 100 km away");
  }
  move_unsound_vertices(scene.mesh);
  clear_unsound_texture_coordinates(scene.mesh);
  const auto floor_z_m = find_floor(scene);
  scene.floor_z_m = floor_z_m ? *floor_z_m : static_cast<double>(bounds(scene.mesh).min().z());
  if (!floor_z_m) {
    scene.warnings.push_back(file + ": nothing level has the class 'floor'; the lowest point is taken for the floor");
  }
}

}  // namespace lapis::simulator
