#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"

namespace lapis::planner {

/// decisions.csv: a row for every candidate of every decision (docs/evaluation.md).
class DecisionLog {
 public:
  /// An older file of that name is set aside. Throws std::runtime_error when it cannot be written.
  /// @param compared_priors of the fields that decisions are compared with; a column each
  explicit DecisionLog(const std::string& path, const std::vector<double>& compared_priors = {});
  /// False when the disk refuses.
  bool write(const Decision& decision, std::uint64_t id, const std::string& method, time::Time stamp);

 private:
  std::ofstream file_;
};

}  // namespace lapis::planner
