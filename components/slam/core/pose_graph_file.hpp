#pragma once

#include <iosfwd>
#include <string>
#include <variant>

#include "slam/core/pose_graph.hpp"

namespace lapis::slam {

/// Why a pose-graph file cannot be read, with the line: "line 12: EDGE_SE3:QUAT needs 30 numbers, has 7".
struct PoseGraphFileError {
  std::string message;
};

/// Writes g2o text: VERTEX_SE3:QUAT and EDGE_SE3:QUAT with the upper triangle of the information, row by row.
/// g2o's rotation error is the vector part of the quaternion, half a small rotation vector: the information's rotation
/// block is written times 4 and its cross block times 2. Fixed formatting: the same graph gives the same bytes. Stamps,
/// edge types and the version have no place in the format.
void write_g2o(std::ostream& stream, const PoseGraphSnapshot& graph);

/// Reads what write_g2o writes, ignoring other tags than these two, comments (#) and FIX. Edges become kOdometry.
/// Vertices need not precede the edges; an edge may name a vertex that the file lacks (some files have edges only).
std::variant<PoseGraphSnapshot, PoseGraphFileError> read_g2o(std::istream& stream);

}  // namespace lapis::slam
