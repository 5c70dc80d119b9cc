#include "tests/benchmark/slam/carried_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "evaluator/core/statistics.hpp"
#include "simulator/core/robot/starts.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "tests/benchmark/slam/dice.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"
#include "tests/benchmark/slam/trial_rig.hpp"

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;
using simulator::StartPose;

constexpr double kFoundFor_s = 2.0;
constexpr double kWrong_m = 1.0;

bool is_right(const WatchedFrame& frame) {
  constexpr double kWithin_m = 0.3, kWithin_rad = 10.0 * std::numbers::pi / 180.0;
  return frame.source != PoseSource::kNone && frame.error.m <= kWithin_m && frame.error.rad <= kWithin_rad;
}

// First frame of a stretch of right poses in the map of before, from `begin` on; it begins with one that the camera
// gives.
std::optional<std::size_t> find_found(const std::vector<WatchedFrame>& frames, std::size_t begin) {
  std::optional<std::size_t> first;
  for (std::size_t i = begin; i < frames.size(); ++i) {
    const bool is_in_it = is_right(frames[i]) && frames[i].map == frames[begin - 1].map;
    if (!is_in_it) first.reset();
    if (!first && is_in_it && is_held(frames[i])) first = i;
    if (first && frames[i].t_s - frames[*first].t_s >= kFoundFor_s) return first;
  }
  return std::nullopt;
}

// Wrong poses by vision or surfaces once it had been lost: places that it is not at.
double wrong_return_s(const std::vector<WatchedFrame>& frames, std::size_t begin) {
  double wrong_s = 0.0;
  bool was_lost = false;
  for (std::size_t i = begin; i < frames.size(); ++i) {
    was_lost = was_lost || frames[i].source == PoseSource::kNone;
    if (was_lost && is_held(frames[i]) && frames[i].error.m > kWrong_m) wrong_s += frames[i].t_s - frames[i - 1].t_s;
  }
  return wrong_s;
}

// One trial as it goes on.
class Course {
 public:
  Course(const TourSetting& setting, const SlamConfig& config, const Carry& carry)
      : setting_(setting), carry_(carry), dice_(setting.simulation.seed),
        rig_(setting.world, setting.simulation, setting.start), slam_(config, T_base_camera(setting.simulation.mount)) {
  }

  CarriedTrial run() {
    drive_first_tour();
    trial_.lifted = slam_.frames().size();
    hang();
    set_down();
    trial_.set_down = slam_.frames().size();
    drive_second_tour();
    trial_.frames = slam_.frames();
    trial_.map = slam_.finish();
    return trial_;
  }

 private:
  void drive_first_tour() {
    simulator::Tour tour =
        plan_tour(setting_.world.nav_map(), setting_.start.position, setting_.world.scene().tour, setting_.tour);
    const double whole_s = setting_.longest_s > 0.0 ? std::min(setting_.longest_s, tour.duration_s) : tour.duration_s;
    const double end_s = whole_s * dice_.between(carry_.earliest, carry_.latest);
    simulator::TourFollower follower(setting_.world.nav_map(), std::move(tour), setting_.tour);
    while (!follower.is_finished() && rig_.robot().stamp.seconds() < end_s) {
      drive_on(follower);
      passed_.push_back(rig_.robot().position);
    }
  }

  void hang() {
    const double end_s = rig_.robot().stamp.seconds() + carry_.in_air_s;
    while (rig_.robot().stamp.seconds() < end_s) {
      tell(rig_.hang());
      slam_.process(rig_.see_cover(false), rig_.T_world_camera());
    }
  }

  void set_down() {
    const Eigen::Vector2d from = rig_.robot().position;
    trial_.place = {draw_place(from), dice_.between(-std::numbers::pi, std::numbers::pi)};
    trial_.carried_m = (trial_.place.position - from).norm();
    rig_.set_down(trial_.place);
  }

  // Not near, and where the robot has been, or beside; or where it has not been.
  Eigen::Vector2d draw_place(const Eigen::Vector2d& from) {
    constexpr double kLeast_m = 3.0, kBeside_m = 0.5, kNew_m = 4.0;
    const double away_m = carry_.to_new_place ? kNew_m : kBeside_m;
    const simulator::NavMap& map = setting_.world.nav_map();
    std::vector<Eigen::Vector2d> places;
    for (const simulator::Cell cell : simulator::open_cells(map, setting_.simulation.robot.radius_m)) {
      const Eigen::Vector2d p = map.grid().center(cell);
      const bool was_passed = std::any_of(passed_.begin(), passed_.end(),
                                          [&](const Eigen::Vector2d& q) { return (p - q).norm() < away_m; });
      if ((p - from).norm() >= kLeast_m && was_passed != carry_.to_new_place) places.push_back(p);
    }
    if (places.empty()) throw std::runtime_error("there is no place to set the robot down");
    return places[static_cast<std::size_t>(dice_.between(0.0, static_cast<double>(places.size())))];
  }

