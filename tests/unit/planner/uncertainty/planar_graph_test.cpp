#include "planner/core/uncertainty/planar_graph.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace lapis::planner {
namespace {

using geometry::Pose;

struct Graph {
  std::vector<Keyframe> keyframes;
  std::vector<KeyframeEdge> edges;
};

/// A camera that looks along the robot's heading, a little down.
Pose camera_at(double x, double y, double heading_rad) {
  Eigen::Matrix3d R_base_camera;
  R_base_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()) *
                            Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) * R_base_camera;
  return geometry::make_pose({x, y, 1.0}, Eigen::Quaterniond(R));
}

Information random_information(std::mt19937& random) {
  std::normal_distribution<double> n;
  Eigen::Matrix<double, 6, 6> root;
  for (int i = 0; i < 36; ++i) root(i) = n(random);
  return 100.0 * (root * root.transpose() + Eigen::Matrix<double, 6, 6>::Identity());
}

/// Round and round, with loops; ids have gaps.
Graph random_graph(int nodes, int loops) {
  std::mt19937 random(5);
  Graph graph;
  for (int i = 0; i < nodes; ++i) {
    const double angle = 0.4 * i;
    graph.keyframes.push_back(
        {10 + 3 * static_cast<std::uint64_t>(i), camera_at(4.0 * std::cos(angle), 3.0 * std::sin(angle), angle + 1.5)});
  }
  const auto add = [&](std::size_t a, std::size_t b, bool is_loop) {
    graph.edges.push_back({graph.keyframes[a].id, graph.keyframes[b].id, random_information(random), is_loop});
  };
  for (std::size_t i = 1; i < graph.keyframes.size(); ++i) add(i - 1, i, false);
  std::uniform_int_distribution<std::size_t> any(0, graph.keyframes.size() - 1);
  for (int i = 0; i < loops; ++i) {
    const std::size_t a = any(random), b = any(random);
    if (a != b) add(a, b, true);
  }
  return graph;
}

Pose moved(const Pose& pose, const Eigen::Vector3d& error) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(error.z(), Eigen::Vector3d::UnitZ()) * pose.linear());
  return geometry::make_pose(pose.translation() + Eigen::Vector3d(error.x(), error.y(), 0.0), turned);
}

/// The inverse of the whole matrix, its derivatives by differences.
Eigen::MatrixXd dense_covariance(const Graph& graph) {
  const auto size = 3 * std::ssize(graph.keyframes);
  const auto node_of = [&](std::uint64_t id) { return static_cast<std::size_t>((id - 10) / 3); };
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const KeyframeEdge& edge : graph.edges) {
    const std::size_t a = node_of(edge.from), b = node_of(edge.to);
    const Pose &T_a = graph.keyframes[a].T_map_camera, &T_b = graph.keyframes[b].T_map_camera;
    const Pose T_measured = T_a.inverse() * T_b;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, size);
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 1e-6;
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      const auto residual = [&](const Pose& T_map_a, const Pose& T_map_b) {
        return geometry::se3_log(T_measured.inverse() * T_map_a.inverse() * T_map_b);
      };
      J.col(static_cast<int>(3 * a) + axis) =
          (residual(moved(T_a, step), T_b) - residual(moved(T_a, -step), T_b)) / (2 * kStep);
      J.col(static_cast<int>(3 * b) + axis) =
          (residual(T_a, moved(T_b, step)) - residual(T_a, moved(T_b, -step))) / (2 * kStep);
    }
    information += J.transpose() * edge.information * J;
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  covariance.bottomRightCorner(size - 3, size - 3) = information.bottomRightCorner(size - 3, size - 3).inverse();
  return covariance;
}

PlanarGraph make(const Graph& graph) {
  auto made = PlanarGraph::make(graph.keyframes, graph.edges);
  if (const auto* error = std::get_if<GraphError>(&made)) throw std::runtime_error(error->message);
  return std::get<PlanarGraph>(std::move(made));
}

TEST(PlanarGraph, AgreesWithTheInverseOfTheWholeMatrix) {
  for (const auto& [nodes, loops] : {std::pair(2, 0), {30, 0}, {40, 25}}) {
    const Graph graph = random_graph(nodes, loops);
    const PlanarGraph planar = make(graph);
    const Eigen::MatrixXd expected = dense_covariance(graph);
    const auto marginals = planar.marginals();
    ASSERT_EQ(marginals.size(), graph.keyframes.size());
    for (int i = 0; i < nodes; ++i)
      EXPECT_TRUE(marginals[index(i)].isApprox(expected.block<3, 3>(3 * i, 3 * i), 1e-6) || i == 0) << i;
    EXPECT_EQ(marginals[0], Eigen::Matrix3d::Zero());
    for (const int node : {0, nodes / 2}) {
      const Eigen::MatrixX3d columns = planar.columns(node);
      EXPECT_LT((columns - expected.middleCols<3>(3 * node)).norm(), 1e-6 * expected.norm()) << node;
    }
    const std::vector<int> some{nodes - 1, 0, nodes / 2, nodes - 1};
    const Eigen::MatrixXd joint = planar.covariance(some);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const Eigen::Matrix3d block = expected.block<3, 3>(3 * some[index(i)], 3 * some[index(j)]);
        EXPECT_TRUE((joint.block<3, 3>(3 * i, 3 * j) - block).norm() < 1e-6 * expected.norm()) << i << " " << j;
      }
    }
  }
}

// A chain of equal edges whose headings are sure: variances add.
TEST(PlanarGraph, AddsUpTheEdgesOfAChain) {
  Graph graph;
  for (std::uint64_t i = 0; i < 5; ++i) graph.keyframes.push_back({i, camera_at(static_cast<double>(i), 0.0, 0.0)});
  Information information = Information::Identity(6, 6) * 400.0;
  information(4, 4) = 1e14;  // the turn about the vertical, but for the camera's tilt
  information(3, 3) = information(5, 5) = 1e14;
  for (std::uint64_t i = 1; i < 5; ++i) graph.edges.push_back({i - 1, i, information, false});
  const auto marginals = make(graph).marginals();
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(marginals[i](0, 0), 0.0025 * static_cast<double>(i), 1e-8) << i;
}

TEST(PlanarGraph, KeepsWhatHangsTogetherWithTheNewest) {
  Graph graph = random_graph(20, 0);
  std::erase_if(graph.edges, [](const KeyframeEdge& edge) { return edge.from == 10 + 3 * 7; });
  const PlanarGraph planar = make(graph);
  EXPECT_EQ(planar.keyframes().size(), 12U);
  EXPECT_EQ(planar.keyframes().front().id, 10U + 3 * 8);
}

TEST(PlanarGraph, SaysWhatIsWrong) {
  const auto message = [](const Graph& graph) {
    const auto made = PlanarGraph::make(graph.keyframes, graph.edges);
    const auto* error = std::get_if<GraphError>(&made);
    return error != nullptr ? error->message : std::string();
  };
  EXPECT_EQ(message({}), "fewer than two connected key-frames");
  Graph graph = random_graph(5, 0);
  graph.keyframes.erase(graph.keyframes.begin() + 2);
  EXPECT_EQ(message(graph), "an edge names a key-frame that is not there");
}

}  // namespace
}  // namespace lapis::planner
