#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <variant>

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Why a pose-graph file cannot be read, with the line: "line 12: EDGE_SE3:QUAT needs 30 numbers, has 7".
struct PoseGraphFileError {
  std::string message;
};

/// Largest number of vertices, of edges, and of characters in a line; larger files are refused.
inline constexpr std::size_t kMaxGraphFileElements = 1'000'000;
inline constexpr std::size_t kMaxGraphFileLine = 16'384;

/// Writes g2o text: VERTEX_SE3:QUAT and EDGE_SE3:QUAT with the upper triangle of the information, row by row; for a
/// planar graph VERTEX_SE2 and EDGE_SE2. g2o's rotation error in space is the vector part of the quaternion, which is
/// half of a small rotation vector: the rotation block of the information is written times 4, its cross block times 2.
/// The same graph gives the same bytes. The format has no place for stamps, edge types and the version.
void write_g2o(std::ostream& stream, const PoseGraphSnapshot& graph);

/// Reads what write_g2o writes, and TORO's form of it (VERTEX2, EDGE2, VERTEX3, EDGE3: roll, pitch, yaw; another order
/// of a planar edge's information). Other tags, comments (#) and FIX are ignored. Planar poses become poses in space
/// with z = 0, and their information becomes 1 where the plane has none. Edges become kOdometry. Vertices need not
/// precede the edges, and an edge may name a vertex that the file lacks (some files have edges only). Refused are lines
/// that cannot be parsed, a vertex that appears twice, an edge from a vertex to itself, information with a negative
/// eigenvalue, numbers beyond any map (1e9 m, information 1e18), and files that mix planar and spatial poses.
std::variant<PoseGraphSnapshot, PoseGraphFileError> read_g2o(std::istream& stream);

}  // namespace lapis::slam
