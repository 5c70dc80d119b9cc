#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// Texture coordinate at barycentric weights (u, v) of the second and third vertex; zero without coordinates.
Eigen::Vector2f texture_coordinate(const Mesh& mesh, const Triangle& triangle, float u, float v);

/// Nearest texel of a texture that repeats; (0, 0) is its lower left corner.
Rgba8 nearest_texel(const TextureImage& texture, const Eigen::Vector2f& coordinate);

/// True when the point of a triangle lies in a hole of its cut-out texture.
bool is_hole(const Mesh& mesh, std::uint32_t triangle, float u, float v);

}  // namespace lapis::simulator
