#pragma once

#include <map>
#include <optional>
#include <string>

#include "evaluator/core/run/metrics.hpp"
#include "idl/diagnostic_msgs.hpp"

namespace lapis::evaluator {

/// CPU time and memory of the processes of a run, as they publish them on /diagnostics: the newest values count.
class ProcessCosts {
 public:
  /// @param status of a process of Lapis
  void add(const diagnostic_msgs::msg::DiagnosticStatus& status);
  /// Fills in cpu_ms_per_frame and peak_rss_mb; without a value where a process did not publish one.
  void write_to(RunMetrics& metrics) const;

 private:
  struct Costs {
    std::optional<double> cpu_s;
    std::optional<double> peak_rss_mb;
    std::optional<double> frames;
  };
  std::map<std::string, Costs> costs_;  // by name of the process
};

}  // namespace lapis::evaluator
