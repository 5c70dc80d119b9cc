#include "simulator/core/scene/mesh.hpp"

#include <algorithm>

namespace lapis::simulator {
namespace {

int texture_index(Mesh& mesh, const std::shared_ptr<const TextureImage>& texture) {
  const auto it = std::find(mesh.textures.begin(), mesh.textures.end(), texture);
  if (it != mesh.textures.end()) return static_cast<int>(it - mesh.textures.begin());
  mesh.textures.push_back(texture);
  return static_cast<int>(mesh.textures.size()) - 1;
}

template <class Value>
void append_per_vertex(std::vector<Value>& target, std::size_t target_size, const std::vector<Value>& source,
                       std::size_t source_size, const Value& fill) {
  if (target.empty() && source.empty()) return;
  target.resize(target_size, fill);
  target.insert(target.end(), source.begin(), source.end());
  target.resize(target_size + source_size, fill);
}

}  // namespace

std::uint32_t add_material(Mesh& mesh, Material material, std::shared_ptr<const TextureImage> texture) {
  material.texture = texture ? texture_index(mesh, texture) : -1;
  mesh.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(mesh.materials.size() - 1);
}

void append(Mesh& target, const Mesh& source, const Eigen::Affine3f& T, std::uint32_t part) {
  const std::size_t before = target.positions.size(), added = source.positions.size();
  append_per_vertex<Eigen::Vector2f>(target.texture_coordinates, before, source.texture_coordinates, added,
                                     Eigen::Vector2f::Zero());
  append_per_vertex<geometry::Rgb8>(target.colors, before, source.colors, added, {255, 255, 255});
  for (const auto& p : source.positions) target.positions.emplace_back(T * p);
  std::vector<std::uint32_t> material_of;
  for (const auto& material : source.materials) {
    const auto texture = material.texture < 0 ? nullptr : source.textures[static_cast<std::size_t>(material.texture)];
    material_of.push_back(add_material(target, material, texture));
  }
  const auto offset = static_cast<std::uint32_t>(before);
  for (const auto& triangle : source.triangles) {
    const auto& v = triangle.vertices;
    target.triangles.push_back({{v[0] + offset, v[1] + offset, v[2] + offset}, material_of[triangle.material], part});
  }
}

Eigen::AlignedBox3f bounds(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& p : mesh.positions) box.extend(p);
  return box;
}

void fit_to_box(Mesh& mesh, const Eigen::Vector3d& size_m) {
  if (mesh.positions.empty()) return;
  const Eigen::AlignedBox3f box = bounds(mesh);
  const Eigen::Vector3f foot(box.center().x(), box.center().y(), box.min().z()), extent = box.sizes();
  Eigen::Vector3f scale = Eigen::Vector3f::Ones();
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_flat = extent[axis] <= 1e-5F * extent.maxCoeff();
    if (!is_flat) scale[axis] = static_cast<float>(size_m[axis]) / extent[axis];
  }
  for (auto& p : mesh.positions) p = (p - foot).cwiseProduct(scale);
}

std::string problem_of(const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  if (!mesh.texture_coordinates.empty() && mesh.texture_coordinates.size() != vertices)
    return "the number of texture coordinates differs from that of vertices";
  if (!mesh.colors.empty() && mesh.colors.size() != vertices)
    return "the number of vertex colours differs from that of vertices";
  for (std::size_t i = 0; i < vertices; ++i) {
    if (!mesh.positions[i].allFinite()) return "vertex " + std::to_string(i) + " is not finite";
  }
  for (std::size_t i = 0; i < mesh.texture_coordinates.size(); ++i) {
    if (!mesh.texture_coordinates[i].allFinite())
      return "texture coordinate of vertex " + std::to_string(i) + " is not finite";
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& triangle = mesh.triangles[i];
    const auto too_large = [&](std::uint32_t v) { return v >= vertices; };
    if (std::any_of(triangle.vertices.begin(), triangle.vertices.end(), too_large))
      return "triangle " + std::to_string(i) + " names a vertex that does not exist";
    if (triangle.material >= mesh.materials.size())
      return "triangle " + std::to_string(i) + " names a material that does not exist";
  }
  if (mesh.textures.size() > kMostTextures) return "more than " + std::to_string(kMostTextures) + " textures";
  for (const auto& material : mesh.materials) {
    if (material.texture >= static_cast<int>(mesh.textures.size()))
      return "material " + material.name + " names a texture that does not exist";
  }
  return {};
}

}  // namespace lapis::simulator
