#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Rgba8&) const = default;
};
using TextureImage = geometry::Image<Rgba8>;

/// Appearance of a surface. The colour multiplies texture and vertex colour; all are sRGB.
struct Material {
  std::string name;
  geometry::Rgb8 color{255, 255, 255};
  int texture = -1;          ///< index in Mesh::textures; -1: none
  bool is_cut_out = false;   ///< texels with alpha below 128 are holes, for colour and depth alike
  bool is_emissive = false;  ///< its colour is shown without light (window panes, lamps)
};

struct Triangle {
  std::array<std::uint32_t, 3> vertices{};
  std::uint32_t material = 0;  ///< index in Mesh::materials
  std::uint32_t part = 0;      ///< in a model: index of its group or node; in a scene: index in Scene::instances
};

/// Triangles with their appearance. Both sides of a triangle are visible.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;            ///< [m]
  std::vector<Eigen::Vector2f> texture_coordinates;  ///< empty, or one per position; (0, 0) is the lower left texel
  std::vector<geometry::Rgb8> colors;                ///< empty, or one per position
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<std::shared_ptr<const TextureImage>> textures;  ///< immutable, shared between copies of a model
};

/// Appends `source`, transformed by `T`, to `target`; all its triangles get the part `part`. Textures that `target`
/// already has are not added again.
void append(Mesh& target, const Mesh& source, const Eigen::Affine3f& T, std::uint32_t part);

/// Appends a material with the texture and returns its index; a texture that `mesh` already has is not added again.
std::uint32_t add_material(Mesh& mesh, Material material, std::shared_ptr<const TextureImage> texture);

/// Box around all positions; empty when there are none.
Eigen::AlignedBox3f bounds(const Mesh& mesh);

/// Scales and moves a mesh so that its bounds are width x depth x height in the item frame (x and y centred, z from 0).
/// An extent that is zero up to rounding stays as it is.
void fit_to_box(Mesh& mesh, const Eigen::Vector3d& size_m);

/// A mesh may have as many textures: a renderer keeps their indices in 16 bits.
inline constexpr std::size_t kMostTextures = 32767;

/// The reason why a mesh cannot be used: an index out of range, a coordinate that is not finite, arrays of different
/// lengths, too many textures. Empty when the mesh is sound.
std::string problem_of(const Mesh& mesh);

}  // namespace lapis::simulator
