#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility (MI times the share of it that survives in the map + what loops secure of the map so far) / cost, in nats
/// per metre (expected map information).
class Expected : public Method {
 public:
  Asks asks() const override { return {.path_information = true, .map_worth = true}; }
  double utility(const Candidate& candidate) const override {
    const PathValue& value = candidate.value;
    return (value.path_information * value.surviving_share + value.secured_nats) / value.paid_m();
  }
};

}  // namespace lapis::planner
