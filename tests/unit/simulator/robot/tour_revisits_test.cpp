#include "simulator/core/robot/tour_revisits.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "floor_plan.hpp"

namespace lapis::simulator {
namespace {

constexpr double kSpacing_m = 10.0;
constexpr double kOnThePath_m = 0.01;

/// Two long rooms with a thin wall between them, open at the right end: what lies just behind the wall is near only as
/// the crow flies.
const NavMap& rooms() {
  static const NavMap map = map_of(14, 6, {{0, 2.9, 12, 3.1}});
  return map;
}

/// There and back on both sides of the wall; 43 m.
const Path kWaypoints = {{12, 1}, {13, 3}, {2, 5}, {11, 4}, {13, 2}, {3, 1}};

Tour tour() { return plan_tour(rooms(), {1, 1}, kWaypoints, {}); }

/// Dense points of the tour's path, with the length along it.
struct Sample {
  double along_m;
  Eigen::Vector2d p, direction;
};

std::vector<Sample> samples() {
  std::vector<Sample> result;
  double along_m = 0.0;
  for (const TourLeg& leg : tour().legs) {
    for (std::size_t i = 1; i < leg.path.size(); ++i) {
      const Eigen::Vector2d step = leg.path[i] - leg.path[i - 1];
      for (double d = 0.0; d < step.norm(); d += 0.005)
        result.push_back({along_m + d, leg.path[i - 1] + d * step.normalized(), step.normalized()});
      along_m += step.norm();
    }
  }
  return result;
}

/// The first place of the path that is this point.
Sample sample_at(const Eigen::Vector2d& p) {
  for (const Sample& sample : samples()) {
    if ((sample.p - p).norm() < kOnThePath_m) return sample;
  }
  ADD_FAILURE() << p.transpose() << " is not on the tour's path";
  return {};
}

double drive_m(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const auto path = PathPlanner(rooms(), {}).plan(from, to);
  return path ? length_m(*path) : 1e9;
}

TEST(TourRevisits, AreOnePerSpacingBetweenTheTourSOwnWaypoints) {
  const auto all = with_revisits(rooms(), tour(), kSpacing_m, {});
  const auto revisits = static_cast<std::size_t>(tour().length_m / kSpacing_m);
  ASSERT_EQ(revisits, 4U);
  ASSERT_EQ(all.size(), kWaypoints.size() + 4 * revisits);
  auto next = all.begin();
  for (const Eigen::Vector2d& own : kWaypoints) {
    next = std::find_if(next, all.end(), [&](const auto& p) { return (p - own).norm() < 0.05; });
    ASSERT_NE(next, all.end()) << own.transpose() << " is gone, or in another order";
    ++next;
  }
  EXPECT_EQ(next, all.end());
}

TEST(TourRevisits, GoToTheNearestOldPlacePastItAsThenAndBack) {
  const auto all = with_revisits(rooms(), tour(), kSpacing_m, {});
  const std::vector<Sample> path = samples();
  double at_m = kSpacing_m;
  for (std::size_t i = 0; i + 3 < all.size(); ++i) {
    if (all[i] != all[i + 3]) continue;  // leaves and comes back
    const Eigen::Vector2d &here = all[i], &old = all[i + 1], &past = all[i + 2];
    const auto left = std::find_if(path.begin(), path.end(), [&](const Sample& s) { return s.along_m >= at_m - 0.01; });
    EXPECT_LT((left->p - here).norm(), 0.02) << "leaves after " << at_m << " m";
    const Sample then = sample_at(old);
    EXPECT_LE(then.along_m, at_m - kSpacing_m + 0.02);
    EXPECT_LT((past - old).norm(), 1.01);
    EXPECT_GT((past - old).normalized().dot(then.direction), 0.8) << "past " << old.transpose();
    for (const Sample& other : path) {
      if (other.along_m > at_m - kSpacing_m) break;
      if (std::fmod(other.along_m, 1.0) > 0.005) continue;
      EXPECT_LE(drive_m(here, old), drive_m(here, other.p) + 0.3) << other.p.transpose() << " is nearer";
    }
    at_m += kSpacing_m;
  }
  EXPECT_EQ(at_m, 5 * kSpacing_m);
}

TEST(TourRevisits, AreNoneInATourThatIsShorter) {
  EXPECT_EQ(with_revisits(rooms(), tour(), 100.0, {}).size(), kWaypoints.size());
}

TEST(TourRevisits, MakeATourThatCanBeDriven) {
  const auto all = with_revisits(rooms(), tour(), kSpacing_m, {});
  EXPECT_GT(plan_tour(rooms(), {1, 1}, all, {}).length_m, tour().length_m + 4.0);
}

}  // namespace
}  // namespace lapis::simulator
