#include "evaluator/core/run/decision_record.hpp"

#include "evaluator/core/statistics.hpp"

namespace lapis::evaluator {

void DecisionRecord::add(const DecisionCounts& reported) {
  if (reported.decisions < last_.decisions || reported.failures < last_.failures) last_ = {};
  if (reported.decisions > last_.decisions) times_s_.push_back(reported.last_time_s);
  decisions_ += static_cast<std::int64_t>(reported.decisions - last_.decisions);
  failures_ += static_cast<std::int64_t>(reported.failures - last_.failures);
  last_ = reported;
}

void DecisionRecord::write_to(RunMetrics& metrics) const {
  if (decisions_ == 0) return;
  metrics.decisions = decisions_;
  metrics.failures = failures_;
  metrics.decision_time_p50_s = quantile(times_s_, 0.5);
  metrics.decision_time_p95_s = quantile(times_s_, 0.95);
}

}  // namespace lapis::evaluator
