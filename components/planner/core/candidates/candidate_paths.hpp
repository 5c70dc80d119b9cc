#pragma once

#include <cstdint>
#include <vector>

#include "planner/core/candidates/candidate.hpp"
#include "planner/core/candidates/proposal_config.hpp"
#include "planner/core/candidates/situation.hpp"
#include "planner/core/space/path_search.hpp"

namespace lapis::planner {

/// What candidates are proposed from.
struct ProposalInput {
  const Situation& situation;
  const CostTree& tree;  ///< from the robot's cell
  const Memory& memory;
  const ProposalConfig& config;
};

/// A candidate without a path, for a frontier that is not to be driven to.
Candidate rejected(const Frontier& frontier, Rejection reason);
/// The best path to a viewpoint. @param frontier 0: a place
Candidate candidate_at(const ProposalInput& in, std::uint32_t frontier, const Viewpoint& viewpoint);
/// Another path to the candidate's goal.
void set_path(const ProposalInput& in, const Path& path, Candidate& candidate);
/// The candidate is what is being driven to.
bool is_current_goal(const Candidate& candidate, const Memory& memory);
bool is_any_open(const std::vector<Candidate>& candidates);

}  // namespace lapis::planner
