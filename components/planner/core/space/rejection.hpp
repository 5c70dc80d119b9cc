#pragma once

#include <string>

namespace lapis::planner {

/// Why a frontier, or a path to a place from which it is seen, is not judged. What was tried comes after geometry.
enum class Rejection {
  kNone,         ///< it is
  kNoRoom,       ///< no place around the frontier has room for the robot
  kUnreachable,  ///< none that has can be reached
  kHidden,       ///< from all that can be reached, occupied cells hide the frontier
  kFailedView,   ///< it has been looked at, from here or from several places, and is there still
  kFailed,       ///< paths to it have failed, so often that it was given up
  kUnsure,       ///< by odometry alone, the position would be less sure there than the budget allows
  kLeftAlone,    ///< it has failed, and has to wait, or it waits for what was seen to enter the map
  kOutranked,    ///< others come before it (ProposalConfig::max_candidates)
  kFarSpace,     ///< of a tour: enough sub-spaces are nearer
  kBesideStop,   ///< of a tour: it stops at others near it
};

/// For people and for a column of decisions.csv: no commas; empty for kNone.
std::string text_of(Rejection rejection);

/// True when the building is to blame, not the robot, which had its look or can have none.
bool is_geometric(Rejection rejection);

}  // namespace lapis::planner
