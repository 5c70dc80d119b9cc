#pragma once

#include "planner/core/candidates/proposals.hpp"
#include "planner/core/candidates/worthy_revisits.hpp"
#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// Utility (MI times the share of it that survives in the map + what loops secure of the map so far) / cost, in nats
/// per metre: expected map information. It needs Situation::worth; without it, it is that of `mi_only`. Not in the list
/// of methods: lapis_planner_trials compares it with others first (docs/decisions/0053).
class Expected : public Method {
 public:
  Asks asks() const override { return {.path_information = true, .map_worth = true}; }
  /// Old places are goals while there is anything to explore.
  std::vector<Candidate> propose(const ProposalInput& in) const override {
    std::vector<Candidate> candidates = propose_paths(in, false);
    if (!is_any_open(candidates)) return candidates;
    const std::vector<Candidate> revisits = propose_worthy_revisits(in);
    candidates.insert(candidates.end(), revisits.begin(), revisits.end());
    return candidates;
  }
  double utility(const Candidate& candidate) const override {
    const PathValue& value = candidate.value;
    return (value.path_information * value.surviving_share + value.secured_nats) / value.paid_m();
  }
};

/// The same utility when nothing is left to explore.
class ExpectedAmongOldPlaces : public Expected {
 public:
  std::vector<Candidate> propose(const ProposalInput& in) const override { return propose_worthy_revisits(in); }
  bool has_own_candidates() const override { return true; }
};

}  // namespace lapis::planner
