#include "slam/core/graph/slam_graph.hpp"

#include <algorithm>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "slam/core/graph/due_result.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"
#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

// A chain of key-frames with a branch: 0 - 1 - 2 - 3, and 4 whose parent is 1.
class SlamGraphTest : public ::testing::Test {
 protected:
  SlamGraphTest() {
    for (std::size_t i = 0; i < steps_.size() + 1; ++i) {
      Keyframe keyframe;
      keyframe.features = std::vector<Feature>(1);
      keyframe.T_map_camera =
          i == 0 ? random_pose(1.0) : Pose(map_.keyframe(parent_[i - 1]).T_map_camera * steps_[i - 1]);
      const KeyframeId id = map_.add_keyframe(keyframe);
      map_.add_observation(map_.add_landmark(keyframe.T_map_camera * Eigen::Vector3d(0, 0, 2), 2.0), {id, 0});
      if (i == 0) {
        graph_.add_root();
        continue;
      }
      graph_.add_keyframe({parent_[i - 1], id, EdgeType::kOdometry, steps_[i - 1], covariance_.inverse()});
    }
  }
  Pose random_pose(double size) {
    Vector6d xi;
    for (double& x : xi) x = size * normal_(engine_);
    return geometry::se3_exp(xi);
  }
  static Matrix6d make_covariance() {
    Vector6d sigma;
    sigma << 0.01, 0.02, 0.015, 0.004, 0.002, 0.006;
    return sigma.cwiseAbs2().asDiagonal();
  }

  std::mt19937 engine_{3};
  std::normal_distribution<double> normal_{0.0, 1.0};
  std::vector<KeyframeId> parent_{0, 1, 2, 1};
  std::vector<Pose> steps_{random_pose(0.3), random_pose(0.3), random_pose(0.3), random_pose(0.3)};
  Matrix6d covariance_ = make_covariance();
  Map map_;
  SlamGraph graph_;
};

// 5 and 6 follow 3 by odometry alone.
class DriftingStretchTest : public SlamGraphTest {
 protected:
  DriftingStretchTest() {
    add(3, 5, EdgeType::kWheelOdometry);
    add(5, 6, EdgeType::kWheelOdometry);
  }
  void add(KeyframeId from, KeyframeId to, EdgeType type) {
    while (map_.keyframes().size() <= to) {
      Keyframe keyframe;
      keyframe.T_map_camera = map_.keyframe(from).T_map_camera * steps_[0];
      map_.add_keyframe(keyframe);
    }
    graph_.add_keyframe({from, to, type, steps_[0], covariance_.inverse()});
  }
  PoseGraphEdge edge(KeyframeId from, KeyframeId to, EdgeType type) const {
    return {from, to, type, map_.keyframe(from).T_map_camera.inverse() * map_.keyframe(to).T_map_camera,
            covariance_.inverse()};
  }
  // As an optimisation that moves nothing, and keeps what has this weight.
  void optimise(double weight_of_last = 1.0) {
    GraphCorrection correction;
    for (const Keyframe& keyframe : map_.keyframes()) correction.T_map_camera.push_back(keyframe.T_map_camera);
    correction.T_map_before = correction.T_map_camera;
    correction.weights.assign(graph_.edges().size(), 1.0);
    correction.weights.back() = weight_of_last;
    correction.marginals = graph_marginals(graph_.snapshot(map_, 1), correction.weights);
    graph_.apply(correction, map_);
  }
  std::vector<KeyframeId> drifting() const {
    std::vector<KeyframeId> ids;
    for (const auto& node : graph_.snapshot(map_, 1).nodes) {
      if (node.is_drifting) ids.push_back(node.id);
    }
    return ids;
  }
};

TEST_F(DriftingStretchTest, HangsOnOdometryUntilVisionTiesItToAnotherKeyframe) {
  EXPECT_EQ(drifting(), (std::vector<KeyframeId>{5, 6}));
  add(6, 7, EdgeType::kOdometry);
  EXPECT_EQ(drifting(), (std::vector<KeyframeId>{5}));
}

TEST_F(DriftingStretchTest, IsCorrectedByAnOptimisationOfTheCircleThatItLiesOn) {
  optimise();
  EXPECT_EQ(drifting(), (std::vector<KeyframeId>{5, 6})) << "there is no circle";
  add(2, 7, EdgeType::kOdometry);
  graph_.add_edge(edge(6, 7, EdgeType::kWheelOdometry));
  EXPECT_EQ(drifting(), (std::vector<KeyframeId>{5, 6})) << "nothing has corrected it yet";
  optimise();
  EXPECT_TRUE(drifting().empty());
}

