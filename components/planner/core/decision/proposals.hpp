#pragma once

#include <vector>

#include "planner/core/decision/decision.hpp"
#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

/// All candidates of a decision with their paths, those that are out of the question with the reason. Without options:
/// viewpoints of every frontier, of which the ones with the shortest paths stay open; for kTare the stops of its tour.
/// What is being driven to stays open, too.
/// @param tree from the robot's cell
std::vector<Candidate> propose(const Situation& situation, const CostTree& tree, const Memory& memory,
                               const DecisionConfig& config);

/// The candidate is what is being driven to.
bool is_current_goal(const Candidate& candidate, const Memory& memory);

}  // namespace lapis::planner
