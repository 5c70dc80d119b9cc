#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// decision.json: floor plan, frontiers and paths at the instant of one decision, that with most candidates that were
/// judged; the figure of a decision is drawn from it (docs/evaluation.md).
class DecisionPlan {
 public:
  static constexpr const char* kFile = "decision.json";

  /// An older file of that name is set aside. Throws std::runtime_error when it cannot be renamed.
  explicit DecisionPlan(std::string path);
  /// Replaces the file when more candidates were judged than ever before. Why it cannot be written, if so.
  /// @param surroundings that the decision was made from
  [[nodiscard]] std::optional<std::string> write(const Decision& decision, const Surroundings& surroundings,
                                                 std::uint64_t id);

 private:
  std::string path_;
  std::ptrdiff_t most_judged_ = 0;
};

}  // namespace lapis::planner
