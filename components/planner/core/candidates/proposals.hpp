#pragma once

#include <optional>
#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Paths to viewpoints of every frontier, or the last resorts when none of these is open (add_last_resorts). Those with
/// the shortest paths and the current goal stay open. Alternative paths and revisits are added at the end.
/// @param with_revisits true when old key-frames may be goals, too
std::vector<Candidate> propose_paths(const ProposalInput& in, bool with_revisits);

/// When no candidate is open, replaces all by closer looks at frontiers; when still none is open, adds views of gaps,
/// and then places at which slam tracked.
void add_last_resorts(const ProposalInput& in, std::vector<Candidate>& candidates);
/// Rejects candidates at whose end the position would be less certain than dead reckoning may make it
/// (Adrift::budget_m).
void reject_unsure_ones(const std::optional<Adrift>& adrift, std::vector<Candidate>& candidates);
/// Keeps the current goal and the candidates with the shortest paths, ProposalConfig::max_candidates in all. The
/// nearest candidate of every frontier comes before the second nearest of any.
void reject_far_ones(const ProposalInput& in, std::vector<Candidate>& candidates);

}  // namespace lapis::planner
