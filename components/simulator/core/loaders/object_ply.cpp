#include "simulator/core/loaders/object_ply.hpp"

#include <set>
#include <utility>
#include <vector>

#include "simulator/core/loaders/ply.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {

Scene load_object_ply(std::span<const std::uint8_t> bytes, const std::string& file,
                      const std::map<std::int64_t, ObjectLabel>& objects) {
  PlyMesh ply = read_ply(bytes, file, {"object_id"});
  const std::vector<std::int64_t>& ids = ply.face_labels[0];
  InstanceList instances(file);
  std::map<std::int64_t, std::uint32_t> index_of;
  std::size_t unknown = 0;
  const std::set<std::int64_t> used(ids.begin(), ids.end());
  for (const std::int64_t id : used) {
    const auto object = objects.find(id);
    if (object != objects.end()) index_of[id] = instances.add(id + 1, object->second.class_id, object->second.name);
  }
  for (const std::int64_t id : used) {
    if (!index_of.emplace(id, 0).second) continue;
    index_of[id] = instances.unlabelled();
    if (id >= 0) ++unknown;
  }
  Scene scene;
  scene.is_lit = false;
  scene.mesh.positions = std::move(ply.positions);
  scene.mesh.colors = std::move(ply.vertex_colors);
  Material material;
  if (scene.mesh.colors.empty()) material.color = {160, 160, 160};
  add_material(scene.mesh, std::move(material), nullptr);
  for (std::size_t i = 0; i < ids.size(); ++i)
    scene.mesh.triangles.push_back({ply.triangles[i], 0, index_of.at(ids[i])});
  scene.instances = instances.take();
  if (unknown > 0) {
    scene.warnings.push_back(file + ": " + std::to_string(unknown) +
                             " objects are not in the list of objects; their faces are unlabelled");
  }
  return scene;
}

}  // namespace lapis::simulator
