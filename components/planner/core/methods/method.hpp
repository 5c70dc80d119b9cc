#pragma once

#include <vector>

#include "planner/core/candidates/proposals.hpp"

namespace lapis::planner {

/// What a utility is made of.
struct Asks {
  bool path_information = false;
  bool goal_information = false;
  bool spectrum = false;  ///< of the pose graph with the path: loop_gain, optimality, fixed_n_d_optimality
  bool unknown_share = false;

  Asks operator|(const Asks& other) const {
    return {path_information || other.path_information, goal_information || other.goal_information,
            spectrum || other.spectrum, unknown_share || other.unknown_share};
  }
  bool operator==(const Asks&) const = default;
};

/// A way to choose where to go: which paths there are to choose from, and what each of them is worth.
class Method {
 public:
  virtual ~Method() = default;

  /// What of a candidate's value its utility needs; the rest may be zero.
  virtual Asks asks() const = 0;
  /// Of a candidate that is open; larger is better.
  virtual double utility(const Candidate& candidate) const = 0;
  /// All candidates with their paths, those that are out of the question with the reason. Who asks for the spectrum
  /// gets old places as goals, too.
  virtual std::vector<Candidate> propose(const ProposalInput& in) const;
  /// It judges nothing but what it has proposed, so it cannot be compared with others.
  virtual bool has_own_candidates() const { return false; }
  /// The goal that is being driven to is kept until another one is better by ProposalConfig::keep_factor.
  virtual bool keeps_goal() const { return true; }
};

}  // namespace lapis::planner
