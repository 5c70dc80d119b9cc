#include "evaluator/core/trajectory/association.hpp"

#include <algorithm>
#include <tuple>

namespace lapis::evaluator {
namespace {

constexpr std::size_t kFree = static_cast<std::size_t>(-1);

Trajectory::const_iterator first_not_before(const Trajectory& trajectory, time::Time stamp) {
  return std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                          [](const StampedPose& pose, time::Time t) { return pose.stamp < t; });
}

struct Candidate {
  time::Duration difference;
  std::size_t estimate = 0;
  std::size_t reference = 0;
  bool operator<(const Candidate& other) const {
    return std::tie(difference, estimate, reference) < std::tie(other.difference, other.estimate, other.reference);
  }
};

std::vector<Candidate> close_pairs(const Trajectory& reference, const Trajectory& estimate, time::Duration limit) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const time::Time stamp = estimate[i].stamp;
    for (auto it = first_not_before(reference, stamp - limit); it != reference.end(); ++it) {
      if (it->stamp - stamp >= limit) break;
      const time::Duration difference = time::abs(it->stamp - stamp);
      if (difference < limit) candidates.push_back({difference, i, static_cast<std::size_t>(it - reference.begin())});
    }
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

std::vector<Match> match_nearest(const Trajectory& reference, const Trajectory& estimate, time::Duration limit) {
  std::vector<std::size_t> partner(estimate.size(), kFree);
  std::vector<bool> is_taken(reference.size(), false);
  for (const Candidate& c : close_pairs(reference, estimate, limit)) {
    if (partner[c.estimate] != kFree || is_taken[c.reference]) continue;
    partner[c.estimate] = c.reference;
    is_taken[c.reference] = true;
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    if (partner[i] == kFree) continue;
    matches.push_back({i, estimate[i].stamp, estimate[i].T_world_body, reference[partner[i]].T_world_body});
  }
  return matches;
}

}  // namespace

std::vector<Match> associate(const Trajectory& reference, const Trajectory& estimate, const AssociationConfig& config) {
  if (config.rule == AssociationRule::kNearest) return match_nearest(reference, estimate, config.max_difference);
  std::vector<Match> matches;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const auto T_world_reference = trajectory::pose_at(reference, estimate[i].stamp, config.max_difference);
    if (T_world_reference) matches.push_back({i, estimate[i].stamp, estimate[i].T_world_body, *T_world_reference});
  }
  return matches;
}

}  // namespace lapis::evaluator
