#include "slam/core/graph/pose_graph_optimizer.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>

#include "slam/core/graph/block_cholesky.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/pose_graph_initialization.hpp"
#include "slam/core/graph/pose_graph_space.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  std::size_t below(std::size_t n) { return engine_() % n; }
  Vector6d vector(double metres, double radians) {
    Vector6d v;
    v << metres * normal(), metres * normal(), metres * normal(), radians * normal(), radians * normal(),
        radians * normal();
    return v;
  }
  Matrix6d information() {
    const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(); });
    return 100.0 * (root * root.transpose() + Matrix6d::Identity());
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

Pose planar(const Vector6d& v) {
  return geometry::make_pose({v[0], v[1], 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(v[5], Eigen::Vector3d::UnitZ())));
}

PoseGraphEdge measured(const PoseGraphSnapshot& truth, std::size_t from, std::size_t to, EdgeType type, Random& random,
                       double noise) {
  const Matrix6d information = random.information();
  const Matrix6d root = information.inverse().llt().matrixL();
  const Vector6d xi = noise * root * random.vector(1.0, 1.0);
  const Pose error = truth.is_planar ? planar(xi) : geometry::se3_exp(xi);
  return {truth.nodes[from].id, truth.nodes[to].id, type,
          truth.nodes[from].T_map_camera.inverse() * truth.nodes[to].T_map_camera * error, information};
}

/// True poses, odometry along them, and loop closures; ids with gaps. `noise` scales the errors of the edges.
PoseGraphSnapshot make_graph(int nodes, int loops, bool is_planar, double noise, unsigned seed) {
  Random random(seed);
  PoseGraphSnapshot graph;
  graph.is_planar = is_planar;
  Pose T = Pose::Identity();
  for (int i = 0; i < nodes; ++i) {
    graph.nodes.push_back({static_cast<std::uint64_t>(10 * i + 3), {}, T});
    const Vector6d motion = random.vector(1.0, 0.4);
    T = T * (is_planar ? planar(motion) : geometry::se3_exp(motion));
  }
  const auto count = static_cast<std::size_t>(nodes);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    graph.edges.push_back(measured(graph, i, i + 1, EdgeType::kOdometry, random, noise));
  }
  for (int k = 0; k < loops; ++k) {
    const std::size_t a = random.below(count), b = (a + 2 + random.below(count - 2)) % count;
    graph.edges.push_back(measured(graph, a, b, EdgeType::kLoopClosure, random, noise));
  }
  return graph;
}

void disturb(PoseGraphSnapshot& graph, double size, unsigned seed) {
  Random random(seed);
  for (PoseGraphNode& node : graph.nodes) {
    const Vector6d xi = random.vector(size, size);
    node.T_map_camera = node.T_map_camera * (graph.is_planar ? planar(xi) : geometry::se3_exp(xi));
  }
}

double distance(const Pose& a, const Pose& b) { return geometry::se3_log(a.inverse() * b).norm(); }

template <class Space>
void check_jacobians(const Pose& from, const Pose& to, const Pose& z) {
  using Matrix = typename Space::Matrix;
  const auto a = Space::from_pose(from), b = Space::from_pose(to), measurement = Space::from_pose(z);
  Matrix by_to, numeric_to, numeric_from;
  const typename Space::Vector e = Space::residual(a, b, measurement, by_to);
  EXPECT_TRUE(e.isApprox(Space::residual(a, b, measurement), 1e-12));
  constexpr double kStep = 1e-6;
  for (int i = 0; i < Space::kDof; ++i) {
    const typename Space::Vector step = kStep * Space::Vector::Unit(i);
    const auto moved = [&](auto pose, double sign) {
      Space::move(pose, sign * step);
      return pose;
    };
    numeric_to.col(i) =
        (Space::residual(a, moved(b, 1), measurement) - Space::residual(a, moved(b, -1), measurement)) / (2 * kStep);
    numeric_from.col(i) =
        (Space::residual(moved(a, 1), b, measurement) - Space::residual(moved(a, -1), b, measurement)) / (2 * kStep);
  }
  EXPECT_LT((by_to - numeric_to).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((-by_to * Space::lever(a, b) - numeric_from).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(PoseGraphSpace, JacobiansAreThoseOfDifferences) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector6d a = random.vector(5.0, 1.0), b = random.vector(5.0, 1.0), z = random.vector(5.0, 0.5);
    check_jacobians<SpatialPoses>(geometry::se3_exp(a), geometry::se3_exp(b), geometry::se3_exp(z));
    check_jacobians<PlanarPoses>(planar(a), planar(b), planar(z));
  }
}

TEST(PoseGraphSpace, PosesComeBack) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6d xi = random.vector(5.0, 1.0);
    EXPECT_LT(distance(SpatialPoses::to_pose(SpatialPoses::from_pose(geometry::se3_exp(xi))), geometry::se3_exp(xi)),
              1e-9);
    EXPECT_LT(distance(PlanarPoses::to_pose(PlanarPoses::from_pose(planar(xi))), planar(xi)), 1e-9);
  }
}

