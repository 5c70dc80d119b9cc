#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "evaluator/core/statistics.hpp"
#include "evaluator/core/trajectory/association.hpp"
#include "evaluator/core/trajectory/ate.hpp"
#include "evaluator/core/trajectory/rpe.hpp"

namespace lapis::evaluator {
namespace {

constexpr std::int64_t kMillisecond = 1000000;

time::Time at_ms(std::int64_t ms) { return {ms * kMillisecond}; }

geometry::Pose random_pose(std::mt19937& engine, double spread_m = 5.0, double angle_rad = 3.0) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  geometry::Vector6d xi;
  for (int i = 0; i < 3; ++i) xi[i] = spread_m * uniform(engine);
  for (int i = 3; i < 6; ++i) xi[i] = angle_rad / 2.0 * uniform(engine);
  return geometry::se3_exp(xi);
}

Trajectory wandering(std::size_t count, std::int64_t period_ms, unsigned seed) {
  std::mt19937 engine(seed);
  Trajectory trajectory;
  geometry::Pose T = random_pose(engine);
  for (std::size_t i = 0; i < count; ++i) {
    trajectory.push_back({at_ms(static_cast<std::int64_t>(i) * period_ms), T});
    T = T * random_pose(engine, 0.1, 0.2);
  }
  return trajectory;
}

Trajectory shifted_randomly(Trajectory trajectory, std::int64_t max_ms, unsigned seed) {
  std::mt19937 engine(seed);
  for (StampedPose& pose : trajectory) {
    pose.stamp.nanoseconds += static_cast<std::int64_t>(engine() % static_cast<unsigned>(max_ms)) * kMillisecond;
  }
  return trajectory;
}

Trajectory noisy(Trajectory trajectory, double noise_m, unsigned seed) {
  std::mt19937 engine(seed);
  for (StampedPose& pose : trajectory) pose.T_world_body = pose.T_world_body * random_pose(engine, noise_m, noise_m);
  return trajectory;
}

std::vector<Match> matches_of(const Trajectory& reference, const Trajectory& estimate) {
  return associate(reference, estimate, {});
}

TEST(Statistics, AgreeWithHandComputation) {
  const auto s = error_statistics({4.0, 1.0, 3.0, 2.0});
  ASSERT_TRUE(s);
  EXPECT_EQ(s->count, 4u);
  EXPECT_NEAR(s->rmse, std::sqrt(7.5), 1e-12);
  EXPECT_NEAR(s->mean, 2.5, 1e-12);
  EXPECT_NEAR(s->median, 2.5, 1e-12);
  EXPECT_NEAR(s->std, std::sqrt(1.25), 1e-12);
  EXPECT_EQ(s->min, 1.0);
  EXPECT_EQ(s->max, 4.0);
  EXPECT_FALSE(error_statistics({}));
  EXPECT_FALSE(quantile({}, 0.5));
  EXPECT_NEAR(*quantile({0.0, 10.0}, 0.95), 9.5, 1e-12);
  EXPECT_EQ(*quantile({7.0}, 0.95), 7.0);
}

TEST(Association, NearestIsOneToOneClosestFirstAndBelowTheLimit) {
  const Trajectory reference = shifted_randomly(wandering(300, 10, 1), 9, 2);
  const Trajectory estimate = shifted_randomly(wandering(200, 14, 3), 13, 4);
  const AssociationConfig config{AssociationRule::kNearest, time::Duration{8 * kMillisecond}};
  const auto matches = associate(reference, estimate, config);
  ASSERT_GT(matches.size(), 100u);
  std::set<std::size_t> used_estimates;
  std::set<std::int64_t> used_references;
  const auto partner_of = [&](const Match& match) {
    for (const StampedPose& pose : reference) {
      if (pose.T_world_body.isApprox(match.T_world_reference, 0.0)) return pose.stamp;
    }
    ADD_FAILURE() << "a match with a pose that is not in the reference";
    return time::Time{};
  };
  for (const Match& match : matches) {
    EXPECT_EQ(match.stamp, estimate[match.estimate_index].stamp);
    EXPECT_LT(time::abs(partner_of(match) - match.stamp), config.max_difference);
    EXPECT_TRUE(used_estimates.insert(match.estimate_index).second);
    EXPECT_TRUE(used_references.insert(partner_of(match).nanoseconds).second);
  }
  // Stable: no free pair that both sides would prefer, hence no free pair of free ones.
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    for (const StampedPose& pose : reference) {
      if (time::abs(pose.stamp - estimate[i].stamp) >= config.max_difference) continue;
      EXPECT_TRUE(used_estimates.contains(i) || used_references.contains(pose.stamp.nanoseconds));
    }
  }
}

