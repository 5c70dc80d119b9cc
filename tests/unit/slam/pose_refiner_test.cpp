#include "slam/core/tracking/pose_refiner.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "slam/core/frame/noise_model.hpp"
#include "slam/core/frame/surface.hpp"
#include "slam/core/tracking/pose_solver.hpp"
#include "slam/core/tracking/support.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr double kStep = 1e-6;

Pose some_pose() {
  Vector6d xi;
  xi << 0.1, -0.2, 0.15, 0.05, -0.1, 0.08;
  return geometry::se3_exp(xi);
}

// Points in view of the camera at `T`, measured with the assumed noise times `noise`.
std::vector<PointConstraint> measure(const NoiseConfig& config, const Pose& T, int count, double noise,
                                     std::mt19937& random) {
  const auto camera = test::small_camera();
  std::uniform_real_distribution<double> u(5.0, 315.0), v(5.0, 235.0), z(1.0, 6.0);
  std::normal_distribution<double> normal;
  std::vector<PointConstraint> points;
  for (int i = 0; i < count; ++i) {
    PointConstraint point;
    const Eigen::Vector3d p = camera.unproject(u(random), v(random), z(random));
    point.p_reference = T * p;
    point.sigma_px = config.pixel_sigma_px;
    point.pixel = camera.project(p) + noise * point.sigma_px * Eigen::Vector2d(normal(random), normal(random));
    point.depth_m = p.z() + noise * depth_sigma(config, p.z()) * normal(random);
    points.push_back(point);
  }
  return points;
}

Vector6d error(const Pose& truth, const Pose& estimate) { return geometry::se3_log(truth.inverse() * estimate); }

TEST(PointResidual, JacobianMatchesDifferences) {
  const auto camera = test::small_camera();
  const NoiseConfig noise;
  std::mt19937 random(2);
  for (const PointConstraint& point : measure(noise, some_pose(), 20, 3.0, random)) {
    const auto residual = point_residual(noise, camera, point, some_pose().inverse());
    ASSERT_TRUE(residual);
    for (int i = 0; i < 6; ++i) {
      const Vector6d step = kStep * Vector6d::Unit(i);
      const auto plus = point_residual(noise, camera, point, (some_pose() * geometry::se3_exp(step)).inverse());
      const auto minus = point_residual(noise, camera, point, (some_pose() * geometry::se3_exp(-step)).inverse());
      const Eigen::Vector3d numeric = (plus->value - minus->value) / (2.0 * kStep);
      for (std::size_t row = 0; row < 3; ++row) {
        EXPECT_NEAR(residual->jacobian[row][i], numeric[static_cast<Eigen::Index>(row)],
                    1e-4 * std::max(1.0, std::abs(numeric[static_cast<Eigen::Index>(row)])));
      }
    }
  }
}

TEST(SurfaceResidual, JacobianMatchesDifferencesOnAWall) {
  // A wall square to the camera's axis, so that the fixed pair of points of the derivation is also the true motion.
  const auto camera = test::small_camera();
  const geometry::DepthImage depth(camera.width, camera.height, 2.0F);
  const Pose T = Pose::Identity();
  const SurfaceSample sample{camera.unproject(200.0, 80.0, 2.01), {0.0, 0.0, -1.0}};
  const auto residual = surface_residual({}, camera, depth, sample, T.inverse());
  ASSERT_TRUE(residual);
  EXPECT_NEAR(residual->distance_m, 0.01, 1e-6);
  const Eigen::Vector3d p_camera = camera.unproject(200.0, 80.0, 2.0);
  for (int i = 0; i < 6; ++i) {
    const auto distance = [&](double step) {
      return sample.normal.dot(T * geometry::se3_exp(step * Vector6d::Unit(i)) * p_camera - sample.point);
    };
    EXPECT_NEAR(residual->jacobian[i], (distance(kStep) - distance(-kStep)) / (2.0 * kStep), 1e-6);
  }
}

