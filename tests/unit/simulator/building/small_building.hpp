#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "simulator/core/scene/scene.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator::test {

/// The repository.
std::filesystem::path source_folder();

/// config/labels/mpcat40.yaml
mapping::LabelList indoor_labels();

/// Two rooms side by side, "left" (0..4 x 0..3) and "right" (4.12..7 x 0..3), with a door between them, a window in
/// the south of the left one, and a closed door in the east of the right one. No furniture.
SceneSpec two_rooms();

/// A file in a folder of its own that goes away at the end; the folder also has labels/mpcat40.yaml where scene files
/// in scenes/ look for it.
class SceneFolder {
 public:
  SceneFolder();
  ~SceneFolder();
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;
  std::filesystem::path write(const std::string& text) const;

 private:
  std::filesystem::path folder_;
};

/// What a call throws; a test failure when it throws nothing.
std::string error_of(const std::function<void()>& call);

/// Summed area of the triangles of a class for which `counts`(corner) holds in all three corners.
double area_of(const Scene& scene, const std::string& class_name,
               const std::function<bool(const Eigen::Vector3f&)>& counts);

}  // namespace lapis::simulator::test
