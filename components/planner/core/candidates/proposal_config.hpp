#pragma once

#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/space/path_planner.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

struct GapConfig {
  double least_nats = 200.0;  ///< that a view promises, when no frontier is left; 0: no such views
  double spacing_m = 1.0;     ///< between places
};

/// Which paths there are to choose from.
struct ProposalConfig {
  PathConfig path;
  ViewpointConfig viewpoints;
  GapConfig gaps;
  HallucinationConfig hallucination;
  int max_candidates = 20;           ///< that are judged; the ones with the shortest paths
  double view_spacing_m = 0.75;      ///< between views along a path
  double turn_cost_m_per_rad = 0.5;  ///< of turning at the path's ends
  int alternatives = 0;              ///< other paths to the nearest goal of each frontier, at most
  /// When the position's sigma [m] is larger, old key-frames with many landmarks are goals, too, for methods that ask
  /// for the spectrum; 0: never.
  double revisit_sigma_m = 0.0;
  /// When no candidate is left, frontiers of at least this length are looked at from nearby although something seems to
  /// hide them, in [0.1, 1000] [m].
  double closer_look_length_m = 1.0;
  double keep_factor = 1.2;  ///< another goal must be so much better than the one being driven to
};

}  // namespace lapis::planner
