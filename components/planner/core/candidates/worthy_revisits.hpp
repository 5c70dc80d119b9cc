#pragma once

#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Drives through old places, at their heading, that would secure most of the map per metre (MapWorth): at most
/// kMostWorthyRevisits, the best first by a loop closure at the place itself. Places of different headings, or of
/// different visits, are different places. Empty without Situation::worth.
std::vector<Candidate> propose_worthy_revisits(const ProposalInput& in);

inline constexpr std::size_t kMostWorthyRevisits = 6;

}  // namespace lapis::planner
