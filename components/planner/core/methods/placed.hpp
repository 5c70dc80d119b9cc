#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility D (1 + share of unknown cells around the frontier): as Paper, but the map counts only at the goal and the
/// cost of the path does not. It follows the version with which Zhang et al. 2024 compare [Placed, Rodriguez, Tardos &
/// Castellanos, "ExplORB-SLAM", 2022].
class Placed : public Method {
 public:
  Asks asks() const override { return {.spectrum = true, .unknown_share = true}; }
  double utility(const Candidate& candidate) const override {
    return candidate.value.optimality * (1.0 + candidate.value.unknown_share);
  }
  bool keeps_goal() const override { return false; }
};

}  // namespace lapis::planner
