#pragma once

#include <cstdint>
#include <vector>

#include "evaluator/core/run/metrics.hpp"

namespace lapis::evaluator {

/// What a planner reports of its decisions so far.
struct DecisionCounts {
  std::uint64_t decisions = 0;
  double last_time_s = 0.0;    ///< wall-clock time of the last decision
  std::uint64_t failures = 0;  ///< goals that were not reached, or that were viewed in vain
};

/// The decisions of a run, from the planner's report after each of them.
class DecisionRecord {
 public:
  /// Counts smaller than before come from a planner that was restarted.
  void add(const DecisionCounts& reported);
  /// Fills in the figures of decisions.
  void write_to(RunMetrics& metrics) const;

 private:
  DecisionCounts last_;
  std::int64_t decisions_ = 0, failures_ = 0;
  std::vector<double> times_s_;
};

}  // namespace lapis::evaluator
