#include "planner/core/exploration/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "planner/core/space/pose_path.hpp"

namespace lapis::planner {
namespace {

constexpr double kTurnTolerance_rad = 0.3;     // of the heading after a turn on the spot
constexpr double kRestPeriod_s = 5.0;          // between decisions while there is no old place to drive to
constexpr double kHomePeriod_s = 1.0;          // between searches for the path home when replan_period_s is 0
constexpr double kLeastDecisionTime_s = 0.5;   // least time from one decision to the next, in all cases
constexpr double kBlindPatience_s = 2.0;       // time without a pose before the robot looks around
constexpr double kLeastGrowth = 0.02;          // of the standard deviation in dead reckoning, per metre
constexpr int kBlindTurns = 2, kHeadings = 3;  // of a look around: full turns, and poses of the path per turn

double distance(const Pose2& a, const Pose2& b) { return (a.p_map - b.p_map).norm(); }

bool is_any_left_alone(const Decision& decision) {
  return std::any_of(decision.candidates.begin(), decision.candidates.end(), [](const Candidate& c) {
    return c.rejection >= Rejection::kFailedView && c.rejection <= Rejection::kLeftAlone;
  });
}

std::string purpose_of(const Candidate& chosen) {
  switch (chosen.kind) {
    case CandidateKind::kTracked: return "drives back to where slam tracked";
    case CandidateKind::kGap: return "drives to where gaps of the map are in sight";
    case CandidateKind::kRevisit: return "revisits an old place";
    default: return "drives to frontier " + std::to_string(chosen.frontier);
  }
}

/// Direction of the turn: 1 when the headings are to the left of the robot's heading, -1 to the right, 0 without
/// headings.
int side_of(const std::vector<double>& headings_rad, double yaw_rad) {
  if (headings_rad.empty()) return 0;
  return headings_rad.back() > yaw_rad ? 1 : -1;
}

std::vector<Pose2> turns_on_the_spot(bool is_to_the_left) {
  const double turn_rad = (is_to_the_left ? 2.0 : -2.0) * std::numbers::pi / kHeadings;
  std::vector<Pose2> headings;
  for (int i = 1; i <= kBlindTurns * kHeadings; ++i) headings.push_back({{0.0, 0.0}, turn_rad * i});
  return headings;
}

}  // namespace

Explorer::Explorer(const ExplorerConfig& config) : config_(config), setbacks_(config.memory), progress_(config.stall) {}

std::string Explorer::reason() const {
  const auto* consolidating = std::get_if<Consolidating>(&mission_);
  return consolidating != nullptr ? reason_ + "; " + consolidating->exploration.why : reason_;
}

void Explorer::start() {
  if (!std::holds_alternative<Exploring>(mission_)) drop_goal();
  const bool is_anew = std::holds_alternative<Idle>(mission_) || std::holds_alternative<Ended>(mission_) ||
                       std::holds_alternative<Consolidating>(mission_);
  if (is_anew) setbacks_.begin_anew();
  progress_.begin_anew();
  blind_since_.reset();
  enter(Exploring{}, home_ ? "started" : "waits for slam's first pose");
}

void Explorer::stop() {
  drop_goal();
  enter(Idle{}, "stopped");
}

bool Explorer::pause() {
  if (!is_active()) return false;
  drop_goal();
  enter(Paused{}, "paused");
  return true;
}

void Explorer::return_home() {
  drop_goal();
  Returning returning;
  if (const Ended* outcome = outcome_of(mission_)) returning.then = *outcome;
  enter(returning, "asked to return");
}

void Explorer::go_to(const Destination& place) {
  drop_goal();
  enter(Returning{.place = place}, "asked to drive to a place");
}

void Explorer::forget_map() {
  drop_goal();
  setbacks_.forget_map();
  progress_ = ProgressWatch(config_.stall);
  awaited_.clear();
  blind_since_.reset();
  home_.reset();
  trail_.clear();
  decided_at_.reset();
  chosen_at_.reset();
  if (std::holds_alternative<Recovering>(mission_)) resume("slam has begun another map");
  if (auto* exploring = std::get_if<Exploring>(&mission_)) *exploring = {};
  if (std::holds_alternative<Consolidating>(mission_)) enter(Exploring{}, "slam has begun another map");
  if (const auto* returning = std::get_if<Returning>(&mission_))
    fail(returning->place ? "the map of the place is gone" : "the map in which it started is gone");
}

/// Enters a state; the next decision is due at once.
void Explorer::enter(MissionState mission, std::string reason) {
  decided_at_.reset();
  mission_ = std::move(mission);
  reason_ = std::move(reason);
}

void Explorer::resume(std::string reason) {
  const auto interrupted = std::get<Recovering>(mission_).interrupted;
  std::visit([&](const auto& state) { enter(state, std::move(reason)); }, interrupted);
}

void Explorer::set_path(std::vector<Pose2> path, bool is_turn) {
  path_ = std::move(path);
  is_turn_ = is_turn;
  ++path_number_;
}

void Explorer::drop_goal() {
  goal_.reset();
  if (!path_.empty()) set_path({});
}

bool Explorer::is_active() const {
  return std::holds_alternative<Exploring>(mission_) || std::holds_alternative<Returning>(mission_) ||
         std::holds_alternative<Consolidating>(mission_) || std::holds_alternative<Recovering>(mission_);
}

bool Explorer::step(const Report& report, Surroundings* surroundings) {
  note_pose(report);
  if (!is_active()) return false;
  if (report.tracking != Tracking::kLost) {
    blind_since_.reset();
    if (is_turn_) drop_goal();
  } else if (!blind_since_) {
    blind_since_ = report.now;
  }
  if (!home_) {
    await_first_pose(report.now);
    return false;
  }
  if (report.tracking == Tracking::kLost || std::holds_alternative<Recovering>(mission_)) {
    recover(report);
    return false;
  }
  if (surroundings == nullptr || !report.robot) {
    reason_ = surroundings == nullptr ? "waits for the map" : "waits for the pose";
    return false;
  }
  surroundings->mark_driven(report.robot->p_map);
  surroundings->set_blocked(setbacks_.blocked_places(is_adrift_, report.now));
  if (auto* exploring = std::get_if<Exploring>(&mission_)) return explore(*exploring, report, *surroundings);
  if (auto* consolidating = std::get_if<Consolidating>(&mission_))
    return consolidate(*consolidating, report, *surroundings);
  return_or_go(std::get<Returning>(mission_), report, *surroundings);
  return false;
}

void Explorer::note_pose(const Report& report) {
  if (!report.robot) return;
  const bool was_adrift = std::exchange(is_adrift_, report.tracking == Tracking::kDeadReckoning);
  const bool was_beyond_budget = was_adrift && is_beyond_budget();
  reckoned_m_ = was_adrift && is_adrift_ ? reckoned_m_ + distance(robot_, *report.robot) : 0.0;
  drift_m_ = report.drift_m;
  robot_ = *report.robot;
  if (!home_) home_ = robot_;
  if (report.tracking == Tracking::kTracking) trail_.add(robot_);
  if (is_adrift_ && !was_adrift) trail_.turn_back();
  if (is_beyond_budget() && !was_beyond_budget) note_loss(report.now);
}

void Explorer::await_first_pose(time::Time now) {
  reason_ = "waits for slam's first pose";
  if (!blind_since_) return;
  if ((now - *blind_since_).seconds() <= config_.lost_timeout_s) return look_for_pose(now);
  drop_goal();
  fail("slam has found no first pose in " + std::to_string(std::lround(config_.lost_timeout_s)) +
       " s: move the robot to where there is something to see, and start again");
}

// Other views may show slam where it is; the views that the robot turned away from come first. The controller turns
// slowly, and the robot stands still after two full turns.
void Explorer::look_for_pose(time::Time now) {
  if ((now - *blind_since_).seconds() < kBlindPatience_s) return;
  reason_ = std::holds_alternative<Recovering>(mission_) ? "slam is lost: looks around"
                                                         : "looks around for slam's first pose";
  if (!is_turn_) set_path(turns_on_the_spot(!trail_.turned_left()), true);
}

bool Explorer::explore(Exploring& exploring, const Report& report, Surroundings& surroundings) {
  setbacks_.judge(surroundings, exploring.looks_again, is_adrift_, report.now);
  progress_.note(surroundings.explored_volume_m3(), report.robot->p_map, report.now);
  may_change_ = surroundings.grid().has_passing_obstacles();
  awaited_ = surroundings.awaited_targets();
  if (awaited_.empty()) exploring.looks_again = false;
  if (!is_adrift_ || awaited_.empty() || trail_.poses().empty()) exploring.goes_back = false;
  if (goal_ && is_of_other_tier(*goal_)) drop_goal();
  const bool may_decide = !chosen_at_ || (report.now - *chosen_at_).seconds() >= kLeastDecisionTime_s;
  if (!goal_) return may_decide;
  if (ends_goal(report, surroundings)) {
    drop_goal();
    return may_decide;
  }
  return may_decide &&
         (is_due(report.now, config_.replan_period_s) || !is_path_free(path_, *report.robot, surroundings.grid()));
}

bool Explorer::consolidate(const Consolidating& consolidating, const Report& report, Surroundings& surroundings) {
  const double period_s = consolidating.rests ? kRestPeriod_s : kLeastDecisionTime_s;
  const bool may_decide = !chosen_at_ || (report.now - *chosen_at_).seconds() >= period_s;
  if (!goal_) return may_decide;
  if (!is_at(*goal_, *report.robot) && !is_stopped(report, surroundings))
    return may_decide && !is_path_free(path_, *report.robot, surroundings.grid());
  end_visit();
  return may_decide;
}

/// Each old place is visited once, reached or not, before all are visited again.
void Explorer::end_visit() {
  auto* consolidating = std::get_if<Consolidating>(&mission_);
  if (consolidating != nullptr && goal_) consolidating->visited.push_back(*goal_->target_map);
  drop_goal();
}

/// True when the goal has been reached or has failed. Driving to and fro, or after something that is never seen, has to
/// end, whatever information the method expects.
bool Explorer::ends_goal(const Report& report, Surroundings& surroundings) {
  if (is_at(*goal_, *report.robot)) {
    note_arrival(report.now);
    return true;
  }
  if (progress_.is_stalled()) {
    add_failure(report.now, is_adrift_);
    reason_ = "nothing new was seen for long";
    return true;
  }
  return is_stopped(report, surroundings);
}

/// True when the robot cannot reach the goal: it is blocked, too slow, or does not move.
bool Explorer::is_stopped(const Report& report, Surroundings& surroundings) {
  const bool is_late = goal_->deadline && report.now > *goal_->deadline;
  if (!report.is_blocked && !is_late && !stands_still(report)) return false;
  if (goal_->target_map) note_blocked(report, surroundings);  // a turn on the spot cannot be blocked
  reason_ = report.is_blocked ? "the path was blocked" : is_late ? "the path took too long" : "it did not get on";
  return true;
}

/// True when a goal for relocalisation is obsolete because slam tracks again, or when another goal is no longer allowed
/// because the position is too uncertain.
bool Explorer::is_of_other_tier(const Goal& goal) const {
  return goal.kind == CandidateKind::kTracked ? !is_adrift_ : goal.target_map && is_beyond_budget();
}

bool Explorer::is_due(time::Time now, double period_s) const {
  return !decided_at_ || (period_s > 0.0 && (now - *decided_at_).seconds() >= period_s);
}

void Explorer::note_arrival(time::Time now) {
  if (!goal_->target_map) return;
  if (goal_->kind == CandidateKind::kTracked) return trail_.drop_nearest(goal_->pose);
  if (goal_->kind == CandidateKind::kGap) return setbacks_.note_view(goal_->pose);
  if (goal_->kind == CandidateKind::kRevisit) return setbacks_.note_revisit(*goal_->target_map, is_adrift_, now);
  setbacks_.await({*goal_->target_map, goal_->pose.p_map}, now, config_.settle_s);
}

// A feature that is seen only from nearby, such as an obstacle on a place that the map does not know, disappears when
// the robot leaves and reappears when it returns. Its target is left alone for a time; otherwise the robot would come
// back for ever. A closer look has not vanished: it waits while another frontier is in sight.
void Explorer::note_vanished(const Decision& decision, time::Time now) {
  if (!goal_ || !goal_->target_map || !is_of_frontier(goal_->kind)) return;
  const bool is_in_sight = std::any_of(decision.candidates.begin(), decision.candidates.end(), [](const Candidate& c) {
    return c.kind == CandidateKind::kFrontier && c.is_open();
  });
  if (goal_->kind == CandidateKind::kCloserLook && is_in_sight) return;
  bool is_there = false, is_unsure = false;
  for (const Candidate& c : decision.candidates) {
    if (!is_of_frontier(c.kind) || (c.target_map - *goal_->target_map).norm() > config_.memory.radius_m) continue;
    is_there |= !is_geometric(c.rejection);
    is_unsure |= c.rejection == Rejection::kUnsure;
  }
  if (is_unsure) note_loss(now);
  if (!is_there) setbacks_.await({*goal_->target_map, robot_.p_map}, now, config_.memory.expiry_s);
}

/// The heading counts for turns on the spot and for revisits, whatever the configured tolerance is: there the view
/// itself is the goal.
bool Explorer::is_at(const Goal& goal, const Pose2& robot) const {
  const bool is_heading_loose = goal.target_map && goal.kind != CandidateKind::kRevisit;
  const double tolerance_rad =
      is_heading_loose ? config_.goal_tolerance_rad : std::min(config_.goal_tolerance_rad, kTurnTolerance_rad);
  return distance(robot, goal.pose) <= config_.goal_tolerance_m &&
         turn_between(robot.yaw_rad, goal.pose.yaw_rad) <= tolerance_rad;
}

bool Explorer::stands_still(const Report& report) {
  if (has_moved(goal_->moved_from, *report.robot)) {
    goal_->moved_from = *report.robot;
    goal_->moved_at = report.now;
  }
  return (report.now - goal_->moved_at).seconds() > config_.progress_timeout_s;
}

// Remembers the failure of the target, and closes the place that stopped the robot to later paths.
void Explorer::note_blocked(const Report& report, Surroundings& surroundings) {
  add_failure(report.now, is_adrift_);
  const auto place = place_ahead(path_, *report.robot);
  if (!place) return;
  setbacks_.block(*place, report.now);
  surroundings.set_blocked(setbacks_.blocked_places(is_adrift_, report.now));
}

void Explorer::add_failure(time::Time now, bool is_adrift) {
  progress_.begin_anew();
  if (!goal_->target_map) return;
  setbacks_.note_failure(goal_->kind, *goal_->target_map, goal_->pose, is_adrift, now);
  if (goal_->kind == CandidateKind::kTracked) trail_.drop_nearest(goal_->pose);
}

Memory Explorer::memory(time::Time now) const {
  const auto* running = std::get_if<Exploring>(&mission_);
  const Exploring exploring = running != nullptr ? *running : Exploring{};
  Memory memory = setbacks_.memory(is_adrift_, now);
  for (const Eigen::Vector2d& target_map : awaited_) {
    if (!exploring.looks_again) memory.left_alone.push_back({target_map});
  }
  memory.looks_at_gaps = exploring.looks_at_gaps;
  if (const auto* consolidating = std::get_if<Consolidating>(&mission_)) memory.visited_places = consolidating->visited;
  if (goal_) {
    memory.goal = goal_->pose;
    memory.turns_to = goal_->turns_to;
  }
  memory.adrift = adrift(exploring);
  return memory;
}

std::optional<Adrift> Explorer::adrift(const Exploring& exploring) const {
  if (!is_adrift_) return std::nullopt;
  const double growth = std::max(kLeastGrowth, drift_m_ / std::max(1.0, reckoned_m_));
  return Adrift{.sigma_m = drift_m_,
                .growth = growth,
                .budget_m = exploring.goes_back ? 0.0 : config_.max_drift_m,
                .tracked = {trail_.poses().rbegin(), trail_.poses().rend()}};
}

bool Explorer::take(const Decision& decision, const Report& report) {
  auto* exploring = std::get_if<Exploring>(&mission_);
  auto* consolidating = std::get_if<Consolidating>(&mission_);
  if ((exploring == nullptr && consolidating == nullptr) || (goal_ && report.is_blocked)) return false;
  decided_at_ = chosen_at_ = report.now;
  if (exploring != nullptr) {
    act_on(*exploring, decision, report);
  } else {
    act_on(*consolidating, decision, report.now);
  }
  return true;
}

void Explorer::act_on(Exploring& exploring, const Decision& decision, const Report& report) {
  note_vanished(decision, report.now);
  if (!decision.chosen) return end_or_look_around(exploring, decision, report);
  exploring.empty_decisions = 0;
  exploring.nothing_since.reset();
  if (is_of_frontier(decision.candidates[*decision.chosen].kind)) exploring.looks_at_gaps = false;
  follow(decision, report.now);
}

/// Another round begins when all old places that can be driven to have been visited; when there are none, the robot
/// rests.
void Explorer::act_on(Consolidating& consolidating, const Decision& decision, time::Time now) {
  consolidating.rests = decision.candidates.empty();
  if (decision.chosen) return follow(decision, now);
  drop_goal();
  if (!consolidating.rests) consolidating.visited.clear();
  reason_ = consolidating.rests ? "no old place can be driven to" : "old places are visited once more";
}

/// True when the decision leads elsewhere although the current goal is still open.
bool Explorer::is_detour(const Decision& decision) const {
  if (!goal_ || !goal_->target_map) return false;
  const auto is_at_goal = [&](const Candidate& c) {
    return c.is_open() && (c.target_map - *goal_->target_map).norm() <= config_.memory.radius_m;
  };
  return !is_at_goal(decision.candidates[*decision.chosen]) &&
         std::any_of(decision.candidates.begin(), decision.candidates.end(), is_at_goal);
}

// Driving to and fro between goals without reaching any has to end, too.
void Explorer::set_deadline(const Candidate& chosen, bool is_detour, time::Time now) {
  const bool is_new =
      !goal_->deadline_of_map || (*goal_->deadline_of_map - chosen.target_map).norm() > config_.memory.radius_m;
  if (!is_new) return;  // the target is the same one, or has not moved farther than the radius
  if (!is_detour) goal_->set_out_at = now;
  const double longest_s = config_.progress_timeout_s + chosen.value.cost_m / config_.slowest_m_s;
  const time::Time due = goal_->set_out_at + time::Duration::from_seconds(longest_s);
  goal_->deadline = is_detour ? std::max(goal_->deadline.value_or(due), due) : due;
  goal_->deadline_of_map = chosen.target_map;
}

void Explorer::follow(const Decision& decision, time::Time now) {
  const Candidate& chosen = decision.candidates[*decision.chosen];
  if (!goal_) goal_ = Goal{.moved_from = chosen.path.front(), .moved_at = now};
  set_deadline(chosen, is_detour(decision), now);
  progress_.set_out(chosen.value.cost_m);
  goal_->pose = chosen.goal;
  goal_->target_map = chosen.target_map;
  goal_->kind = chosen.kind;
  goal_->turns_to = side_of(decision.first_turn_rad, robot_.yaw_rad);
  reason_ = purpose_of(chosen);
  std::vector<Pose2> path;
  for (const double heading_rad : decision.first_turn_rad) path.push_back({chosen.points.front(), heading_rad});
  const auto along = poses_along(chosen.points, config_.path_spacing_m, chosen.goal.yaw_rad);
  path.insert(path.end(), along.begin(), along.end());
  set_path(std::move(path));
}

// The robot first looks for gaps of the map, which always brings information. Then a turn in all directions may show
// what was missed, and failed targets get another chance.
void Explorer::end_or_look_around(Exploring& exploring, const Decision& decision, const Report& report) {
  const time::Time now = report.now;
  const bool turns = goal_ && !goal_->target_map && distance(robot_, goal_->pose) <= config_.goal_tolerance_m;
  if (turns) return;
  drop_goal();
  if (!std::exchange(exploring.looks_at_gaps, true)) return;
  if (!exploring.nothing_since) exploring.nothing_since = now;
  const double passed_s = (now - *exploring.nothing_since).seconds();
  const bool may_change = (may_change_ || report.is_map_behind) && passed_s < config_.patience_s;
  const bool is_worth_waiting =
      may_change || ((is_beyond_budget() || exploring.goes_back) && passed_s < config_.lost_timeout_s);
  if (exploring.empty_decisions < config_.confirmations || is_worth_waiting) {
    ++exploring.empty_decisions;
    goal_ = Goal{.pose = robot_, .moved_from = robot_, .moved_at = now};
    goal_->pose.yaw_rad += 2.0 * std::numbers::pi / config_.confirmations;
    reason_ = "looks around: no frontier can be driven to";
    return set_path({goal_->pose});
  }
  exploring.empty_decisions = 0;
  if (has_another_chance(exploring, decision, report)) return;
  end(decision.leftover);
}

void Explorer::end(const Leftover& leftover) {
  const bool has_given_up = leftover.share_to_blame > config_.max_left_share;
  const std::string left = leftover.text();
  const Ended ended{has_given_up ? State::kGaveUp : State::kDone,
                    (has_given_up ? "what is left was tried in vain" : "nothing is left that can be reached") +
                        (left.empty() ? "" : "; " + left)};
  if (config_.consolidates) {
    enter(Consolidating{ended}, "old places are visited");
  } else if (config_.returns_home) {
    enter(Returning{ended}, ended.why);
  } else {
    enter(ended, ended.why);
  }
}

// Targets that are left alone for a time are tried again; targets that were given up are tried once more from another
// side; blocked paths may be free again. Then, once, the robot looks at targets that wait for the map's correction,
// which may come where slam tracks.
bool Explorer::has_another_chance(Exploring& exploring, const Decision& decision, const Report& report) {
  const bool has_forgiven = is_any_left_alone(decision) && setbacks_.forgive_targets(report.now);
  const bool has_unblocked = setbacks_.forgive_blocked(report.now);
  if (has_forgiven || has_unblocked) return true;
  if (awaited_.empty() || std::exchange(exploring.looks_again, true)) return false;
  exploring.goes_back = is_adrift_;
  return true;
}

void Explorer::recover(const Report& report) {
  if (report.tracking != Tracking::kLost) {
    drop_goal();
    return resume(is_adrift_ ? "slam reckons by odometry alone" : "slam tracks again");
  }
  if (!std::holds_alternative<Recovering>(mission_)) {
    note_loss(report.now);
    end_visit();
    Recovering recovering{{}, report.now};
    if (const auto* exploring = std::get_if<Exploring>(&mission_)) recovering.interrupted = *exploring;
    if (const auto* returning = std::get_if<Returning>(&mission_)) recovering.interrupted = *returning;
    if (const auto* consolidating = std::get_if<Consolidating>(&mission_)) recovering.interrupted = *consolidating;
    enter(std::move(recovering), "slam is lost");
  }
  if ((report.now - std::get<Recovering>(mission_).lost_at).seconds() > config_.lost_timeout_s) {
    drop_goal();
    return fail("slam has not tracked for " + std::to_string(std::lround(config_.lost_timeout_s)) + " s");
  }
  look_for_pose(report.now);
}

// slam may lose track anywhere. A second loss on the way to the same target is attributed to what is seen there.
void Explorer::note_loss(time::Time now) {
  if (goal_ && goal_->target_map && setbacks_.note_loss(*goal_->target_map)) add_failure(now, false);
}

// People who stood in the way may have left, or may still leave.
bool Explorer::may_yet_return(const Report& report, Surroundings& surroundings) {
  if (setbacks_.forgive_blocked(report.now)) {
    surroundings.set_blocked(setbacks_.blocked_places(is_adrift_, report.now));
    goal_->moved_at = report.now;
    return true;
  }
  return surroundings.grid().has_passing_obstacles() && (report.now - goal_->moved_at).seconds() < config_.patience_s;
}

bool Explorer::is_at_end(const Returning& returning, const Pose2& robot) const {
  if (path_.empty() || distance(robot, path_.back()) > config_.goal_tolerance_m) return false;
  const bool is_heading_loose = !returning.place || !returning.place->has_heading;
  return is_heading_loose || turn_between(robot.yaw_rad, returning.place->pose.yaw_rad) <=
                                 std::min(config_.goal_tolerance_rad, kTurnTolerance_rad);
}

void Explorer::arrive(const Returning& returning) {
  drop_goal();
  if (returning.place) return enter(Paused{}, "is at the place that was asked for");
  const Ended& ended = returning.then;
  enter(ended, "is back where it started" + (ended.why.empty() ? "" : "; " + ended.why));
}

void Explorer::return_or_go(Returning returning, const Report& report, Surroundings& surroundings) {
  const bool is_home = !returning.place;
  const Pose2 to = is_home ? *home_ : returning.place->pose;
  if (!goal_) goal_ = Goal{.pose = to, .moved_from = *report.robot, .moved_at = report.now};
  if (is_at_end(returning, *report.robot)) return arrive(returning);
  const bool has_path = !path_.empty();
  if (report.is_blocked) note_blocked(report, surroundings);
  const bool is_wanted = !has_path || !is_path_free(path_, *report.robot, surroundings.grid());
  const double period_s = config_.replan_period_s > 0.0 ? config_.replan_period_s : kHomePeriod_s;
  if (report.is_blocked || (is_wanted && is_due(report.now, period_s))) drive_to(to, report, surroundings);
  const std::string no_path = is_home ? "no path back is known" : "no path to the place is known";
  reason_ = path_.empty() ? no_path : is_home ? "drives back to where it started" : "drives to a place";
  if (!has_path && !path_.empty()) goal_->moved_at = report.now;  // a path has become free
  if (!stands_still(report) || may_yet_return(report, surroundings)) return;
  const std::string trouble =
      path_.empty() ? no_path : "it does not get on to " + std::string(is_home ? "where it started" : "the place");
  drop_goal();
  is_home ? fail(trouble) : enter(Paused{}, trouble);
}

void Explorer::drive_to(const Pose2& to, const Report& report, const Surroundings& surroundings) {
  decided_at_ = report.now;
  std::vector<Pose2> path = pose_path_to(to, *report.robot, surroundings.grid(), config_.path, config_.path_spacing_m);
  if (!path.empty() || !path_.empty()) set_path(std::move(path));
}

}  // namespace lapis::planner
