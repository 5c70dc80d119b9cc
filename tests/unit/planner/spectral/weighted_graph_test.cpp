#include "planner/core/spectral/weighted_graph.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "common/geometry/se3.hpp"

namespace lapis::planner {
namespace {

std::string error_of(int node_count, const std::vector<WeightedEdge>& edges) {
  const auto result = WeightedGraph::make(node_count, edges);
  const auto* error = std::get_if<GraphError>(&result);
  return error == nullptr ? "" : error->message;
}

KeyframeEdge keyframe_edge(std::uint64_t from, std::uint64_t to, double information) {
  return {from, to, information * geometry::Matrix6d::Identity()};
}

TEST(EdgeWeight, IsTheMeanOfTheEigenvaluesThatTheCriterionNames) {
  geometry::Vector6d eigenvalues;
  eigenvalues << 1.0, 2.0, 4.0, 8.0, 16.0, 32.0;
  const geometry::Matrix6d Q =
      Eigen::HouseholderQR<geometry::Matrix6d>(geometry::Matrix6d::Identity() + geometry::Matrix6d::Ones())
          .householderQ();
  geometry::Matrix6d information = Q * eigenvalues.asDiagonal() * Q.transpose();
  information = 0.5 * (information + information.transpose()).eval();
  EXPECT_NEAR(*edge_weight(information, Criterion::kD), std::pow(2.0, 2.5), 1e-12);
  EXPECT_NEAR(*edge_weight(information, Criterion::kA), 6.0 / (63.0 / 32.0), 1e-12);
  EXPECT_NEAR(*edge_weight(information, Criterion::kT), 63.0 / 6.0, 1e-12);
  EXPECT_NEAR(*edge_weight(information, Criterion::kE), 1.0, 1e-12);
}

TEST(EdgeWeight, OfDOptimalityDoesNotDependOnTheFrame) {
  const geometry::Pose T = geometry::se3_exp((geometry::Vector6d() << 3.0, -2.0, 5.0, 0.4, 1.0, -0.3).finished());
  geometry::Vector6d diagonal;
  diagonal << 100.0, 50.0, 20.0, 400.0, 900.0, 300.0;
  const geometry::Matrix6d information = diagonal.asDiagonal();
  const geometry::Matrix6d moved = geometry::adjoint(T).transpose() * information * geometry::adjoint(T);
  const double weight = *edge_weight(information, Criterion::kD);
  EXPECT_NEAR(*edge_weight(moved, Criterion::kD), weight, 1e-9 * weight);
}

TEST(EdgeWeight, IsNothingWhereTheInformationIsNotPositiveDefinite) {
  geometry::Matrix6d information = geometry::Matrix6d::Identity();
  for (const Criterion criterion : {Criterion::kD, Criterion::kA, Criterion::kT, Criterion::kE}) {
    EXPECT_TRUE(edge_weight(information, criterion));
    information(5, 5) = 0.0;
    EXPECT_FALSE(edge_weight(information, criterion));
    information(5, 5) = -1.0;
    EXPECT_FALSE(edge_weight(information, criterion));
    information(5, 5) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(edge_weight(information, criterion));
    information(5, 5) = 1.0;
  }
  information(0, 1) = 0.5;
  EXPECT_FALSE(edge_weight(information, Criterion::kD)) << "not symmetric";
}

TEST(WeightedGraph, AddsParallelEdges) {
  const auto result = WeightedGraph::make(3, {{2, 1, 1.0}, {0, 1, 2.0}, {1, 2, 3.0}, {1, 0, 4.0}});
  const auto& edges = std::get<WeightedGraph>(result).edges();
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(std::tuple(edges[0].a, edges[0].b, edges[0].weight), std::tuple(0, 1, 6.0));
  EXPECT_EQ(std::tuple(edges[1].a, edges[1].b, edges[1].weight), std::tuple(1, 2, 4.0));
}

TEST(WeightedGraph, NamesWhatIsWrong) {
  EXPECT_EQ(error_of(1, {}), "");
  EXPECT_EQ(error_of(0, {}), "the graph has no node");
  EXPECT_EQ(error_of(2, {{0, 1, 0.0}}), "the weight of an edge is not positive and finite");
  EXPECT_EQ(error_of(2, {{0, 1, -2.5}}), "the weight of an edge is not positive and finite");
  EXPECT_NE(error_of(2, {{0, 1, std::numeric_limits<double>::quiet_NaN()}}), "");
  EXPECT_NE(error_of(2, {{0, 1, std::numeric_limits<double>::infinity()}}), "");
  EXPECT_EQ(error_of(2, {{0, 2, 1.0}}), "an edge names a node that is not there");
  EXPECT_EQ(error_of(2, {{-1, 0, 1.0}}), "an edge names a node that is not there");
  EXPECT_EQ(error_of(2, {{1, 1, 1.0}}), "an edge joins a node to itself");
  EXPECT_EQ(error_of(4, {{0, 1, 1.0}, {2, 3, 1.0}}), "the graph is not connected");
}

TEST(ComponentOf, LeavesOutWhatDoesNotHangTogetherWithTheKeyframe) {
  // 10-20-30 and, apart, 15-40, of which 40 is stale and without information.
  const std::vector<KeyframeEdge> edges{keyframe_edge(30, 20, 4.0), keyframe_edge(15, 40, 0.0),
                                        keyframe_edge(10, 20, 2.0), keyframe_edge(20, 30, 1.0)};
  const auto result = component_of(30, edges, Criterion::kD);
  const auto& component = std::get<KeyframeGraph>(result);
  EXPECT_EQ(component.keyframes, (std::vector<std::uint64_t>{10, 20, 30}));
  EXPECT_EQ(component.node_of(20), 1);
  EXPECT_EQ(component.node_of(15), std::nullopt);
  EXPECT_EQ(component.node_of(99), std::nullopt);
  ASSERT_EQ(component.graph.edges().size(), 2U);
  EXPECT_NEAR(component.graph.edges()[0].weight, 2.0, 1e-12);
  EXPECT_NEAR(component.graph.edges()[1].weight, 5.0, 1e-12);
}

TEST(ComponentOf, IsOneNodeWhereTheKeyframeHasNoEdge) {
  const auto result = component_of(7, std::vector{keyframe_edge(1, 2, 1.0)}, Criterion::kD);
  EXPECT_EQ(std::get<KeyframeGraph>(result).keyframes, std::vector<std::uint64_t>{7});
}

TEST(ComponentOf, NamesAnEdgeWithoutInformation) {
  const auto result = component_of(1, std::vector{keyframe_edge(1, 2, 0.0)}, Criterion::kD);
  EXPECT_EQ(std::get<GraphError>(result).message, "the information of an edge is not positive definite");
}

}  // namespace
}  // namespace lapis::planner
