#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/core/hallucination/analysed_graph.hpp"
#include "planner/core/methods/method.hpp"

namespace lapis::planner {

struct DecisionConfig : ProposalConfig {
  std::shared_ptr<const Method> method;  ///< has to be set
  /// Decisions report what each of these methods would have chosen among the same candidates.
  std::vector<std::shared_ptr<const Method>> compared_methods;
  GraphConfig graph;
  double node_spacing_m = 1.0;  ///< distance between hallucinated key-frames
  /// Standard deviation of the position at a path's end, in voxels, below which loop closures add nothing; in (0, 10].
  double sigma_limit_voxels = 0.5;
  /// Information from a position with standard deviation s counts 1 / (1 + (s / this)^2) [m]; 0: no discount.
  double information_discount_sigma_m = 0.0;
};

/// The frontiers that remain when nothing is chosen.
struct Leftover {
  /// Length by reason. A frontier counts once: of its paths' reasons, the last in the enumeration counts.
  std::map<Rejection, double> length_m;
  /// Share of the total length that geometry does not excuse: frontiers wide enough for the robot that it tried in
  /// vain.
  double share_to_blame = 0.0;

  /// For example "frontiers left: 2.5 m: cannot be reached, 1.0 m: left alone for now"; empty when none is left.
  std::string text() const;
};

/// A view along the chosen path.
struct PromisedView {
  Pose2 robot;
  double nats = 0.0;  ///< information of all views up to this one, including the first
};

struct Decision {
  std::vector<Candidate> candidates;   ///< at least one for each frontier
  std::optional<std::size_t> chosen;   ///< index of the candidate; empty when none can be driven to
  std::string explanation;             ///< of the choice, see explain(); empty when nothing is chosen
  std::vector<PromisedView> promised;  ///< views along the chosen path, from the robot's pose on
  std::vector<double> first_turn_rad;  ///< headings to turn through before the path; empty: turn the shorter way
  Leftover leftover;                   ///< set when nothing is chosen
  Asks known;                          ///< the terms by which the candidates were judged; other terms are zero
  /// Index that each of the compared methods would have chosen.
  std::vector<std::optional<std::size_t>> by_compared_methods;
  /// Index that would have been chosen with each of the compared fields.
  std::vector<std::optional<std::size_t>> by_compared_fields;
  std::string problem;  ///< why the pose graph could not be judged; empty when it could
};

/// Chooses the next goal: proposes candidates in front of every frontier with their paths, computes what the map and
/// the pose graph would gain by them, and takes the one with the largest utility of the method. Deterministic: of equal
/// utilities, the candidate that was proposed first wins.
Decision decide(const Situation& situation, const Memory& memory, const DecisionConfig& config);

}  // namespace lapis::planner