TEST_F(DriftingStretchTest, PartsThatOdometryJoinsAreApartUntilTheirCircleIsOptimised) {
  add(6, 7, EdgeType::kOdometry);
  EXPECT_TRUE(graph_.are_apart(0, 7));
  EXPECT_TRUE(graph_.are_apart(7, 4));
  EXPECT_FALSE(graph_.are_apart(6, 7));
  EXPECT_FALSE(graph_.are_apart(0, 4));
  graph_.add_edge(edge(0, 7, EdgeType::kLoopClosure));
  EXPECT_TRUE(graph_.are_apart(0, 7));
  optimise();
  EXPECT_FALSE(graph_.are_apart(0, 7));
}

TEST_F(DriftingStretchTest, ALoopThatIsRemovedCorrectsNothing) {
  graph_.add_edge(edge(4, 6, EdgeType::kLoopClosure));
  optimise(0.0);
  EXPECT_EQ(drifting(), (std::vector<KeyframeId>{5, 6}));
  EXPECT_EQ(graph_.loops_removed(), 1u);
}

TEST_F(DriftingStretchTest, WhatARemovedLoopHasMadeSureOfIsForgotten) {
  const std::vector<Matrix6d> of_chain = graph_.covariances();
  graph_.add_edge(edge(4, 6, EdgeType::kLoopClosure));
  optimise();
  for (const KeyframeId id : {KeyframeId{5}, KeyframeId{6}}) {
    EXPECT_LT(graph_.covariance(id).trace(), 0.9 * of_chain[static_cast<std::size_t>(id)].trace()) << "the loop stays";
  }
  optimise(0.0);
  for (KeyframeId id = 1; id < 7; ++id) {
    EXPECT_TRUE(graph_.covariance(id).isApprox(of_chain[static_cast<std::size_t>(id)], 1e-6)) << id;
  }
}

TEST_F(DriftingStretchTest, IsRestoredWithTheGraph) {
  const SlamGraph restored(graph_.edges(), graph_.links(), graph_.covariances());
  for (KeyframeId id = 0; id < 7; ++id) EXPECT_EQ(restored.is_drifting(id), id >= 5) << id;
}

// Against the sample covariance of chains whose steps are disturbed.
TEST_F(SlamGraphTest, ChainCovarianceIsThatOfDisturbedChains) {
  const KeyframeId from = 3, to = 4;  // over their ancestor 1
  const Pose truth = map_.keyframe(from).T_map_camera.inverse() * map_.keyframe(to).T_map_camera;
  const Vector6d sigma = covariance_.diagonal().cwiseSqrt();
  const int samples = 40000;
  Matrix6d sum = Matrix6d::Zero();
  for (int k = 0; k < samples; ++k) {
    const auto disturbed = [&](std::size_t step) {
      Vector6d xi;
      for (int i = 0; i < 6; ++i) xi[i] = sigma[i] * normal_(engine_);
      return Pose(steps_[step] * geometry::se3_exp(xi));
    };
    const Pose sample = (disturbed(1) * disturbed(2)).inverse() * disturbed(3);
    const Vector6d error = geometry::se3_log(truth.inverse() * sample);
    sum += error * error.transpose() / samples;
  }
  const Matrix6d closed = graph_.chain_covariance(map_, from, to);
  EXPECT_LT((closed - sum).norm(), 0.03 * sum.norm());
  EXPECT_TRUE(closed.isApprox(closed.transpose()));
  EXPECT_TRUE(graph_.chain_covariance(map_, 2, 2).isZero());
  EXPECT_TRUE(graph_.chain_covariance(map_, 2, 3).isApprox(covariance_));
}

// 3 and 4 see 1 and each other: the graph has circles, and 5 and 6 are younger than its marginals.
TEST_F(DriftingStretchTest, RelativeCovariancesAreThoseOfTheWholeGraph) {
  EXPECT_TRUE(graph_.relative_covariance(map_, 3, 4).isApprox(graph_.chain_covariance(map_, 3, 4))) << "not analysed";
  graph_.add_edge(edge(1, 3, EdgeType::kWheelOdometry));
  graph_.add_edge(edge(3, 4, EdgeType::kWheelOdometry));
  const PoseGraphSnapshot whole = graph_.snapshot(map_, 1);
  PoseGraphSnapshot known = whole;
  known.nodes.resize(5);
  std::erase_if(known.edges, [](const PoseGraphEdge& e) { return e.to >= 5; });
  graph_.learn(map_, graph_marginals(known));
  EXPECT_EQ(graph_.analysed(), 5U);
  // Relative to `from`, which becomes the first node.
  const auto expected = [&](KeyframeId from, KeyframeId to) {
    PoseGraphSnapshot moved = whole;
    std::swap(moved.nodes[0], moved.nodes[static_cast<std::size_t>(from)]);
    return *graph_marginals(moved).covariances[to == 0 ? static_cast<std::size_t>(from) : static_cast<std::size_t>(to)];
  };
  for (const auto& [from, to] : std::vector<std::pair<KeyframeId, KeyframeId>>{{0, 4}, {2, 4}, {4, 1}, {3, 4}}) {
    EXPECT_TRUE(graph_.relative_covariance(map_, from, to).isApprox(expected(from, to), 1e-5)) << from << " " << to;
  }
  for (const auto& [from, to] : std::vector<std::pair<KeyframeId, KeyframeId>>{{2, 6}, {6, 1}}) {
    const Matrix6d exact = expected(from, to), told = graph_.relative_covariance(map_, from, to);
    EXPECT_GE(told.trace(), (1.0 - 1e-6) * exact.trace()) << "the way from the newest analysed one is by parents";
    EXPECT_LT(told.trace(), 3.0 * exact.trace());
  }
  EXPECT_TRUE(graph_.relative_covariance(map_, 5, 6).isApprox(graph_.chain_covariance(map_, 5, 6)));
}

