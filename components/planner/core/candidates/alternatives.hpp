#pragma once

#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Other paths to the nearest open goal of each frontier (ProposalConfig::alternatives): around other obstacles, then
/// past an old key-frame with many landmarks; and, if asked for, paths to such key-frames
/// (ProposalConfig::revisit_sigma_m).
void add_alternatives_and_revisits(const ProposalInput& in, bool with_revisits, std::vector<Candidate>& candidates);

}  // namespace lapis::planner