TEST(RefinePose, RecoversThePoseExactlyWithoutNoise) {
  std::mt19937 random(4);
  const SlamConfig config;
  const auto points = measure(config.noise, some_pose(), 100, 0.0, random);
  const auto result = refine_pose(config, {test::small_camera(), points, {}, nullptr}, Pose::Identity());
  EXPECT_LT(error(some_pose(), result.T_reference_camera).norm(), 1e-5);
  EXPECT_EQ(result.inliers, 100);
  EXPECT_LT(result.rms_px, 1e-2);
}

// Over many scenes: the pose is as good as if the outliers had been left out.
TEST(RefinePose, SurvivesOutliers) {
  const SlamConfig config;
  const Pose start = some_pose() * geometry::se3_exp((Vector6d() << 0.02, -0.01, 0.02, 0.01, 0.01, -0.01).finished());
  Vector6d squares = Vector6d::Zero(), squares_without = Vector6d::Zero();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    auto points = measure(config.noise, some_pose(), 200, 1.0, random);
    const std::vector<PointConstraint> good(points.begin() + 60, points.end());
    for (std::size_t i = 0; i < 60; ++i) points[i].pixel += Eigen::Vector2d(20.0 + static_cast<double>(i), -25.0);
    const auto result = refine_pose(config, {test::small_camera(), points, {}, nullptr}, start);
    const auto without = refine_pose(config, {test::small_camera(), good, {}, nullptr}, start);
    squares += error(some_pose(), result.T_reference_camera).cwiseAbs2();
    squares_without += error(some_pose(), without.T_reference_camera).cwiseAbs2();
    for (std::size_t i = 0; i < 60; ++i) EXPECT_FALSE(result.is_inlier[i]);
    EXPECT_GT(result.inliers, 100);
  }
  EXPECT_LT(std::sqrt(squares.head<3>().sum() / 20), 0.004);
  EXPECT_LT(std::sqrt(squares.tail<3>().sum() / 20), 0.002);
  EXPECT_LT(squares.head<3>().sum(), 1.1 * squares_without.head<3>().sum());
  EXPECT_LT(squares.tail<3>().sum(), 1.1 * squares_without.tail<3>().sum());
}

TEST(RefinePose, InformationIsTheInverseCovarianceOfManyTrials) {
  std::mt19937 random(6);
  const SlamConfig config;
  const int trials = 400;
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d information = Matrix6d::Zero();
  const auto scene = measure(config.noise, some_pose(), 120, 0.0, random);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < trials; ++trial) {
    auto points = scene;
    for (PointConstraint& point : points) {
      point.pixel += point.sigma_px * Eigen::Vector2d(normal(random), normal(random));
      point.depth_m += depth_sigma(config.noise, point.depth_m) * normal(random);
    }
    const auto result = refine_pose(config, {test::small_camera(), points, {}, nullptr}, some_pose());
    const Vector6d e = error(some_pose(), result.T_reference_camera);
    covariance += e * e.transpose() / trials;
    information += result.information / trials;
  }
  // Whitened covariance near identity: robust weights and the sample size leave some play.
  const Matrix6d root = information.llt().matrixU();
  const Matrix6d whitened = root * covariance * root.transpose();
  const Vector6d shares = Eigen::SelfAdjointEigenSolver<Matrix6d>(whitened).eigenvalues();
  EXPECT_GT(shares.minCoeff(), 0.6);
  EXPECT_LT(shares.maxCoeff(), 2.0);
}

