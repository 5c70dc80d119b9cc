#pragma once

#include <cstdint>
#include <vector>

#include "evaluator/core/run/metrics.hpp"

namespace lapis::evaluator {

/// What a planner says of its decisions so far.
struct DecisionCounts {
  std::uint64_t decisions = 0;
  double last_time_s = 0.0;    ///< wall time that the last one took
  std::uint64_t failures = 0;  ///< goals that were not reached, or looked at in vain
};

/// The decisions of a run, from what the planner reports after each of them.
class DecisionRecord {
 public:
  /// Counts that are smaller than before are those of a planner that was restarted.
  void add(const DecisionCounts& reported);
  /// Fills in what RunMetrics has of decisions.
  void write_to(RunMetrics& metrics) const;

 private:
  DecisionCounts last_;
  std::int64_t decisions_ = 0, failures_ = 0;
  std::vector<double> times_s_;
};

}  // namespace lapis::evaluator
