#pragma once

#include <optional>
#include <string>
#include <variant>

#include "common/time/time.hpp"

namespace lapis::planner {

enum class State {
  kIdle,           ///< nobody has asked for anything
  kExploring,      ///< drives to frontiers
  kPaused,         ///< stands still until it is started again
  kRecovering,     ///< slam has no pose: looks around
  kReturning,      ///< drives to where it started
  kDone,           ///< nothing is left that can be reached, or it has returned
  kGaveUp,         ///< the same, but frontiers are left that geometry does not excuse; the reason says which
  kFailed,         ///< needs help; the reason says why
  kConsolidating,  ///< nothing is left to explore: drives through old places, so that loops are closed
};

struct Idle {};

struct Paused {};

struct Exploring {
  bool looks_at_gaps = false;               ///< of the map: no frontier is left to try
  bool looks_again = false;                 ///< at what waits for a correction of the map, too: nothing else is left
  bool goes_back = false;                   ///< to where slam tracked, or else what waits never comes into the map
  int empty_decisions = 0;                  ///< in a row, each answered by a look around
  std::optional<time::Time> nothing_since;  ///< no candidate was open
};

/// How it ended.
struct Ended {
  State how = State::kDone;  ///< kDone, kGaveUp or kFailed
  std::string why;           ///< of an exploration that came to its end; else empty
};

struct Returning {
  Ended then;  ///< when it has arrived
};

struct Consolidating {
  Ended exploration;         ///< how that ended
  bool has_visited = false;  ///< an old place since all of them were to be visited
  bool rests = false;        ///< there is none to drive to
};

struct Recovering {
  std::variant<Exploring, Returning, Consolidating> interrupted;
  time::Time lost_at;  ///< when slam lost its pose
};

/// What the mission does, with what only that needs to know.
using MissionState = std::variant<Idle, Exploring, Paused, Recovering, Returning, Consolidating, Ended>;

inline State state_of(const MissionState& mission) {
  struct Names {
    State operator()(const Idle&) const { return State::kIdle; }
    State operator()(const Exploring&) const { return State::kExploring; }
    State operator()(const Paused&) const { return State::kPaused; }
    State operator()(const Recovering&) const { return State::kRecovering; }
    State operator()(const Returning&) const { return State::kReturning; }
    State operator()(const Consolidating&) const { return State::kConsolidating; }
    State operator()(const Ended& ended) const { return ended.how; }
  };
  return std::visit(Names{}, mission);
}

}  // namespace lapis::planner