// Without loops the covariance that grows along the chain is that of the whole graph.
TEST_F(SlamGraphTest, CovariancesAreThoseOfTheGraph) {
  const GraphMarginals all = graph_marginals(graph_.snapshot(map_, 0));
  for (KeyframeId id = 0; id < all.covariances.size(); ++id) {
    ASSERT_TRUE(all.covariances[id].has_value());
    EXPECT_LT((*all.covariances[id] - graph_.covariance(id)).norm(), 1e-6 * covariance_.norm()) << id;
  }
}

TEST_F(SlamGraphTest, YoungerKeyframesAndLandmarksFollowACorrection) {
  std::vector<Pose> before;
  std::vector<Eigen::Vector3d> seen;
  for (const Keyframe& keyframe : map_.keyframes()) {
    before.push_back(keyframe.T_map_camera);
    seen.push_back(keyframe.T_map_camera.inverse() * map_.landmark(keyframe.landmarks[0]).p_map);
  }
  GraphCorrection correction;  // knows the first three
  for (std::size_t i = 0; i < 3; ++i) {
    correction.T_map_before.push_back(before[i]);
    correction.T_map_camera.push_back(i == 0 ? before[0] : Pose(before[i] * random_pose(0.1)));
    correction.marginals.covariances.emplace_back(i == 0 ? Matrix6d::Zero() : Matrix6d(0.5 * covariance_));
    correction.marginals.with_newest.emplace_back(Matrix6d::Zero());
  }
  graph_.add_edge({0, 2, EdgeType::kLoopClosure, random_pose(1.0), Matrix6d::Identity()});
  graph_.add_edge({0, 3, EdgeType::kLoopClosure, random_pose(1.0), Matrix6d::Identity()});
  correction.weights = {1, 1, 1, 1, 0, 1};
  graph_.apply(correction, map_);
  for (KeyframeId id = 0; id < 3; ++id) {
    EXPECT_TRUE(map_.keyframe(id).T_map_camera.isApprox(correction.T_map_camera[id], 1e-12)) << id;
  }
  const auto step = [&](KeyframeId a, KeyframeId b) {
    return Pose(map_.keyframe(a).T_map_camera.inverse() * map_.keyframe(b).T_map_camera);
  };
  EXPECT_TRUE(step(2, 3).isApprox(steps_[2], 1e-9)) << "follows its parent";
  EXPECT_TRUE(step(1, 4).isApprox(steps_[3], 1e-9)) << "follows its parent";
  for (const Keyframe& keyframe : map_.keyframes()) {
    const Eigen::Vector3d p = keyframe.T_map_camera.inverse() * map_.landmark(keyframe.landmarks[0]).p_map;
    EXPECT_LT((p - seen[static_cast<std::size_t>(keyframe.id)]).norm(), 1e-9);
  }
  EXPECT_EQ(graph_.count(EdgeType::kLoopClosure), 1U) << "the outlier is gone";
  EXPECT_EQ(graph_.snapshot(map_, 7).edges.size(), 5U);
  EXPECT_TRUE(graph_.covariance(2).isApprox(0.5 * covariance_));
  EXPECT_TRUE(graph_.covariance(3).isApprox(compound_covariance(graph_.covariance(2), step(2, 3), covariance_)));
}

// A pose that a correction leaves alone is still multiplied by T T^-1, whose rounding must not pile up.
TEST_F(SlamGraphTest, AHundredCorrectionsLeaveTheFirstKeyframeWhereItIs) {
  const Pose first = map_.keyframe(0).T_map_camera;
  for (int k = 0; k < 100; ++k) {
    GraphCorrection correction;
    for (const Keyframe& keyframe : map_.keyframes()) correction.T_map_before.push_back(keyframe.T_map_camera);
    correction.T_map_camera = correction.T_map_before;
    correction.weights.assign(graph_.edges().size(), 1.0);
    graph_.apply(correction, map_);
  }
  EXPECT_TRUE(map_.keyframe(0).T_map_camera.isApprox(first, 1e-12));
}

