#pragma once

#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// The pose of the robot at an old key-frame that shares many landmarks with other key-frames.
struct OldPlace {
  Pose2 pose;
  Cell cell;
};

/// The old places that can be reached, the one with the most shared landmarks first. A place within
/// HallucinationConfig::place_radius_m of one earlier in the list is left out. Empty when there is no pose graph.
/// @param config decides which key-frames are old and how many landmarks a loop closure needs
std::vector<OldPlace> old_places(const ProposalInput& in, const HallucinationConfig& config);

inline constexpr double kPass_m = 0.75;  ///< a path continues this far beyond an old place, in its direction

inline constexpr double kLikely = 0.5;  ///< least probability of a loop closure at the old place itself

/// The robot's pose at a key-frame. @param node of the AnalysedGraph
OldPlace place_of(const Situation& s, int node);

/// A cell 0.75 m beyond the place, in the direction in which the robot drove through it, so that the camera sees what
/// the key-frame saw; the place itself when something is in the way.
Cell cell_beyond(const PlanningGrid& grid, const OldPlace& place);

/// The path through the place to the cell beyond it.
Candidate candidate_through(const ProposalInput& in, const OldPlace& place);

/// Candidates that drive through every old place, at its heading, except the one at which the robot stands. Places near
/// Memory::visited_places are rejected. Every method gets the same places: the default HallucinationConfig decides, not
/// the configured one.
std::vector<Candidate> propose_old_places(const ProposalInput& in);

}  // namespace lapis::planner
