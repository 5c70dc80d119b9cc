#pragma once

#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam {

/// Adds a node for every id that only edges name, in the order of ids, with the identity for a pose. Returns how many.
std::size_t add_missing_nodes(PoseGraphSnapshot& graph);

/// Edges between ids that do not follow one another become loop closures: files do not distinguish edge types.
void mark_loop_closures(PoseGraphSnapshot& graph);

/// Poses by chaining edges from the first node of each connected part, over as few as possible (breadth-first); over
/// loop closures only where no other edge leads on.
void initialize_by_spanning_tree(PoseGraphSnapshot& graph);

/// Poses by chordal relaxation: rotations from linear least squares over matrices, each then replaced by the nearest
/// rotation; translations from linear least squares given the rotations (Martinec and Pajdla, CVPR 2007; Carlone et
/// al., ICRA 2015). The first node of each connected part keeps its pose.
void initialize_by_chordal_relaxation(PoseGraphSnapshot& graph);

/// Poses by chordal relaxation, unless those that are there have less chi2.
void initialize_poses(PoseGraphSnapshot& graph);

/// A start for robust optimisation: along the spanning tree, or by chordal relaxation where its chi2 is less when no
/// edge counts for more than the gate of robust optimisation.
void initialize_poses_robustly(PoseGraphSnapshot& graph);

}  // namespace lapis::slam
