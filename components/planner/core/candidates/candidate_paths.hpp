#pragma once

#include <cstdint>
#include <vector>

#include "planner/core/candidates/candidate.hpp"
#include "planner/core/candidates/proposal_config.hpp"
#include "planner/core/candidates/situation.hpp"
#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

/// The input from which candidates are proposed.
struct ProposalInput {
  const Situation& situation;
  const CostTree& tree;  ///< rooted at the robot's cell
  const Memory& memory;
  const ProposalConfig& config;
};

/// A candidate without a path, for a frontier that the robot must not or cannot drive to.
Candidate rejected(const Frontier& frontier, Rejection reason);
/// The cheapest path to a viewpoint. @param frontier id; 0: the viewpoint does not belong to a frontier
Candidate candidate_at(const ProposalInput& in, std::uint32_t frontier, const Viewpoint& viewpoint);
/// Sets the path to the candidate's goal: corners, poses and cost. The path starts at the robot's position.
void set_path(const ProposalInput& in, const Path& path, Candidate& candidate);
/// True when the robot is driving to the candidate's goal, or to one within 0.5 m of it.
bool is_current_goal(const Candidate& candidate, const Memory& memory);
bool is_any_open(const std::vector<Candidate>& candidates);

}  // namespace lapis::planner