TEST(BlockCholesky, SolvesWhatADenseSolverSolves) {
  Random random(3);
  const int blocks = 12;
  std::vector<BlockPair> pairs;
  for (int i = 0; i < 25; ++i) {
    const auto a = static_cast<int>(random.below(blocks));
    pairs.emplace_back(a, (a + 1 + static_cast<int>(random.below(blocks - 1))) % blocks);
  }
  BlockCholesky sparse(3, elimination_order(blocks, pairs), pairs);
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * blocks, 3 * blocks);
    sparse.set_zero();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto [a, b] = pairs[k];
      const Eigen::Matrix3d value = Eigen::Matrix3d::NullaryExpr([&] { return random.normal(); });
      sparse.add_pair(k, value);
      dense.block<3, 3>(3 * a, 3 * b) += value;
      dense.block<3, 3>(3 * b, 3 * a) += value.transpose();
    }
    EXPECT_FALSE(sparse.factorize(0.0));  // a diagonal of zeros
    for (int i = 0; i < blocks; ++i) {
      Eigen::Matrix3d value = Eigen::Matrix3d::NullaryExpr([&] { return random.normal(); });
      value = value * value.transpose() + 100.0 * Eigen::Matrix3d::Identity();
      sparse.add_diagonal(i, value);
      dense.block<3, 3>(3 * i, 3 * i) += value;
    }
    const Eigen::MatrixXd right = Eigen::MatrixXd::NullaryExpr(3 * blocks, 2, [&] { return random.normal(); });
    ASSERT_TRUE(sparse.factorize(0.0));
    EXPECT_TRUE(sparse.solve(right).isApprox(dense.llt().solve(right), 1e-10));
    ASSERT_TRUE(sparse.factorize(0.5));
    dense.diagonal() *= 1.5;
    EXPECT_TRUE(sparse.solve(right).isApprox(dense.llt().solve(right), 1e-10));
  }
}

/// Gauss-Newton with dense equations and differences, right perturbation se3_exp: everything but the residual apart.
PoseGraphSnapshot brute_force(PoseGraphSnapshot graph, Eigen::MatrixXd* hessian = nullptr) {
  const auto index = [&](std::uint64_t id) { return static_cast<Eigen::Index>(id / 10); };
  const auto residual = [&](const PoseGraphEdge& edge) {
    const Pose E = edge.T_from_to.inverse() * graph.nodes[edge.from / 10].T_map_camera.inverse() *
                   graph.nodes[edge.to / 10].T_map_camera;
    Vector6d e;
    e << E.translation(), 2.0 * geometry::unit_quaternion(E).vec();
    return e;
  };
  const Eigen::Index size = 6 * std::ssize(graph.nodes);
  for (int iteration = 0; iteration < 15; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
    for (const PoseGraphEdge& edge : graph.edges) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, size);
      for (const std::uint64_t id : {edge.from, edge.to}) {
        Pose& T = graph.nodes[id / 10].T_map_camera;
        const Pose before = T;
        for (int i = 0; i < 6; ++i) {
          constexpr double kStep = 1e-6;
          T = before * geometry::se3_exp(kStep * Vector6d::Unit(i));
          const Vector6d plus = residual(edge);
          T = before * geometry::se3_exp(-kStep * Vector6d::Unit(i));
          J.col(6 * index(id) + i) = (plus - residual(edge)) / (2.0 * kStep);
        }
        T = before;
      }
      H += J.transpose() * edge.information * J;
      g += J.transpose() * edge.information * residual(edge);
    }
    const Eigen::VectorXd step = -H.bottomRightCorner(size - 6, size - 6).ldlt().solve(g.tail(size - 6));
    for (std::size_t i = 1; i < graph.nodes.size(); ++i) {
      graph.nodes[i].T_map_camera =
          graph.nodes[i].T_map_camera * geometry::se3_exp(step.segment<6>(6 * static_cast<Eigen::Index>(i - 1)));
    }
    if (hessian != nullptr) *hessian = H;
  }
  return graph;
}

