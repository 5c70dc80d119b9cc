// Wrong loop closures in graphs as a robot builds them.
#include <gtest/gtest.h>
#include <algorithm>
#include <ctime>
#include <iostream>
#include <iterator>
#include <numbers>
#include <random>

#include "slam/core/graph/graduated_weights.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_optimizer.hpp"
#include "tests/unit/slam/wrong_loops.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

/// Two laps of a circle with honest information: odometry (1 cm, 3 mrad a step) and a loop closure every `period` nodes
/// of the second lap; poses are reckoned from odometry.
struct Laps {
  PoseGraphSnapshot graph;
  std::vector<Eigen::Vector3d> truth;
  std::mt19937 random;
  std::normal_distribution<double> normal;

  Laps(int nodes_per_lap, int period, unsigned seed) : random(seed) {
    const int nodes = 2 * nodes_per_lap;
    std::vector<Pose> poses;
    for (int i = 0; i < nodes; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / nodes_per_lap;
      poses.push_back(geometry::make_pose(0.05 * nodes_per_lap * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0),
                                          Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()))));
      truth.emplace_back(poses.back().translation());
      graph.nodes.push_back({static_cast<std::uint64_t>(i), {}, poses.front()});
    }
    for (int i = 0; i < nodes; ++i) {
      if (i > 0) add(poses, i - 1, i, EdgeType::kOdometry);
      if (i > nodes_per_lap && i % period == 0) add(poses, i - nodes_per_lap, i, EdgeType::kLoopClosure);
    }
    initialize_by_spanning_tree(graph);
  }

  void add(const std::vector<Pose>& poses, int from, int to, EdgeType type) {
    Vector6d xi;
    for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? 0.01 : 0.003) * normal(random);
    Matrix6d information = Matrix6d::Identity() / (0.01 * 0.01);
    information.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / (0.003 * 0.003);
    const Pose& T_from = poses[static_cast<std::size_t>(from)];
    const Pose& T_to = poses[static_cast<std::size_t>(to)];
    graph.edges.push_back({static_cast<std::uint64_t>(from), static_cast<std::uint64_t>(to), type,
                           T_from.inverse() * T_to * geometry::se3_exp(xi), information});
  }
};

TEST(RobustOptimizer, KeepsEveryTrueLoopClosure) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Laps laps(100, 5, seed);
    const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, laps.graph);
    EXPECT_TRUE(report.has_converged);
    // The gate lets 99 % pass.
    EXPECT_LE(std::count(report.weights.begin(), report.weights.end(), 0.0), 1) << seed;
  }
}

TEST(RobustOptimizer, OneTrueLoopClosureAfterALongPathIsTaken) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Laps laps(150, 149, seed);
    PoseGraphSnapshot plain = laps.graph;
    optimize_pose_graph({}, plain);
    const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, laps.graph);
    EXPECT_EQ(report.weights, std::vector<double>(laps.graph.edges.size(), 1.0)) << seed;
    for (std::size_t i = 0; i < plain.nodes.size(); ++i) {
      EXPECT_TRUE(laps.graph.nodes[i].T_map_camera.isApprox(plain.nodes[i].T_map_camera, 1e-4));
    }
  }
}

TEST(RobustOptimizer, WrongLoopClosuresLoseTheirWeight) {
  for (const double share : {0.1, 0.2, 0.3}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      Laps laps(100, 5, seed);
      PoseGraphSnapshot clean = laps.graph;
      optimize_pose_graph({}, clean);
      const std::size_t first_wrong = laps.graph.edges.size();
      test::add_wrong_loops(laps.graph, share, seed);
      const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, laps.graph);
      EXPECT_LT(test::trajectory_error_m(laps.graph, laps.truth), 1.5 * test::trajectory_error_m(clean, laps.truth))
          << share << " " << seed;
      const auto begin = report.weights.begin() + static_cast<std::ptrdiff_t>(first_wrong);
      EXPECT_EQ(std::count(begin, report.weights.end(), 0.0), report.weights.end() - begin) << share << " " << seed;
    }
  }
}

