#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility D, as in Paper.
class DoptOnly : public Method {
 public:
  Asks asks() const override { return {.spectrum = true}; }
  double utility(const Candidate& candidate) const override { return candidate.value.optimality; }
};

}  // namespace lapis::planner