TEST(PoseGraphOptimizer, FindsTheOptimumOfDenseBruteForce) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    PoseGraphSnapshot graph = make_graph(8, 6, false, 1.0, seed);
    const PoseGraphSnapshot expected = brute_force(graph);
    disturb(graph, 0.1, seed);
    const double before = pose_graph_chi2(graph);
    const OptimizerReport report = optimize_pose_graph({100, 1e-12, false}, graph);
    EXPECT_TRUE(report.has_converged);
    EXPECT_DOUBLE_EQ(report.initial_chi2, before);
    EXPECT_NEAR(report.final_chi2, pose_graph_chi2(graph), 1e-9 * report.final_chi2);
    // The first node has been disturbed too: relative to it the poses are those of the brute force.
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
      EXPECT_LT(distance(graph.nodes[0].T_map_camera.inverse() * graph.nodes[i].T_map_camera,
                         expected.nodes[0].T_map_camera.inverse() * expected.nodes[i].T_map_camera),
                1e-6);
    }
    EXPECT_EQ(report.weights, std::vector<double>(graph.edges.size(), 1.0));
  }
}

TEST(GraphMarginals, AreBlocksOfTheInverseOfTheDenseInformation) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Eigen::MatrixXd H;
    const PoseGraphSnapshot graph = brute_force(make_graph(12, static_cast<int>(3 * seed), false, 0.3, seed), &H);
    const Eigen::MatrixXd covariance = H.bottomRightCorner(66, 66).inverse();
    const GraphMarginals marginals = graph_marginals(graph);
    ASSERT_EQ(marginals.covariances.size(), 12U);
    EXPECT_EQ(marginals.covariances[0], Matrix6d::Zero());
    for (Eigen::Index i = 1; i < 12; ++i) {
      const auto& one = marginals.covariances[static_cast<std::size_t>(i)];
      ASSERT_TRUE(one);
      EXPECT_TRUE(one->isApprox(covariance.block<6, 6>(6 * (i - 1), 6 * (i - 1)), 1e-5));
      EXPECT_TRUE(
          marginals.with_newest[static_cast<std::size_t>(i)].isApprox(covariance.block<6, 6>(6 * (i - 1), 60), 1e-5));
    }
    EXPECT_TRUE(marginals.with_newest[11].isApprox(*marginals.covariances[11], 1e-9))
        << "two ways to the same block: the selected inverse and a solution";
  }
}

std::optional<Matrix6d> covariance_of(const PoseGraphSnapshot& graph, std::size_t node,
                                      const std::vector<double>& weights = {}) {
  return graph_marginals(graph, weights).covariances[node];
}

TEST(GraphMarginals, NeedWeightedEdges) {
  PoseGraphSnapshot graph = make_graph(4, 0, false, 0.0, 8);
  const Matrix6d of_one_edge = graph.edges[0].information.inverse();
  EXPECT_TRUE(covariance_of(graph, 1)->isApprox(of_one_edge, 1e-9));
  EXPECT_TRUE(covariance_of(graph, 1, {0.5, 1.0, 1.0})->isApprox(2.0 * of_one_edge, 1e-9));
  EXPECT_FALSE(covariance_of(graph, 3, {1.0, 0.0, 1.0}));
  EXPECT_TRUE(covariance_of(graph, 1, {1.0, 0.0, 1.0})->isApprox(of_one_edge, 1e-9));
  EXPECT_TRUE(graph_marginals(graph, {1.0, 0.0, 1.0}).with_newest[1].isZero());
  EXPECT_TRUE(graph_marginals({}).covariances.empty());
}

