#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// As Paper, but D compares graphs with an equal number of nodes, so that the number of a path's nodes neither raises
/// nor lowers the utility.
class FixedN : public Method {
 public:
  Asks asks() const override { return {.path_information = true, .spectrum = true}; }
  double utility(const Candidate& candidate) const override {
    return candidate.value.fixed_n_d_optimality * (1.0 + candidate.value.path_information / candidate.value.paid_m());
  }
};

}  // namespace lapis::planner
