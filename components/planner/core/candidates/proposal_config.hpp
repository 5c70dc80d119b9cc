#pragma once

#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/space/path_planner.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct GapConfig {
  double least_nats = 200.0;  ///< least information of a view when no frontier is left; 0: such views are not proposed
  double spacing_m = 1.0;     ///< edge of the squares that get one place each
};

/// Decides which paths are proposed.
struct ProposalConfig {
  PathConfig path;
  ViewpointConfig viewpoints;
  GapConfig gaps;
  HallucinationConfig hallucination;
  int max_candidates = 20;           ///< the most that are judged: those with the shortest paths
  double view_spacing_m = 0.75;      ///< between views along a path
  double turn_cost_m_per_rad = 0.5;  ///< of turning at the ends of the path
  int alternatives = 0;              ///< largest number of other paths to the nearest goal of each frontier
  /// When the position's standard deviation [m] is larger, old key-frames with many landmarks are goals, too, for
  /// methods that ask for the spectrum; 0: never.
  double revisit_sigma_m = 0.0;
  /// When no candidate is left, the robot drives up to frontiers of at least this length although something seems to
  /// hide them; in [0.1, 1000] [m].
  double closer_look_length_m = 1.0;
  double keep_factor = 1.2;  ///< another goal replaces the current one when its utility is larger by this factor
};

}  // namespace lapis::planner
