#include "tests/benchmark/slam/lost_trial_judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;
using Steps = std::vector<TrialStep>;

bool is_tracked(const TrialStep& step) { return step.state == TrackingState::kTracking; }

// How far `measured` (a member of TrialStep) is wrong about the motion between two steps.
PoseError motion_error(const TrialStep& a, const TrialStep& b, Pose TrialStep::*measured) {
  return difference((a.*measured).inverse() * (b.*measured), a.truth.inverse() * b.truth);
}

// Index of the first step from `begin` on for which `holds`.
template <class Predicate>
std::optional<std::size_t> find(const Steps& steps, std::size_t begin, Predicate holds) {
  const auto found = std::find_if(steps.begin() + static_cast<std::ptrdiff_t>(begin), steps.end(), holds);
  if (found == steps.end()) return std::nullopt;
  return static_cast<std::size_t>(found - steps.begin());
}

// Longest time that wrong poses were reported as tracked.
double longest_wrong_s(const Steps& steps, const TrialLimits& limits, bool with_odometry) {
  const std::size_t origin = *find(steps, 0, is_tracked);
  double longest_s = 0.0, path_m = 0.0;
  std::optional<double> since_s;
  for (std::size_t i = origin + 1; i < steps.size(); ++i) {
    path_m += difference(steps[i - 1].truth, steps[i].truth).m;
    const double allowed_m = limits.wrong_m + limits.drift * path_m +
                             (with_odometry ? motion_error(steps[origin], steps[i], &TrialStep::odometry).m : 0.0);
    const bool is_wrong =
        is_tracked(steps[i]) && motion_error(steps[origin], steps[i], &TrialStep::estimate).m > allowed_m;
    if (!is_wrong) since_s.reset();
    if (is_wrong && !since_s) since_s = steps[i].t_s;
    if (since_s) longest_s = std::max(longest_s, steps[i].t_s - *since_s);
  }
  return longest_s;
}

void judge_jumps(const Steps& steps, const TrialLimits& limits, bool with_odometry, TrialVerdict& verdict) {
  const std::size_t origin = *find(steps, 0, is_tracked);
  const TrialStep* reported = &steps[origin];
  const TrialStep* tracked = reported;
  for (std::size_t i = origin + 1; i < steps.size(); ++i) {
    const TrialStep& step = steps[i];
    if (!step.has_pose) continue;
    const PoseError jump = motion_error(*reported, step, &TrialStep::estimate);
    const PoseError before = motion_error(steps[origin], *reported, &TrialStep::estimate);
    const PoseError after = motion_error(steps[origin], step, &TrialStep::estimate);
    const PoseError odometry = with_odometry ? motion_error(*tracked, step, &TrialStep::odometry) : PoseError{};
    verdict.jump.m = std::max(verdict.jump.m, jump.m);
    verdict.jump.rad = std::max(verdict.jump.rad, jump.rad);
    verdict.jumps_away = verdict.jumps_away || after.m - before.m > limits.jump_m + odometry.m ||
                         after.rad - before.rad > limits.jump_rad + odometry.rad;
    reported = &step;
    if (is_tracked(step)) tracked = &step;
  }
}

bool touches_map(const Steps& steps) {
  for (std::size_t i = 1; i < steps.size(); ++i) {
    const TrialStep &a = steps[i - 1], &b = steps[i];
    if (is_tracked(b) || b.state == TrackingState::kInitializing) continue;
    if (a.graph_version != b.graph_version || a.keyframes != b.keyframes || a.landmarks != b.landmarks) return true;
  }
  return false;
}

