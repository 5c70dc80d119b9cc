#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// Writes decision.json: floor plan, frontiers and paths at the instant of the decision with the most judged
/// candidates, from which the figure of a decision is drawn (docs/evaluation.md).
class DecisionPlan {
 public:
  static constexpr const char* kFile = "decision.json";

  /// Renames an older file of that name. Throws std::runtime_error when it cannot be renamed.
  explicit DecisionPlan(std::string path);
  /// Replaces the file when more candidates were judged than in all decisions before. Returns why the file cannot be
  /// written; otherwise nothing.
  /// @param surroundings from which the decision was made
  [[nodiscard]] std::optional<std::string> write(const Decision& decision, const Surroundings& surroundings,
                                                 std::uint64_t id);

 private:
  std::string path_;
  std::ptrdiff_t most_judged_ = 0;
};

}  // namespace lapis::planner
