#pragma once

#include <span>
#include <vector>

#include "planner/core/candidates/proposal_config.hpp"
#include "planner/core/candidates/situation.hpp"
#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

/// Views for what no frontier of the floor plan asks for: ceilings, what stands behind or above something, floors that
/// were passed at the edge of an image. Of all places that can be reached, one for each square of GapConfig::spacing_m,
/// and eight headings each, 20 of those that promise GapConfig::least_nats: the first ones by what a coarse image
/// promises for the path to it. The target lies a metre ahead.
/// @param tree from the robot's cell
std::vector<Viewpoint> gap_views(const Situation& situation, const CostTree& tree, const Memory& memory,
                                 const GapConfig& config);

/// The view has been taken, from about the same place in about the same direction.
bool is_taken(const Pose2& view, std::span<const Pose2> taken);

}  // namespace lapis::planner