// A view is back from the first frame of the first `lasting_s` throughout which there is enough to see; when the camera
// was not covered, of a place where a key-frame was made before it was lost.
std::optional<std::size_t> find_return(const Steps& steps, std::size_t lost, bool is_covered, double lasting_s) {
  constexpr double kNear_m = 0.4, kNear_rad = 0.35;
  const auto shows_old_place = [&](const TrialStep& step) {
    return std::any_of(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(lost), [&](const TrialStep& old) {
      const PoseError d = difference(old.truth, step.truth);
      return old.is_keyframe && d.m < kNear_m && d.rad < kNear_rad;
    });
  };
  std::optional<std::size_t> first;
  for (std::size_t i = lost; i < steps.size(); ++i) {
    const bool is_seen = steps[i].is_usable && (is_covered || shows_old_place(steps[i]));
    if (!is_seen) first.reset();
    if (is_seen && !first) first = i;
    if (first && steps[i].t_s - steps[*first].t_s >= lasting_s) return first;
  }
  return std::nullopt;
}

// From the last tracked frame to the first one afterwards.
void judge_return(const Steps& steps, std::size_t lost, const TrialLimits& limits, bool is_covered,
                  TrialVerdict& verdict) {
  const TrialStep& origin = steps[*find(steps, 0, is_tracked)];
  const auto returned = find_return(steps, lost, is_covered, limits.returned_s);
  const auto tracked = find(steps, lost, [](const TrialStep& s) { return is_tracked(s) && !s.is_covered; });
  verdict.is_void = !returned && !tracked;
  verdict.returned_s = std::numeric_limits<double>::infinity();
  if (!tracked) return;
  verdict.returned_s = returned ? std::max(0.0, steps[*tracked].t_s - steps[*returned].t_s) : 0.0;
  verdict.before = motion_error(origin, steps[lost - 1], &TrialStep::estimate);
  verdict.returned = motion_error(origin, steps[*tracked], &TrialStep::estimate);
  verdict.odometry = motion_error(steps[lost - 1], steps[*tracked], &TrialStep::odometry);
}

std::string failure_of(const TrialVerdict& v, const TrialLimits& limits, bool with_odometry) {
  std::string failure;
  const auto add = [&](bool fails, const char* what) {
    if (fails) failure += (failure.empty() ? "" : ", ") + std::string(what);
  };
  add(v.declared_s > limits.declared_s, "declared late");
  add(v.jumps_away, "jump");
  add(v.touches_map, "map touched");
  add(v.returned_s > limits.returned_s, "returned late");
  const PoseError odometry = with_odometry ? v.odometry : PoseError{};
  add(v.returned.m > v.before.m + limits.jump_m + odometry.m ||
          v.returned.rad > v.before.rad + limits.jump_rad + odometry.rad,
      "error on return");
  return failure;
}

}  // namespace

TrialVerdict judge(const Steps& steps, const TrialLimits& limits, bool is_covered, bool with_odometry) {
  TrialVerdict verdict;
  const auto begin = find(steps, 0, is_tracked);
  verdict.is_void = !begin.has_value();
  if (verdict.is_void) return verdict;
  verdict.declared_s = longest_wrong_s(steps, limits, with_odometry);
  auto lost = find(steps, *begin, [](const TrialStep& s) { return !is_tracked(s); });
  if (is_covered) {
    const std::size_t covered = *find(steps, 0, [](const TrialStep& s) { return s.is_covered; });
    verdict.is_void = covered == 0 || !is_tracked(steps[covered - 1]);
    if (verdict.is_void) return verdict;
    lost = find(steps, covered, [](const TrialStep& s) { return !is_tracked(s); });
    verdict.declared_s = lost ? steps[*lost].t_s - steps[covered].t_s : std::numeric_limits<double>::infinity();
  }
  verdict.was_lost = lost.has_value();
  if (lost) judge_return(steps, *lost, limits, is_covered, verdict);
  judge_jumps(steps, limits, with_odometry, verdict);
  verdict.touches_map = touches_map(steps);
  verdict.end = motion_error(steps[*begin], steps.back(), &TrialStep::estimate);
  verdict.failure = failure_of(verdict, limits, with_odometry);
  return verdict;
}

}  // namespace lapis::slam::benchmark
