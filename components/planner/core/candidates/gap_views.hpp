#pragma once

#include <span>
#include <vector>

#include "planner/core/candidates/proposal_config.hpp"
#include "planner/core/candidates/situation.hpp"
#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

/// Views of unobserved voxels that no frontier of the floor plan shows: ceilings, the space behind or above objects,
/// and floors at the edge of the images that the robot took when it passed. The views are one reachable place in each
/// square of edge GapConfig::spacing_m, with eight headings each. They are ranked by the information of a coarse image
/// per cost of the path; of the best 200, the first 20 that promise at least GapConfig::least_nats are returned. The
/// target lies 1 m ahead.
/// @param tree rooted at the robot's cell
std::vector<Viewpoint> gap_views(const Situation& situation, const CostTree& tree, const Memory& memory,
                                 const GapConfig& config);

/// True when a view from about the same place in about the same direction is among `taken`.
bool is_taken(const Pose2& view, std::span<const Pose2> taken);

}  // namespace lapis::planner
