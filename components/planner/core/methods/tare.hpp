#pragma once

#include "planner/core/methods/method.hpp"
#include "planner/core/tare/tare.hpp"

namespace lapis::planner {

/// Chooses the first stop of the tour that TARE would drive (plan_tour).
class Tare : public Method {
 public:
  explicit Tare(const TareConfig& config) : config_(config) {}

  Asks asks() const override { return {}; }
  double utility(const Candidate& candidate) const override {
    return candidate.value.tour_place > 0 ? 1.0 / candidate.value.tour_place : 0.0;
  }
  bool has_own_candidates() const override { return true; }
  std::vector<Candidate> propose(const ProposalInput& in) const override;

 private:
  TareConfig config_;
};

}  // namespace lapis::planner