TEST(RefinePose, SurfacesAloneFixThePoseInARoomCorner) {
  const auto camera = test::small_camera();
  const SlamConfig config;
  const Pose T_room_first = geometry::se3_exp((Vector6d() << 0.5, 0.4, 0.3, 0.3, 0.6, 0.0).finished());
  const Pose T_first_second = geometry::se3_exp((Vector6d() << 0.03, -0.02, 0.02, 0.01, -0.015, 0.01).finished());
  const auto first = test::render_room(camera, T_room_first, {});
  const auto second = test::render_room(camera, T_room_first * T_first_second, {});
  const auto surface = sample_surface(config.surface, config.noise, camera, first.depth);
  const auto result = refine_pose(config, {camera, {}, surface, &second.depth}, Pose::Identity());
  EXPECT_LT(error(T_first_second, result.T_reference_camera).head<3>().norm(), 0.001);
  EXPECT_LT(error(T_first_second, result.T_reference_camera).tail<3>().norm(), 0.0005);
  EXPECT_GT(result.surface_matches, 200);
  EXPECT_LT(result.surface_rms_m, 0.0013);  // 1.2 mm: cells where walls meet bend by less than depth's noise
}

TEST(RefinePose, AWallLeavesWhatItCannotSeeToThePoints) {
  const auto camera = test::small_camera();
  const geometry::DepthImage wall(camera.width, camera.height, 2.0F);
  const SlamConfig config;
  const auto surface = sample_surface(config.surface, config.noise, camera, wall);
  const auto result = refine_pose(config, {camera, {}, surface, &wall}, Pose::Identity());
  EXPECT_NEAR(result.information(0, 0), 0.0, 1e-6);  // sliding along the wall
  EXPECT_NEAR(result.information(1, 1), 0.0, 1e-6);
  EXPECT_GT(result.information(2, 2), 1e4);
}

TEST(RefinePose, NothingToAlignLeavesThePoseAndKnowsNothing) {
  const auto result = refine_pose({}, {test::small_camera(), {}, {}, nullptr}, some_pose());
  EXPECT_TRUE(result.T_reference_camera.isApprox(some_pose(), 1e-12));
  EXPECT_EQ(result.inliers, 0);
  EXPECT_EQ(result.information.norm(), 0.0);
}

class SolvePose : public ::testing::Test {
 protected:
  SolvePose() {
    std::mt19937 random(8);
    points_ = measure(config_.noise, some_pose(), 100, 1.0, random);
    const std::vector<PointConstraint> right = points_;
    for (std::size_t i = 0; i < 40; ++i) points_[i].pixel = right[(i + 13) % 40].pixel;
  }
  SlamConfig config_;
  std::vector<PointConstraint> points_;
};

TEST_F(SolvePose, FindsThePoseAmongWrongMatchesAndRepeatsItself) {
  const auto first = solve_pose(config_.tracker, test::small_camera(), points_);
  const auto second = solve_pose(config_.tracker, test::small_camera(), points_);
  ASSERT_TRUE(first && second);
  EXPECT_LT(error(some_pose(), first->T_reference_camera).head<3>().norm(), 0.05);
  EXPECT_LT(error(some_pose(), first->T_reference_camera).tail<3>().norm(), 0.02);
  EXPECT_TRUE(first->T_reference_camera.matrix() == second->T_reference_camera.matrix());
}

TEST_F(SolvePose, GivesNoneForTooFewOrForNonsense) {
  const auto few = static_cast<std::ptrdiff_t>(config_.tracker.min_inliers - 1);
  EXPECT_FALSE(solve_pose(config_.tracker, test::small_camera(), {points_.begin(), points_.begin() + few}));
  std::mt19937 random(1);
  for (std::size_t i = points_.size() - 1; i > 0; --i) std::swap(points_[i].pixel, points_[random() % (i + 1)].pixel);
  EXPECT_FALSE(solve_pose(config_.tracker, test::small_camera(), points_));
}

