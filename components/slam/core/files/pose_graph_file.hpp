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

/// Most vertices and most edges of a file, and characters of a line; what is larger is refused.
inline constexpr std::size_t kMaxGraphFileElements = 1'000'000;
inline constexpr std::size_t kMaxGraphFileLine = 16'384;

/// Writes g2o text: VERTEX_SE3:QUAT and EDGE_SE3:QUAT with the upper triangle of the information, row by row; of a
/// planar graph VERTEX_SE2 and EDGE_SE2. g2o's rotation error in space is the vector part of the quaternion, half a
/// small rotation vector: the information's rotation block is written times 4 and its cross block times 2. Fixed
/// formatting: the same graph gives the same bytes. Stamps, edge types and the version have no place in the format.
void write_g2o(std::ostream& stream, const PoseGraphSnapshot& graph);

/// Reads what write_g2o writes and the same in TORO's form (VERTEX2, EDGE2, VERTEX3, EDGE3: roll, pitch, yaw; other
/// order of a planar edge's information), ignoring other tags, comments (#) and FIX. Poses in the plane become poses in
/// space with z = 0, their information 1 where the plane has none. Edges become kOdometry. Vertices need not precede
/// the edges; an edge may name a vertex that the file lacks (some files have edges only). Refused are, besides what
/// cannot be parsed, information with a negative eigenvalue, numbers beyond any map (1e9 m, information 1e18), and
/// files with poses both in the plane and in space.
std::variant<PoseGraphSnapshot, PoseGraphFileError> read_g2o(std::istream& stream);

}  // namespace lapis::slam
