#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

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
  Ended exploration;                          ///< how that ended
  std::vector<Eigen::Vector2d> visited = {};  ///< old places, since all of them were to be visited [m, map]
  bool rests = false;                         ///< there is none to drive to
};

struct Recovering {
  std::variant<Exploring, Returning, Consolidating> interrupted;
  time::Time lost_at;  ///< when slam lost its pose
};

/// What the mission does, with what only that needs to know.
using MissionState = std::variant<Idle, Exploring, Paused, Recovering, Returning, Consolidating, Ended>;

/// How exploration has ended, where that is to be said when the robot has returned; else null.
inline const Ended* outcome_of(const MissionState& mission) {
  const auto outcome_in = [](const auto& states) -> const Ended* {
    if (const auto* returning = std::get_if<Returning>(&states)) return &returning->then;
    if (const auto* consolidating = std::get_if<Consolidating>(&states)) return &consolidating->exploration;
    return nullptr;
  };
  if (const auto* recovering = std::get_if<Recovering>(&mission)) return outcome_in(recovering->interrupted);
  if (const auto* ended = std::get_if<Ended>(&mission)) return ended->how == State::kGaveUp ? ended : nullptr;
  return outcome_in(mission);
}

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