// Where a camera has moved on by 10 cm and 3 degrees; what moves with the camera has the pose of before.
class SomethingMoves : public ::testing::Test {
 protected:
  static std::vector<PointConstraint> seen_at(const Pose& T, int count, bool is_confirmed, unsigned seed) {
    std::mt19937 random(seed);
    auto points = measure({}, T, count, 1.0, random);
    for (PointConstraint& point : points) point.is_confirmed = is_confirmed;
    return points;
  }
  static std::vector<PointConstraint> together(std::vector<PointConstraint> a, const std::vector<PointConstraint>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  Support support(const std::vector<PointConstraint>& points) const {
    return find_support(config_.tracker, test::small_camera(), points, truth_, kWindow_px2);
  }

  static constexpr double kWindow_px2 = 576.0;
  SlamConfig config_;
  Pose truth_ = geometry::se3_exp((Vector6d() << 0.08, 0.0, 0.06, 0.0, 0.05, 0.0).finished());
};

TEST_F(SomethingMoves, MatchesThatAgreeWithNoPoseAreNoRivals) {
  auto points = together(seen_at(truth_, 60, true, 1), seen_at(truth_, 90, true, 2));
  const auto right = points;
  for (std::size_t i = 60; i < 150; ++i) points[i].pixel = right[60 + (i - 60 + 17) % 90].pixel;
  const Support found = support(points);
  EXPECT_GE(found.agree, 60);
  EXPECT_EQ(found.rivals, 0);
  EXPECT_TRUE(is_significant(config_.tracker, found)) << "though 90 of 150 disagree";
}

TEST_F(SomethingMoves, AnotherPoseWithAboutAsManyMatchesIsARival) {
  const Support found = support(together(seen_at(truth_, 60, true, 1), seen_at(Pose::Identity(), 50, true, 2)));
  EXPECT_NEAR(found.agree, 60, 3);
  EXPECT_NEAR(found.rivals, 50, 6);
  EXPECT_FALSE(is_significant(config_.tracker, found));
  EXPECT_TRUE(is_significant(config_.tracker,
                             support(together(seen_at(truth_, 90, true, 1), seen_at(Pose::Identity(), 40, true, 2)))));
}

TEST_F(SomethingMoves, AsFewMatchesAsChanceGivesAreNotSignificant) {
  EXPECT_FALSE(is_significant(config_.tracker, {20, 200, 0, 17.4}));
  EXPECT_TRUE(is_significant(config_.tracker, {50, 200, 0, 17.4}));
}

TEST_F(SomethingMoves, PointsThatSeveralKeyframesHaveSeenDecide) {
  const auto points = together(seen_at(truth_, 40, true, 1), seen_at(Pose::Identity(), 120, false, 2));
  const auto result = refine_pose(config_, {test::small_camera(), points, {}, nullptr}, Pose::Identity());
  EXPECT_LT(error(truth_, result.T_reference_camera).norm(), 0.02);
  const Support found = support(points);
  EXPECT_EQ(found.of, 40);
  EXPECT_TRUE(is_significant(config_.tracker, found));
}

// A person in front of the camera keeps its distance while the camera moves: its depth says that nothing moves.
TEST_F(SomethingMoves, SurfacesThatContradictThePointsAreLeftOut) {
  const auto camera = test::small_camera();
  const auto with_person = [&](const Pose& T) {
    RgbdFrame frame = test::render_room(camera, T, {});
    for (int v = 0; v < camera.height; ++v) {
      for (int u = camera.width / 4; u < camera.width / 2; ++u) frame.depth(u, v) = 0.8F;
    }
    return frame;
  };
  const RgbdFrame before = with_person(Pose::Identity()), now = with_person(truth_);
  const auto surface = sample_surface(config_.surface, config_.noise, camera, before.depth);
  for (const bool is_confirmed : {true, false}) {
    const auto points = seen_at(truth_, 40, is_confirmed, 1);
    const auto result = refine_pose(config_, {camera, points, surface, &now.depth}, Pose::Identity());
    const double off = error(truth_, result.T_reference_camera).norm();
    EXPECT_EQ(off < 0.015, is_confirmed) << off;
  }
}

}  // namespace
}  // namespace lapis::slam
