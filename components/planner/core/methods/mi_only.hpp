#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility MI / cost.
class MiOnly : public Method {
 public:
  Asks asks() const override { return {.path_information = true}; }
  double utility(const Candidate& candidate) const override {
    return candidate.value.path_information / candidate.value.paid_m();
  }
};

}  // namespace lapis::planner
