#pragma once

#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Adds other paths to the nearest open goal of each frontier (ProposalConfig::alternatives): around other obstacles,
/// and then through an old key-frame with many landmarks. With `with_revisits`, paths to such key-frames are added,
/// too, when the position is uncertain enough (ProposalConfig::revisit_sigma_m).
void add_alternatives_and_revisits(const ProposalInput& in, bool with_revisits, std::vector<Candidate>& candidates);

}  // namespace lapis::planner