  void drive_second_tour() {
    const double begin_s = rig_.robot().stamp.seconds();
    double end_s = begin_s + carry_.search_s;
    std::optional<simulator::TourFollower> follower;
    while (rig_.robot().stamp.seconds() < end_s) {
      if (!follower) follower.emplace(setting_.world.nav_map(), plan_second_tour(), setting_.tour);
      drive_on(*follower);
      if (follower->is_finished() && !carry_.again) return;
      if (follower->is_finished()) follower.reset();
      const auto found = find_found(slam_.frames(), trial_.set_down);
      if (found) end_s = std::min(end_s, slam_.frames()[*found].t_s + carry_.after_s);
      if (wrong_return_s(slam_.frames(), trial_.set_down) > carry_.wrong_s) return;
    }
  }

  // All rooms, beginning with the nearest; after a new place beginning with the nearest of those that are known.
  simulator::Tour plan_second_tour() const {
    const Eigen::Vector2d here = rig_.robot().position;
    std::vector<Eigen::Vector2d> waypoints = setting_.world.scene().tour;
    const auto nearest = [&](auto begin, auto end) {
      return std::min_element(begin, end, [&](const auto& a, const auto& b) {
        return (a - here).squaredNorm() < (b - here).squaredNorm();
      });
    };
    if (carry_.to_new_place) {
      const auto known = std::stable_partition(waypoints.begin(), waypoints.end(),
                                               [&](const Eigen::Vector2d& waypoint) { return was_passed(waypoint); });
      if (known != waypoints.begin()) std::rotate(waypoints.begin(), nearest(waypoints.begin(), known), known);
    } else {
      std::rotate(waypoints.begin(), nearest(waypoints.begin(), waypoints.end()), waypoints.end());
    }
    return plan_tour(setting_.world.nav_map(), here, waypoints, setting_.tour);
  }

  bool was_passed(const Eigen::Vector2d& waypoint) const {
    constexpr double kWithin_m = 0.5;
    return std::any_of(passed_.begin(), passed_.end(),
                       [&](const Eigen::Vector2d& p) { return (p - waypoint).norm() < kWithin_m; });
  }

  void drive_on(simulator::TourFollower& follower) {
    tell(rig_.advance(follower.command(rig_.robot())));
    if (const auto problem = follower.stalled(); !problem.empty()) throw std::runtime_error(problem);
    slam_.process(rig_.see(), rig_.T_world_camera());
  }

  void tell(const std::vector<simulator::OdometrySample>& readings) {
    if (!carry_.with_odometry) return;
    for (const auto& reading : readings) slam_.add_odometry(reading.stamp, pose_of(reading));
  }

  const TourSetting& setting_;
  const Carry& carry_;
  Dice dice_;
  TrialRig rig_;
  WatchedSlam slam_;
  CarriedTrial trial_;
  std::vector<Eigen::Vector2d> passed_;  // by the robot before it was lifted, at every frame
};

double path_m(const std::vector<WatchedFrame>& frames, std::size_t begin, std::size_t end) {
  double path_m = 0.0;
  for (std::size_t i = begin + 1; i <= end; ++i) {
    path_m += (frames[i].truth.translation() - frames[i - 1].truth.translation()).norm();
  }
  return path_m;
}

void judge_wrong_poses(const CarriedTrial& trial, CarriedVerdict& verdict) {
  verdict.wrong_return_s = wrong_return_s(trial.frames, trial.set_down);
  for (std::size_t i = trial.set_down; i < trial.frames.size(); ++i) {
    const WatchedFrame& frame = trial.frames[i];
    const double period_s = frame.t_s - trial.frames[i - 1].t_s;
    if (frame.source == PoseSource::kNone || frame.error.m <= kWrong_m) continue;
    if (frame.source == PoseSource::kVision) verdict.wrong_vision_s += period_s;
    if (frame.source == PoseSource::kSurfaces) verdict.wrong_surfaces_s += period_s;
    if (frame.source == PoseSource::kOdometry) verdict.wrong_odometry_s += period_s;
  }
}

