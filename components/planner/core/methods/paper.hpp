#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility D (1 + MI / cost), where D includes all nodes of the path [Zhang, Bong & Beltrame 2024, eq. 24-25]. Without
/// information it is D, the limit for MI = 0.
class Paper : public Method {
 public:
  Asks asks() const override { return {.path_information = true, .spectrum = true}; }
  double utility(const Candidate& candidate) const override {
    return candidate.value.optimality * (1.0 + candidate.value.path_information / candidate.value.paid_m());
  }
  bool keeps_goal() const override { return false; }
};

}  // namespace lapis::planner
