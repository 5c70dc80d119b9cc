#pragma once

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Adds a node at the identity for every id that only edges name, in the order of ids. Returns how many.
std::size_t add_missing_nodes(PoseGraphSnapshot& graph);

/// Files do not distinguish edge types: an edge is a step of the camera when no node has an id between those of its
/// ends (ids have gaps where slam was started again), and a loop closure otherwise.
void mark_loop_closures(PoseGraphSnapshot& graph);

/// Poses by chaining edges from the first node of each connected part, over as few edges as possible (breadth-first);
/// over loop closures only where no other edge leads further.
void initialize_by_spanning_tree(PoseGraphSnapshot& graph);

/// Poses by chordal relaxation: rotations from linear least squares over matrices, each then replaced by the nearest
/// rotation; translations from linear least squares given the rotations (Martinec and Pajdla, CVPR 2007; Carlone et
/// al., ICRA 2015). The first node of each connected part keeps its pose.
void initialize_by_chordal_relaxation(PoseGraphSnapshot& graph);

/// Poses by chordal relaxation, unless the present poses have less chi2.
void initialize_poses(PoseGraphSnapshot& graph);

/// Initial poses for robust optimisation: along the spanning tree, or by chordal relaxation where that has less chi2
/// when no edge counts for more than the gate of robust optimisation.
void initialize_poses_robustly(PoseGraphSnapshot& graph);

}  // namespace lapis::slam
