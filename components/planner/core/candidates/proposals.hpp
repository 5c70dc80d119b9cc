#pragma once

#include <optional>
#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Paths to viewpoints of every frontier, or to what is left when there is none (add_last_resorts), of which the ones
/// with the shortest paths stay open, and what is being driven to; then alternatives.
/// @param with_revisits old key-frames may be goals, too
std::vector<Candidate> propose_paths(const ProposalInput& in, bool with_revisits);

/// When no candidate is open: closer looks at frontiers, which replace them; views of gaps; places at which slam
/// tracked.
void add_last_resorts(const ProposalInput& in, std::vector<Candidate>& candidates);
/// Rejects what leads farther than the robot may drift by odometry alone.
void reject_unsure_ones(const std::optional<Adrift>& adrift, std::vector<Candidate>& candidates);
/// Keeps what is being driven to and those with the shortest paths, but of every frontier the nearest one before the
/// second of any.
void reject_far_ones(const ProposalInput& in, std::vector<Candidate>& candidates);

}  // namespace lapis::planner
