#include "small_building.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <Eigen/Geometry>

#include "common/mapping/file/label_list_file.hpp"
#include "simulator/core/building/floor_plan.hpp"
#include "simulator/scene_yaml.hpp"

namespace lapis::simulator::test {

namespace fs = std::filesystem;

fs::path source_folder() { return LAPIS_SOURCE_DIR; }

mapping::LabelList indoor_labels() { return mapping::read_label_list(source_folder() / "config/labels/mpcat40.yaml"); }

SceneSpec two_rooms() {
  SceneSpec spec;
  spec.name = "two_rooms";
  spec.file = "two_rooms.yaml";
  spec.labels = indoor_labels();
  RoomSpec left, right;
  left.id = "left";
  left.polygon = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  right.id = "right";
  right.polygon = {{4.12, 0}, {7, 0}, {7, 3}, {4.12, 3}};
  spec.rooms = {left, right};
  spec.openings = {{OpeningKind::kDoor, {4.06, 1.0}, 0.9, 0.0, 2.05},
                   {OpeningKind::kWindow, {2.0, 0.0}, 1.2, 0.9, 2.1},
                   {OpeningKind::kLeaf, {7.0, 1.5}, 0.9, 0.0, 2.05}};
  return spec;
}

SceneFolder::SceneFolder() {
  std::string pattern = (fs::temp_directory_path() / "lapis_scene_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = pattern;
  fs::create_directories(folder_ / "scenes");
  fs::create_directories(folder_ / "labels");
  fs::copy_file(source_folder() / "config/labels/mpcat40.yaml", folder_ / "labels/mpcat40.yaml");
}

SceneFolder::~SceneFolder() { fs::remove_all(folder_); }

fs::path SceneFolder::write(const std::string& text) const {
  fs::path file = folder_ / "scenes/scene.yaml";
  std::ofstream(file) << text;
  return file;
}

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  ADD_FAILURE() << "expected an error";
  return {};
}

double area_of(const Scene& scene, const std::string& class_name,
               const std::function<bool(const Eigen::Vector3f&)>& counts) {
  const std::uint16_t wanted = scene.labels.id_of(class_name).value_or(0);
  double area = 0.0;
  for (const Triangle& triangle : scene.mesh.triangles) {
    if (scene.instances[triangle.part].class_id != wanted) continue;
    const auto &a = scene.mesh.positions[triangle.vertices[0]], &b = scene.mesh.positions[triangle.vertices[1]],
               &c = scene.mesh.positions[triangle.vertices[2]];
    if (counts(a) && counts(b) && counts(c)) area += 0.5 * (b - a).cross(c - a).cast<double>().norm();
  }
  return area;
}

}  // namespace lapis::simulator::test
