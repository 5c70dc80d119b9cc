#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "common/time/time.hpp"
#include "planner/core/space/cell.hpp"

namespace lapis::planner {

enum class State {
  kIdle,           ///< nothing has been requested
  kExploring,      ///< drives to frontiers
  kPaused,         ///< stands still until the mission is started again
  kRecovering,     ///< slam has no pose: the robot looks around
  kReturning,      ///< drives back to where the mission started, or to a place that was asked for
  kDone,           ///< nothing is left that can be reached, or the robot has returned
  kGaveUp,         ///< as kDone, but frontiers are left that geometry does not excuse; the reason names them
  kFailed,         ///< the robot needs help; the reason says why
  kConsolidating,  ///< nothing is left to explore: the robot drives through old places so that slam closes loops
};

struct Idle {};

struct Paused {};

struct Exploring {
  bool looks_at_gaps = false;               ///< at gaps of the map: no frontier is left to try
  bool looks_again = false;                 ///< also at targets that wait for a correction: nothing else is left
  bool goes_back = false;                   ///< to where slam tracked; otherwise the awaited frames never enter the map
  int empty_decisions = 0;                  ///< number in a row, each answered by a look around
  std::optional<time::Time> nothing_since;  ///< since when no candidate has been open
};

/// How the mission ended.
struct Ended {
  State how = State::kDone;  ///< kDone, kGaveUp or kFailed
  std::string why;           ///< of an exploration that came to its end; otherwise empty
};

/// Where an operator wants the robot.
struct Destination {
  Pose2 pose;
  bool has_heading = true;  ///< false: any heading is right there
};

struct Returning {
  Ended then = {};                                  ///< the state after arrival where the mission started
  std::optional<Destination> place = std::nullopt;  ///< where it goes instead, and then pauses
};

struct Consolidating {
  Ended exploration;                          ///< how exploration ended
  std::vector<Eigen::Vector2d> visited = {};  ///< old places visited in this round [m, map]
  bool rests = false;                         ///< there is no old place to drive to
};

struct Recovering {
  std::variant<Exploring, Returning, Consolidating> interrupted;
  time::Time lost_at;  ///< when slam lost its pose
};

/// The state of the mission, with the data that only this state needs.
using MissionState = std::variant<Idle, Exploring, Paused, Recovering, Returning, Consolidating, Ended>;

/// How exploration ended, when the mission still has to report it after the robot has returned; otherwise null.
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
