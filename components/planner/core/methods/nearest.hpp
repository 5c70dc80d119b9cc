#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility 1 / cost.
class Nearest : public Method {
 public:
  Asks asks() const override { return {}; }
  double utility(const Candidate& candidate) const override { return 1.0 / candidate.value.paid_m(); }
};

}  // namespace lapis::planner
