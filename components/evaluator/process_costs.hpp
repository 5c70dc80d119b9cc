#pragma once

#include <map>
#include <optional>
#include <string>

#include "evaluator/core/run/metrics.hpp"
#include "idl/diagnostic_msgs.hpp"

namespace lapis::evaluator {

/// CPU time and memory of the processes of a run, as published on /diagnostics; the newest values count.
class ProcessCosts {
 public:
  /// @param status status of a process of Lapis
  void add(const diagnostic_msgs::msg::DiagnosticStatus& status);
  /// Fills in cpu_ms_per_frame and peak_rss_mb, without a value for a process that did not publish one.
  void write_to(RunMetrics& metrics) const;

 private:
  struct Costs {
    std::optional<double> cpu_s;
    std::optional<double> peak_rss_mb;
    std::optional<double> frames;
  };
  std::map<std::string, Costs> costs_;  // keys are names of processes
};

}  // namespace lapis::evaluator
