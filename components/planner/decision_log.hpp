#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "common/time/time.hpp"
#include "planner/core/exploration/path_ledger.hpp"

namespace lapis::planner {

/// Writes decisions.csv: a row for every candidate of every decision (docs/evaluation.md).
class DecisionLog {
 public:
  static constexpr const char* kFile = "decisions.csv";

  /// Renames an older file of that name. Throws std::runtime_error when the file cannot be written.
  /// @param compared_methods, compared_priors get one column each
  explicit DecisionLog(const std::string& path, const std::vector<std::string>& compared_methods = {},
                       const std::vector<double>& compared_priors = {});
  /// Returns false when the file cannot be written.
  /// @param ended the path that this decision ends; its columns are filled in the next row, which is the first of the
  /// decision
  bool write(const Decision& decision, const std::optional<DrivenPath>& ended, std::uint64_t id,
             const std::string& method, time::Time stamp);

 private:
  void write_value(const Candidate& candidate, const Asks& known);
  void write_ended();

  std::ofstream file_;
  std::optional<DrivenPath> ended_;  // until it is written
};

}  // namespace lapis::planner
