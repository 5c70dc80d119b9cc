#pragma once

#include <string>

namespace lapis::planner {

/// Why a frontier, or a path to a view of it, is not judged. Reasons from attempts come after geometric ones.
enum class Rejection {
  kNone,         ///< it is judged
  kNoRoom,       ///< no place around the frontier has room for the robot
  kUnreachable,  ///< no place with room for the robot can be reached
  kHidden,       ///< occupied cells hide the frontier from every place that can be reached
  kFailedView,   ///< it was viewed, from here or from several places, and is still a frontier
  kFailed,       ///< paths to it have failed so often that it was given up
  kUnsure,       ///< in dead reckoning, the position would be less certain there than the budget allows
  kLeftAlone,    ///< it failed and has to wait, or it waits for observations that are not yet in the map
  kOutranked,    ///< other candidates come before it (ProposalConfig::max_candidates)
  kFarSpace,     ///< in a tour: enough sub-spaces are nearer
  kBesideStop,   ///< in a tour: it stops at other frontiers nearby
};

/// Text for people and for a column of decisions.csv: without commas; empty for kNone.
std::string text_of(Rejection rejection);

/// True when the building explains the rejection and the robot cannot do better: it has viewed the frontier or cannot
/// view it.
bool is_geometric(Rejection rejection);

}  // namespace lapis::planner