TEST(Association, NearestPrefersTheSmallerDifference) {
  const Trajectory reference = {{at_ms(100), geometry::Pose::Identity()}};
  const Trajectory estimate = {{at_ms(95), geometry::Pose::Identity()}, {at_ms(102), geometry::Pose::Identity()}};
  const auto matches = associate(reference, estimate, {AssociationRule::kNearest, time::Duration{20 * kMillisecond}});
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].estimate_index, 1u);
}

TEST(Association, InterpolationIsExactForConstantTwist) {
  geometry::Vector6d twist;
  twist << 0.4, 0.0, 0.0, 0.0, 0.0, 0.0;
  Trajectory reference;
  for (int i = 0; i < 20; ++i) {
    geometry::Vector6d turn = geometry::Vector6d::Zero();
    turn.tail<3>() = Eigen::Vector3d(0.1, -0.2, 0.3) * i;
    geometry::Pose T = geometry::se3_exp(turn);
    T.translation() = Eigen::Vector3d(0.4, -0.1, 0.2) * i;
    reference.push_back({at_ms(30 * i), T});
  }
  const Trajectory estimate = {{at_ms(75), geometry::Pose::Identity()}, {at_ms(90), geometry::Pose::Identity()}};
  const auto matches = associate(reference, estimate, {});
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_LT((matches[0].T_world_reference.translation() - Eigen::Vector3d(1.0, -0.25, 0.5)).norm(), 1e-12);
  const Eigen::Vector3d turn = geometry::so3_log(matches[0].T_world_reference.linear());
  EXPECT_LT((turn - Eigen::Vector3d(0.25, -0.5, 0.75)).norm(), 1e-12);
  EXPECT_TRUE(matches[1].T_world_reference.isApprox(reference[3].T_world_body, 0.0));
}

TEST(Association, InterpolationNeverExtrapolatesNorBridgesGaps) {
  const Trajectory reference = {{at_ms(100), geometry::Pose::Identity()}, {at_ms(200), geometry::Pose::Identity()}};
  Trajectory estimate;
  for (const std::int64_t ms : {99, 100, 119, 120, 150, 181, 200, 201}) estimate.push_back({at_ms(ms)});
  std::vector<std::int64_t> kept;
  for (const Match& match : associate(reference, estimate, {})) kept.push_back(match.stamp.nanoseconds / kMillisecond);
  EXPECT_EQ(kept, (std::vector<std::int64_t>{100, 119, 181, 200}));
  EXPECT_TRUE(associate({}, estimate, {}).empty());
  EXPECT_TRUE(associate(reference, {}, {}).empty());
}

