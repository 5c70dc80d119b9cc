#pragma once

#include <vector>

#include "planner/core/candidates/candidate_paths.hpp"

namespace lapis::planner {

/// Where the robot stood when it made an old key-frame that shares many landmarks with others.
struct OldPlace {
  Pose2 pose;
  Cell cell;
};

/// That can be reached; the one with the most such landmarks first, others not beside it. None without a graph.
/// @param config what is old, and how many landmarks a loop closure needs
std::vector<OldPlace> old_places(const ProposalInput& in, const HallucinationConfig& config);

/// A little farther in the direction in which the place was driven through, so that the camera sees what the key-frame
/// saw; the place itself when something stands there.
Cell cell_beyond(const PlanningGrid& grid, const OldPlace& place);

/// Drives through every old place but the one at which the robot stands, at its heading; those near
/// Memory::visited_places are rejected. What is a place is the same for all methods, whatever they hallucinate.
std::vector<Candidate> propose_old_places(const ProposalInput& in);

}  // namespace lapis::planner