TEST_F(SlamGraphTest, VisualEdgesFollowWhatBundleAdjustmentMoved) {
  map_.set_pose(3, map_.keyframe(3).T_map_camera * random_pose(0.01));
  graph_.follow(map_, {3});
  const auto edges = graph_.snapshot(map_, 0).edges;
  const Pose moved = map_.keyframe(2).T_map_camera.inverse() * map_.keyframe(3).T_map_camera;
  EXPECT_TRUE(edges[2].T_from_to.isApprox(moved, 1e-12));
  EXPECT_TRUE(edges[1].T_from_to.isApprox(steps_[1], 1e-12));
}

// A camera that goes round twice, recognises places of the first lap, and takes one for another.
class WrongLoopTest : public ::testing::Test {
 protected:
  static constexpr KeyframeId kLap = 40;
  static constexpr double kSigma_m = 0.005, kSigma_rad = 0.002;

  WrongLoopTest() {
    information_.diagonal() << Eigen::Vector3d::Constant(1.0 / (kSigma_m * kSigma_m)),
        Eigen::Vector3d::Constant(1.0 / (kSigma_rad * kSigma_rad));
    for (KeyframeId id = 0; id < 2 * kLap; ++id) {
      Keyframe keyframe;
      const Pose step = id > 0 ? measure(id - 1, id) : Pose::Identity();
      keyframe.T_map_camera = id > 0 ? Pose(map_.keyframe(id - 1).T_map_camera * step) : truth(0);
      map_.add_keyframe(keyframe);
      if (id == 0) graph_.add_root();
      if (id > 0) graph_.add_keyframe({id - 1, id, EdgeType::kOdometry, step, information_});
    }
    for (KeyframeId id = kLap + 5; id < 2 * kLap; id += 5) add_loop(id - kLap, id, measure(id - kLap, id));
  }

  static Pose truth(KeyframeId id) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(id) / kLap;
    Pose T = Pose::Identity();
    T.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    T.translation() = 3.0 * T.linear().col(2);
    return T;
  }
  Pose measure(KeyframeId from, KeyframeId to) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? kSigma_m : kSigma_rad) * normal_(engine_);
    return truth(from).inverse() * truth(to) * geometry::se3_exp(xi);
  }
  void add_loop(KeyframeId from, KeyframeId to, const Pose& T_from_to) {
    graph_.add_edge({from, to, EdgeType::kLoopClosure, T_from_to, information_});
  }
  static double worst_error_m(const PoseGraphSnapshot& graph) {
    double worst = 0.0;
    for (const PoseGraphNode& node : graph.nodes) {
      worst = std::max(worst, (node.T_map_camera.translation() - truth(node.id).translation()).norm());
    }
    return worst;
  }

  std::mt19937 engine_{5};
  std::normal_distribution<double> normal_{0.0, 1.0};
  Matrix6d information_ = Matrix6d::Zero();
  Map map_;
  SlamGraph graph_;
};

TEST_F(WrongLoopTest, DoesNotSurviveTheCorrection) {
  PoseGraphSnapshot clean = graph_.snapshot(map_, 0);
  optimize_pose_graph({}, clean);
  const std::size_t true_loops = graph_.count(EdgeType::kLoopClosure);
  const KeyframeId from = 10, to = kLap + 25;
  add_loop(from, to, measure(from, kLap + from));
  PoseGraphSnapshot trusting = graph_.snapshot(map_, 0);
  optimize_pose_graph({}, trusting);
  EXPECT_GT(worst_error_m(trusting), 0.5) << "it would do harm";

  DueResult<GraphCorrection> worker;
  worker.start(3, [graph = graph_.snapshot(map_, 0)] { return correct_graph(graph); });
  EXPECT_FALSE(worker.take(2).has_value());
  const auto correction = worker.take(3);
  ASSERT_TRUE(correction.has_value());
  graph_.apply(*correction, map_);
  const PoseGraphSnapshot corrected = graph_.snapshot(map_, 1);
  EXPECT_EQ(graph_.count(EdgeType::kLoopClosure), true_loops);
  for (const PoseGraphEdge& edge : corrected.edges) EXPECT_FALSE(edge.from == from && edge.to == to);
  for (std::size_t i = 0; i < clean.nodes.size(); ++i) {
    EXPECT_TRUE(corrected.nodes[i].T_map_camera.isApprox(clean.nodes[i].T_map_camera, 1e-4)) << i;
  }
  EXPECT_LT(worst_error_m(corrected), 0.1);
}

}  // namespace
}  // namespace lapis::slam
