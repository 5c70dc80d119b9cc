#pragma once

#include <vector>

#include "planner/core/candidates/proposals.hpp"

namespace lapis::planner {

/// The terms that a utility uses.
struct Asks {
  bool path_information = false;
  bool goal_information = false;
  bool spectrum = false;  ///< of the pose graph with the path: loop_gain, optimality, fixed_n_d_optimality
  bool unknown_share = false;
  bool map_worth = false;  ///< surviving_share and secured_nats

  Asks operator|(const Asks& other) const {
    return {path_information || other.path_information, goal_information || other.goal_information,
            spectrum || other.spectrum, unknown_share || other.unknown_share, map_worth || other.map_worth};
  }
  bool operator==(const Asks&) const = default;
};

/// A method decides where to go: it proposes candidate paths and rates each of them.
class Method {
 public:
  virtual ~Method() = default;

  /// The terms of a candidate's value that the utility needs; other terms may be zero.
  virtual Asks asks() const = 0;
  /// Utility of an open candidate; larger is better.
  virtual double utility(const Candidate& candidate) const = 0;
  /// Proposes all candidates with their paths; a candidate that is out of the question has the reason. Methods that ask
  /// for the spectrum get old places as goals, too.
  virtual std::vector<Candidate> propose(const ProposalInput& in) const;
  /// True when the method judges only its own candidates, so that it cannot be compared with others.
  virtual bool has_own_candidates() const { return false; }
  /// True when the current goal is kept until another one is better by ProposalConfig::keep_factor.
  virtual bool keeps_goal() const { return true; }
};

}  // namespace lapis::planner