// Whether the camera shows what it showed before it was lifted: within 1 m and 30 degrees of where it was then.
bool shows_old_place(const CarriedTrial& trial, const WatchedFrame& frame) {
  constexpr double kWithin_m = 1.0, kWithin_rad = 30.0 * std::numbers::pi / 180.0;
  const auto lifted = trial.frames.begin() + static_cast<std::ptrdiff_t>(trial.lifted);
  return std::any_of(trial.frames.begin(), lifted, [&](const WatchedFrame& old) {
    if (!old.is_keyframe) return false;
    const PoseError apart = difference(old.truth, frame.truth);
    return apart.m < kWithin_m && apart.rad < kWithin_rad;
  });
}

double extent_m(const std::vector<Eigen::Vector3d>& positions) {
  double most_m = 0.0;
  for (const Eigen::Vector3d& a : positions) {
    for (const Eigen::Vector3d& b : positions) most_m = std::max(most_m, (a - b).norm());
  }
  return most_m;
}

void judge_cpu(const CarriedTrial& trial, ElsewhereVerdict& verdict) {
  std::vector<double> tracked_ms, lost_ms;
  for (std::size_t i = 0; i < trial.frames.size(); ++i) {
    const WatchedFrame& frame = trial.frames[i];
    const bool is_covered = i >= trial.lifted && i < trial.set_down;
    if (frame.source == PoseSource::kVision && !frame.is_keyframe) tracked_ms.push_back(frame.cpu_ms);
    if (frame.state == TrackingState::kLost && !is_covered) lost_ms.push_back(frame.cpu_ms);
  }
  verdict.tracked_ms = evaluator::quantile(tracked_ms, 0.5).value_or(NAN);
  verdict.lost_ms = evaluator::quantile(lost_ms, 0.5).value_or(NAN);
}

}  // namespace

CarriedTrial drive_carried(const TourSetting& setting, const SlamConfig& config, const Carry& carry) {
  return Course(setting, config, carry).run();
}

CarriedVerdict judge(const CarriedTrial& trial) {
  constexpr double kWrongFor_s = 2.0;
  const auto& frames = trial.frames;
  CarriedVerdict verdict;
  verdict.before = frames[trial.lifted - 1].error;
  const double set_down_s = frames[trial.set_down].t_s;
  const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(trial.set_down);
  const auto lost =
      std::find_if(begin, frames.end(), [](const WatchedFrame& frame) { return frame.source == PoseSource::kNone; });
  if (lost != frames.end()) verdict.declared_s = lost->t_s - set_down_s;
  if (const auto found = find_found(frames, trial.set_down)) {
    verdict.is_found = true;
    verdict.found_s = frames[*found].t_s - set_down_s;
    verdict.found_m = path_m(frames, trial.set_down, *found);
  }
  judge_wrong_poses(trial, verdict);
  verdict.is_wrong = verdict.wrong_return_s > kWrongFor_s || trial.map.wrong_loops > 0;
  return verdict;
}

ElsewhereVerdict judge_elsewhere(const CarriedTrial& trial) {
  constexpr double kBeside_m = 0.5, kWrongFor_s = 2.0;
  const auto& frames = trial.frames;
  const double set_down_s = frames[trial.set_down].t_s;
  const auto was_here = [&](const WatchedFrame& frame) {
    return std::any_of(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(trial.lifted), [&](const auto& f) {
      return (f.truth.translation() - frame.truth.translation()).norm() < kBeside_m;
    });
  };
  ElsewhereVerdict verdict;
  std::vector<Eigen::Vector3d> seen;
  double driven_m = 0.0;
  for (std::size_t i = trial.set_down; i < frames.size(); ++i) {
    const double step_m = (frames[i].truth.translation() - frames[i - 1].truth.translation()).norm();
    if (i > trial.set_down) driven_m += step_m;
    if (i > trial.set_down && was_here(frames[i])) verdict.known_m += step_m;
    if (shows_old_place(trial, frames[i])) seen.push_back(frames[i].truth.translation());
    if (!verdict.has_begun && frames[i].state == TrackingState::kUnconnected) {
      verdict.has_begun = true;
      verdict.begun_s = frames[i].t_s - set_down_s;
    }
    if (frames[i].source == PoseSource::kNone) continue;
    verdict.joined_s = frames[i].t_s - set_down_s;
    verdict.joined_m = driven_m;
    verdict.joined = frames[i].error;
    break;
  }
  verdict.seen_m = extent_m(seen);
  judge_cpu(trial, verdict);
  verdict.is_found = find_found(frames, trial.set_down).has_value();
  verdict.is_wrong =
      wrong_return_s(frames, trial.set_down) > kWrongFor_s || trial.map.wrong_loops > 0 || trial.map.far_keyframes > 0;
  return verdict;
}

}  // namespace lapis::slam::benchmark
