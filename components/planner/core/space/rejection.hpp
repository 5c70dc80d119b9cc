#pragma once

#include <string>

namespace lapis::planner {

/// Why a frontier, or a path to a place from which it is seen, is not judged.
enum class Rejection {
  kNone,         ///< it is
  kNoRoom,       ///< no place around the frontier has room for the robot
  kUnreachable,  ///< none that has can be reached
  kHidden,       ///< from all that can be reached, occupied cells hide the frontier
  kFailedView,   ///< a view from this place has not moved the frontier
  kLeftAlone,    ///< the target has failed, or waits for what was seen to enter the map
  kOutranked,    ///< others come before it (DecisionConfig::max_candidates)
  kFarSpace,     ///< of a tour: enough sub-spaces are nearer
  kBesideStop,   ///< of a tour: it stops at others near it
};

/// For people; empty for kNone.
std::string text_of(Rejection rejection);

/// True when the building is to blame, not what the robot has tried.
bool is_geometric(Rejection rejection);

}  // namespace lapis::planner
