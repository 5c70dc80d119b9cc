#pragma once

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

struct JointConfig {
  double beta = 1.0;  ///< weight of a nat about the trajectory relative to a nat about the map
};

/// Utility (MI + beta d / 2 G) / cost, in nats per metre: G is the expected change of the log-determinant by loop
/// closures and d the number of degrees of freedom of a pose.
class Joint : public Method {
 public:
  explicit Joint(const JointConfig& config) : config_(config) {}

  Asks asks() const override { return {.path_information = true, .spectrum = true}; }
  double utility(const Candidate& candidate) const override {
    return (candidate.value.path_information + config_.beta * 0.5 * kPoseDimensions * candidate.value.loop_gain) /
           candidate.value.paid_m();
  }

 private:
  static constexpr double kPoseDimensions = 6.0;
  JointConfig config_;
};

}  // namespace lapis::planner
