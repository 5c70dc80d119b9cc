#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// MI of the goal's view alone, every ray for itself, whatever the path costs [Asgharivaskasi & Atanasov 2023].
class Ssmi : public Method {
 public:
  Asks asks() const override { return {.goal_information = true}; }
  double utility(const Candidate& candidate) const override { return candidate.value.goal_information; }
};

}  // namespace lapis::planner
