#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

/// The surface in a PLY file. Polygons are split into triangle fans, which inherit the face's colour and labels.
struct PlyMesh {
  std::vector<Eigen::Vector3f> positions;               ///< coordinates may be not finite
  std::vector<geometry::Rgb8> vertex_colors;            ///< empty, or one per position
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `positions`, checked
  std::vector<geometry::Rgb8> face_colors;              ///< empty, or one per triangle
  std::vector<std::vector<std::int64_t>> face_labels;   ///< [label][triangle], in the order of the requested names
};

/// Reads PLY 1.0 (G. Turk, "The PLY Polygon File Format", 1994): ascii, binary_little_endian, binary_big_endian. It
/// keeps x, y, z and red, green, blue (uchar) of the vertices, and of the faces the indices (vertex_indices or
/// vertex_index), red, green, blue (uchar), and the integers named in `face_labels`; it skips the rest. It allocates no
/// memory for elements that the file is too short to hold.
/// @param file name that messages show
/// @throws std::runtime_error with one line, for a header that makes no sense, a property that is missing or a list
///   where a number should be, a file that ends too early, and indices that are out of range.
PlyMesh read_ply(std::span<const std::uint8_t> bytes, const std::string& file,
                 const std::vector<std::string>& face_labels);

}  // namespace lapis::simulator
