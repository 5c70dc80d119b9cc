#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "common/time/time.hpp"
#include "planner/core/exploration/path_ledger.hpp"

namespace lapis::planner {

/// decisions.csv: a row for every candidate of every decision (docs/evaluation.md).
class DecisionLog {
 public:
  static constexpr const char* kFile = "decisions.csv";

  /// An older file of that name is set aside. Throws std::runtime_error when it cannot be written.
  /// @param compared_methods, compared_priors what decisions are compared with; a column each
  explicit DecisionLog(const std::string& path, const std::vector<std::string>& compared_methods = {},
                       const std::vector<double>& compared_priors = {});
  /// @param ended the path that this decision ends; its columns stand in the next row, the first of its decision
  /// False when the disk refuses.
  bool write(const Decision& decision, const std::optional<DrivenPath>& ended, std::uint64_t id,
             const std::string& method, time::Time stamp);

 private:
  void write_value(const Candidate& candidate, const Asks& known);
  void write_ended();

  std::ofstream file_;
  std::optional<DrivenPath> ended_;  // not yet written
};

}  // namespace lapis::planner
