#include "simulator/core/render/texel.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::simulator {
namespace {

constexpr std::uint8_t kHoleAlpha = 128;

/// Index in [0, size) of a coordinate that repeats with period 1.
int repeated(float coordinate, int size) {
  const float fraction = coordinate - std::floor(coordinate);
  return std::min(static_cast<int>(fraction * static_cast<float>(size)), size - 1);
}

}  // namespace

Eigen::Vector2f texture_coordinate(const Mesh& mesh, const Triangle& triangle, float u, float v) {
  if (mesh.texture_coordinates.empty()) return Eigen::Vector2f::Zero();
  const auto& [a, b, c] = triangle.vertices;
  const auto& t = mesh.texture_coordinates;
  return (1.0F - u - v) * t[a] + u * t[b] + v * t[c];
}

Rgba8 nearest_texel(const TextureImage& texture, const Eigen::Vector2f& coordinate) {
  return texture(repeated(coordinate.x(), texture.width), repeated(1.0F - coordinate.y(), texture.height));
}

bool is_hole(const Mesh& mesh, std::uint32_t triangle, float u, float v) {
  const Triangle& t = mesh.triangles[triangle];
  const Material& material = mesh.materials[t.material];
  if (!material.is_cut_out || material.texture < 0) return false;
  const auto& texture = *mesh.textures[static_cast<std::size_t>(material.texture)];
  return nearest_texel(texture, texture_coordinate(mesh, t, u, v)).a < kHoleAlpha;
}

}  // namespace lapis::simulator