TEST(Alignment, RecoversAConstructedTransform) {
  std::mt19937 engine(5);
  for (int trial = 0; trial < 50; ++trial) {
    const geometry::Pose T_a_b = random_pose(engine);
    std::vector<Eigen::Vector3d> p_a, p_b;
    for (int i = 0; i < 12; ++i) {
      p_b.emplace_back(random_pose(engine).translation());
      p_a.emplace_back(T_a_b * p_b.back());
    }
    EXPECT_LT((align_points(p_a, p_b).matrix() - T_a_b.matrix()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Alignment, NoSmallMotionImprovesIt) {
  std::mt19937 engine(6);
  std::vector<Eigen::Vector3d> p_a, p_b;
  for (int i = 0; i < 30; ++i) {
    p_a.emplace_back(random_pose(engine).translation());
    p_b.emplace_back(random_pose(engine).translation());
  }
  const auto cost = [&](const geometry::Pose& T) {
    double sum = 0.0;
    for (std::size_t i = 0; i < p_a.size(); ++i) sum += (p_a[i] - T * p_b[i]).squaredNorm();
    return sum;
  };
  const geometry::Pose best = align_points(p_a, p_b);
  for (int i = 0; i < 200; ++i) EXPECT_GE(cost(best * random_pose(engine, 1e-3, 1e-3)), cost(best));
}

TEST(Alignment, IsAProperRotationForMirroredFlatLinearAndSinglePoints) {
  const std::vector<Eigen::Vector3d> corner = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  std::vector<Eigen::Vector3d> mirrored = corner;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  const std::vector<Eigen::Vector3d> single = {{1, 2, 3}};
  EXPECT_TRUE(geometry::is_valid(align_points(corner, mirrored)));
  EXPECT_TRUE(geometry::is_valid(align_points(line, line)));
  EXPECT_TRUE(geometry::is_valid(align_points(single, single)));
  EXPECT_THROW(align_points(single, line), std::invalid_argument);
  EXPECT_THROW(align_points({}, {}), std::invalid_argument);
}

TEST(AbsoluteErrorTest, AlignmentRemovesExactlyWhatItShould) {
  std::mt19937 engine(8);
  const Trajectory reference = wandering(100, 33, 9);
  const Trajectory moved = express_in(random_pose(engine), reference);
  const auto matches = matches_of(reference, moved);
  EXPECT_GT(absolute_error(matches, Alignment::kNone)->position_m.rmse, 0.1);
  EXPECT_LT(absolute_error(matches, Alignment::kOrigin)->position_m.max, 1e-9);
  EXPECT_LT(absolute_error(matches, Alignment::kSe3)->position_m.max, 1e-9);
  EXPECT_LT(absolute_error(matches, Alignment::kSe3)->heading_rad.max, 1e-9);
  EXPECT_FALSE(absolute_error({}, Alignment::kSe3));
}

TEST(AbsoluteErrorTest, Se3IsNeverWorseThanTheOthers) {
  const Trajectory reference = wandering(200, 33, 10);
  const auto matches = matches_of(reference, noisy(reference, 0.05, 11));
  const double se3 = absolute_error(matches, Alignment::kSe3)->position_m.rmse;
  EXPECT_LE(se3, absolute_error(matches, Alignment::kNone)->position_m.rmse);
  EXPECT_LE(se3, absolute_error(matches, Alignment::kOrigin)->position_m.rmse);
}

TEST(AbsoluteErrorTest, HeadingIsTheTurnAboutTheVerticalWhateverTheBodyAxes) {
  std::mt19937 engine(12);
  for (const double turn : {-3.0, -0.4, 0.0, 1.2, 3.1}) {
    Match match;
    match.T_world_reference = random_pose(engine);
    match.T_world_estimate =
        geometry::make_pose({0, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()))) *
        match.T_world_reference;
    const auto error = absolute_error(std::vector<Match>{match}, Alignment::kNone);
    EXPECT_NEAR(error->poses[0].heading_rad, turn, 1e-9);
    EXPECT_NEAR(error->heading_rad.rmse, std::abs(turn), 1e-9);
  }
}

// The definition, written as directly as possible: all pairs, no search structure.
std::vector<double> brute_force_rpe(const Trajectory& estimate, const Trajectory& reference, double delta,
                                    DeltaUnit unit) {
  std::vector<double> travelled(estimate.size(), 0.0);
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    const double step_m =
        (reference[i].T_world_body.translation() - reference[i - 1].T_world_body.translation()).norm();
    const double step_s = (estimate[i].stamp - estimate[i - 1].stamp).seconds();
    travelled[i] = travelled[i - 1] + (unit == DeltaUnit::kMetres    ? step_m
                                       : unit == DeltaUnit::kSeconds ? step_s
                                                                     : 1.0);
  }
  std::vector<double> errors;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    std::size_t j = 0;
    for (std::size_t k = 0; k < estimate.size(); ++k) {
      const double target = travelled[i] + delta;
      if (std::abs(travelled[k] - target) < std::abs(travelled[j] - target)) j = k;
    }
    const bool is_whole =
        unit == DeltaUnit::kFrames ? j == i + static_cast<std::size_t>(delta) : j + 1 < estimate.size();
    if (!is_whole) continue;
    const Eigen::Vector3d a = (estimate[i].T_world_body.inverse() * estimate[j].T_world_body).translation();
    const Eigen::Vector3d b = (reference[i].T_world_body.inverse() * reference[j].T_world_body).translation();
    errors.push_back((a - b).norm());
  }
  return errors;
}

