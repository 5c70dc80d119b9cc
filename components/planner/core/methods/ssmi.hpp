#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility MI of the goal's view alone, where every ray counts by itself, whatever the cost of the path [Asgharivaskasi
/// & Atanasov 2023].
class Ssmi : public Method {
 public:
  Asks asks() const override { return {.goal_information = true}; }
  double utility(const Candidate& candidate) const override { return candidate.value.goal_information; }
};

}  // namespace lapis::planner
