#pragma once

#include <optional>

#include "planner/core/replay/situation_file.hpp"
#include "planner/decision_worker.hpp"
#include "planner/planner_config.hpp"

namespace lapis::planner {

/// The decision with this configuration, which is completed(). Frontiers have other numbers than when it was recorded;
/// between candidates that are worth the same the choice may be another.
Decision decide_again(const RecordedSituation& situation, const PlannerComponentConfig& config);

/// With a situation to decide again: does so, prints the candidates, and writes replayed.csv, as decisions.csv, into
/// planner.output_dir. Exit status; nothing without one.
std::optional<int> run_replay(const PlannerComponentConfig& config);

}  // namespace lapis::planner