TEST(PoseGraphOptimizer, EveryPartKeepsItsFirstNode) {
  PoseGraphSnapshot graph = make_graph(10, 8, false, 0.5, 9);
  std::erase_if(graph.edges, [](const PoseGraphEdge& e) { return (e.from < 60) != (e.to < 60); });
  disturb(graph, 0.05, 9);
  const PoseGraphSnapshot before = graph;
  EXPECT_TRUE(optimize_pose_graph({}, graph).has_converged);
  EXPECT_TRUE(graph.nodes[0].T_map_camera.isApprox(before.nodes[0].T_map_camera, 0.0));
  EXPECT_TRUE(graph.nodes[6].T_map_camera.isApprox(before.nodes[6].T_map_camera, 0.0));
  EXPECT_GT(distance(graph.nodes[5].T_map_camera, before.nodes[5].T_map_camera), 1e-6);
  EXPECT_TRUE(covariance_of(graph, 5));
  EXPECT_FALSE(covariance_of(graph, 7));
}

TEST(PoseGraphOptimizer, RefusesEdgesWithoutNodes) {
  PoseGraphSnapshot graph = make_graph(3, 0, false, 0.0, 10);
  graph.edges[1].to = 77;
  EXPECT_THROW(optimize_pose_graph({}, graph), std::invalid_argument);
  graph.edges[1].to = graph.edges[1].from;
  EXPECT_THROW(optimize_pose_graph({}, graph), std::invalid_argument);
  PoseGraphSnapshot empty;
  EXPECT_TRUE(optimize_pose_graph({}, empty).has_converged);
}

TEST(PoseGraphOptimizer, EdgesWithoutInformationDoNoHarm) {
  PoseGraphSnapshot graph = make_graph(5, 2, false, 0.5, 11);
  for (PoseGraphEdge& edge : graph.edges) edge.information.setZero();
  const PoseGraphSnapshot before = graph;
  EXPECT_EQ(optimize_pose_graph({}, graph).final_chi2, 0.0);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    EXPECT_LT(distance(graph.nodes[i].T_map_camera, before.nodes[i].T_map_camera), 1e-9);
  }
  EXPECT_FALSE(covariance_of(graph, 1));
}

TEST(PoseGraphOptimizer, SameInputSameBytes) {
  PoseGraphSnapshot a = make_graph(40, 30, false, 1.0, 12), b = a;
  optimize_pose_graph({100, 1e-6, true}, a);
  optimize_pose_graph({100, 1e-6, true}, b);
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].T_map_camera.matrix(), b.nodes[i].T_map_camera.matrix());
  }
}

TEST(Initialization, ExactEdgesGiveExactPoses) {
  for (const bool is_planar : {false, true}) {
    const PoseGraphSnapshot truth = make_graph(30, 20, is_planar, 0.0, 13);
    for (const auto initialize : {initialize_by_spanning_tree, initialize_by_chordal_relaxation}) {
      PoseGraphSnapshot graph = truth;
      graph.nodes.resize(1);
      EXPECT_EQ(add_missing_nodes(graph), 29U);
      initialize(graph);
      for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
        EXPECT_LT(distance(graph.nodes[i].T_map_camera, truth.nodes[i].T_map_camera), 1e-6);
      }
    }
  }
}

TEST(Initialization, NoisyPlanarGraphsConvergeFromIt) {
  PoseGraphSnapshot graph = make_graph(60, 60, true, 1.0, 14);
  const double of_truth = pose_graph_chi2(graph);
  for (PoseGraphNode& node : graph.nodes) node.T_map_camera = Pose::Identity();
  initialize_poses(graph);
  const OptimizerReport report = optimize_pose_graph({}, graph);
  EXPECT_TRUE(report.has_converged);
  EXPECT_LT(report.final_chi2, of_truth);
}

TEST(Initialization, LoopClosuresOfFilesAreEdgesBetweenNodesThatDoNotFollowOneAnother) {
  PoseGraphSnapshot graph;
  for (const auto& [from, to] :
       {std::pair(0, 1), {5, 4}, {5, 1'000'006}, {1'000'006, 1'000'007}, {1, 4}, {2, 4}, {1'000'007, 5}}) {
    graph.edges.push_back({static_cast<std::uint64_t>(from), static_cast<std::uint64_t>(to)});
  }
  graph.nodes.push_back({3, {}, Pose::Identity()});
  mark_loop_closures(graph);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const auto expected = i < 4 ? EdgeType::kOdometry : EdgeType::kLoopClosure;
    EXPECT_EQ(graph.edges[i].type, expected) << graph.edges[i].from << " to " << graph.edges[i].to;
  }
}

}  // namespace
}  // namespace lapis::slam