TEST(RelativeErrorTest, AgreesWithBruteForceInEveryUnit) {
  const Trajectory reference = wandering(150, 33, 13);
  const Trajectory estimate = noisy(reference, 0.02, 14);
  const auto matches = matches_of(reference, estimate);
  for (const auto& [unit, delta] : {std::pair{DeltaUnit::kSeconds, 1.0},
                                    {DeltaUnit::kMetres, 1.0},
                                    {DeltaUnit::kFrames, 1.0},
                                    {DeltaUnit::kFrames, 30.0}}) {
    const auto result = relative_error(estimate, matches, {delta, unit, MotionError::kPaper});
    const auto expected = brute_force_rpe(estimate, reference, delta, unit);
    ASSERT_TRUE(result);
    ASSERT_EQ(result->intervals.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(result->intervals[i].translation_m, expected[i], 1e-9);
    }
  }
}

TEST(RelativeErrorTest, DoesNotSeeTheFrameOfTheEstimate) {
  std::mt19937 engine(15);
  const Trajectory reference = wandering(100, 33, 16);
  const Trajectory estimate = noisy(reference, 0.02, 17);
  const Trajectory moved = express_in(random_pose(engine), estimate);
  for (const MotionError kind : {MotionError::kBenchmark, MotionError::kPaper}) {
    const RelativeErrorConfig config{1.0, DeltaUnit::kSeconds, kind};
    const auto a = relative_error(estimate, matches_of(reference, estimate), config);
    const auto b = relative_error(moved, matches_of(reference, moved), config);
    EXPECT_NEAR(a->translation_m.rmse, b->translation_m.rmse, 1e-9);
    EXPECT_NEAR(a->rotation_rad.rmse, b->rotation_rad.rmse, 1e-9);
  }
}

TEST(RelativeErrorTest, GapsInTheMatchesAreLeftOut) {
  const Trajectory reference = wandering(100, 33, 18);
  auto matches = matches_of(reference, reference);
  std::erase_if(matches, [](const Match& m) { return m.estimate_index >= 40 && m.estimate_index < 60; });
  const auto result = relative_error(reference, matches, {1.0, DeltaUnit::kSeconds});
  ASSERT_TRUE(result);
  for (const IntervalError& interval : result->intervals) {
    EXPECT_NEAR((interval.end - interval.start).seconds(), 1.0, 0.02);
    EXPECT_LT(interval.translation_m, 1e-9);
  }
}

TEST(RelativeErrorTest, TooShortIsNoResultAndBadDeltaAnError) {
  const Trajectory reference = wandering(10, 33, 19);
  const auto matches = matches_of(reference, reference);
  EXPECT_FALSE(relative_error(reference, matches, {5.0, DeltaUnit::kSeconds}));
  EXPECT_FALSE(relative_error(reference, matches, {500.0, DeltaUnit::kMetres}));
  EXPECT_FALSE(relative_error(reference, matches, {10.0, DeltaUnit::kFrames}));
  EXPECT_TRUE(relative_error(reference, matches, {9.0, DeltaUnit::kFrames}));
  EXPECT_FALSE(relative_error(reference, {}, {}));
  EXPECT_THROW(relative_error(reference, matches, {0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace lapis::evaluator
