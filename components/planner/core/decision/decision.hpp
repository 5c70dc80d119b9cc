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
  std::shared_ptr<const Method> method;  ///< to be set
  /// What each of these would choose among the same candidates is reported, too.
  std::vector<std::shared_ptr<const Method>> compared_methods;
  GraphConfig graph;
  double node_spacing_m = 1.0;      ///< between hallucinated key-frames
  double sigma_limit_voxels = 0.5;  ///< of the position at a path's end: what is more exact is of no use; in (0, 10]
  /// The information of a view from a position with sigma s counts 1 / (1 + (s / this)^2) [m]; 0: all of it.
  double information_discount_sigma_m = 0.0;
};

/// Frontiers that are not going to be looked at.
struct Leftover {
  /// By why; a frontier counts once, for the last of its paths' reasons in the order of the enumeration.
  std::map<Rejection, double> length_m;
  /// Of this length, what geometry does not excuse: frontiers through which the robot would fit, tried in vain.
  double share_to_blame = 0.0;

  /// "frontiers left: 2.5 m: cannot be reached, 1.0 m: left alone for now"; empty when nothing is left.
  std::string text() const;
};

/// A view along the chosen path.
struct PromisedView {
  Pose2 robot;
  double nats = 0.0;  ///< promised by the views up to this one, the one at the beginning included
};

struct Decision {
  std::vector<Candidate> candidates;   ///< at least one for each frontier
  std::optional<std::size_t> chosen;   ///< index; nothing when none can be driven to
  std::string explanation;             ///< of the choice, see explain(); empty when there is none
  std::vector<PromisedView> promised;  ///< along the chosen path, from where the robot is
  std::vector<double> first_turn_rad;  ///< headings to turn through before the chosen path; empty: the short way
  Leftover leftover;                   ///< when none can
  Asks known;                          ///< what the candidates were judged by, and no more
  /// What each of the compared methods would have chosen.
  std::vector<std::optional<std::size_t>> by_compared_methods;
  /// What would have been chosen with each of the compared fields.
  std::vector<std::optional<std::size_t>> by_compared_fields;
  std::string problem;  ///< of the pose graph, when loops could not be judged; empty otherwise
};

/// Chooses where to go: candidates in front of every frontier, their paths, what the map and the pose graph would gain
/// by them, and the best by the method's utility. Deterministic; ties go to the smaller frontier id.
Decision decide(const Situation& situation, const Memory& memory, const DecisionConfig& config);

}  // namespace lapis::planner
