#pragma once

#include <optional>

#include "planner/core/replay/situation_file.hpp"
#include "planner/decision_worker.hpp"
#include "planner/planner_config.hpp"

namespace lapis::planner {

/// Makes a recorded decision again with this configuration, which has to be completed(). Frontiers have other ids than
/// in the recorded run; of candidates with equal utility, another one may be chosen.
Decision decide_again(const RecordedSituation& situation, const PlannerComponentConfig& config);

/// If --replay names a situation file: makes its decision again, prints the candidates, and writes them to
/// replayed.csv, in the format of decisions.csv, in planner.output_dir. Returns the exit status, or nothing without
/// such a file.
std::optional<int> run_replay(const PlannerComponentConfig& config);

}  // namespace lapis::planner