// Odometry with a sigma of 25 mrad over a blind stretch, in which it is off by five of them, bends least squares.
TEST(RobustOptimizer, SlipDoesNotBendTheGraph) {
  constexpr std::size_t kBlind = 50;
  constexpr double kSigma_rad = 0.025;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Laps laps(100, 5, seed);
    PoseGraphEdge& wheels = laps.graph.edges[kBlind];
    wheels.type = EdgeType::kWheelOdometry;
    wheels.information.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / (kSigma_rad * kSigma_rad);
    PoseGraphSnapshot clean = laps.graph;
    const Vector6d slip = (Vector6d() << 0.0, 0.0, 0.0, 0.0, 0.0, 5.0 * kSigma_rad).finished();
    wheels.T_from_to = wheels.T_from_to * geometry::se3_exp(slip);
    PoseGraphSnapshot bent = laps.graph;
    optimize_pose_graph({}, clean);
    optimize_pose_graph({}, bent);
    const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, laps.graph);
    const auto turned_rad = [&](const PoseGraphSnapshot& graph) {
      double most_rad = 0.0;
      for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const Pose off = clean.nodes[i].T_map_camera.inverse() * graph.nodes[i].T_map_camera;
        most_rad = std::max(most_rad, geometry::rotation_angle(off.linear()));
      }
      return most_rad;
    };
    EXPECT_LT(turned_rad(laps.graph), 0.6 * turned_rad(bent)) << seed;
    EXPECT_LT(report.weights[kBlind], 0.5) << seed;
    EXPECT_GT(report.weights[kBlind], 0.0) << "nothing else holds the graph together if the loop closures are wrong";
  }
}

// Nothing says which of two motions alike is wrong.
TEST(RobustOptimizer, TwoMotionsThatAreOffAlikeShareTheBlame) {
  PoseGraphSnapshot graph;
  for (std::uint64_t i = 0; i < 3; ++i) graph.nodes.push_back({i, {}, Pose::Identity()});
  const Pose turned = geometry::se3_exp((Vector6d() << 0.0, 0.0, 0.0, 0.0, 0.0, 0.1).finished());
  const Matrix6d information = 1e4 * Matrix6d::Identity();
  graph.edges = {{0, 1, EdgeType::kWheelOdometry, turned, information},
                 {1, 2, EdgeType::kWheelOdometry, turned, information},
                 {0, 2, EdgeType::kCovisibility, Pose::Identity(), 100.0 * information}};
  optimize_pose_graph({100, 1e-6, true}, graph);
  EXPECT_LT(geometry::rotation_angle(graph.nodes[1].T_map_camera.linear()), 0.01);
}

// As slam does it: the map has been optimised before, some loop closures are new, one of them is wrong.
TEST(RobustOptimizer, IsFastFromGoodPoses) {
  Laps laps(500, 2, 1);
  std::vector<PoseGraphEdge> late;
  auto& edges = laps.graph.edges;
  late.assign(edges.end() - 8, edges.end());
  edges.resize(edges.size() - 8);
  optimize_pose_graph({}, laps.graph);
  edges.insert(edges.end(), late.begin(), late.end());
  PoseGraphEdge wrong = edges.back();
  wrong.type = EdgeType::kLoopClosure;
  wrong.from = 100;
  wrong.to = 700;
  edges.push_back(wrong);
  PoseGraphSnapshot graph = laps.graph;
  const std::clock_t begin = std::clock();
  const OptimizerReport report = optimize_pose_graph({100, 1e-6, true}, graph);
  std::cout << graph.nodes.size() << " nodes, " << edges.size()
            << " edges, one wrong: " << 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC << " ms CPU, "
            << report.iterations << " iterations\n";
  EXPECT_EQ(report.weights.back(), 0.0);
  EXPECT_LE(std::count(report.weights.begin(), report.weights.end(), 0.0), 6);
  EXPECT_LT(report.iterations, 60);
}

TEST(GraduatedWeights, EndWithTruncatedLeastSquares) {
  GraduatedWeights graduated({0, 2}, chi2_gate(6));
  std::vector<double> weights = {1.0, 1.0, 1.0};
  const std::vector<double> chi2 = {16.0, 1e6, 17.6};
  int rounds = 0;
  while (graduated.update(chi2, weights)) ASSERT_LT(++rounds, 200);
  EXPECT_TRUE(graduated.is_final());
  EXPECT_EQ(weights, (std::vector<double>{1.0, 1.0, 0.0}));
}

TEST(GraduatedWeights, GrowApartFromNearlyEqual) {
  GraduatedWeights graduated({0, 1}, chi2_gate(6));
  std::vector<double> weights = {1.0, 1.0};
  ASSERT_TRUE(graduated.update({1.0, 1e4}, weights));
  EXPECT_GT(weights[1], 0.0);
  EXPECT_GT(weights[0], weights[1]);
  GraduatedWeights all_fit({0, 1}, chi2_gate(6));
  EXPECT_FALSE(all_fit.update({1.0, 16.0}, weights));
}

}  // namespace
}  // namespace lapis::slam
