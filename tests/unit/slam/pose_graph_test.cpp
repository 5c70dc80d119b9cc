#include "slam/core/graph/pose_graph.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "slam/core/files/pose_graph_file.hpp"

#include "tests/support/test_data.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

Matrix6d random_matrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Matrix6d::NullaryExpr([&]() { return normal(random); });
}

PoseGraphSnapshot random_graph(int nodes, unsigned seed) {
  std::mt19937 random(seed);
  PoseGraphSnapshot graph;
  for (int i = 0; i < nodes; ++i) {
    graph.nodes.push_back({static_cast<std::uint64_t>(i), {}, geometry::se3_exp(random_matrix(random).col(0))});
  }
  for (int i = 0; i + 1 < nodes; ++i) {
    const Matrix6d root = random_matrix(random);
    graph.edges.push_back({static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(i + 1), EdgeType::kOdometry,
                           geometry::se3_exp(random_matrix(random).col(0)),
                           root * root.transpose() + Matrix6d::Identity()});
  }
  return graph;
}

std::string written(const PoseGraphSnapshot& graph) {
  std::ostringstream stream;
  write_g2o(stream, graph);
  return stream.str();
}

std::variant<PoseGraphSnapshot, PoseGraphFileError> parsed(const std::string& text) {
  std::istringstream stream(text);
  return read_g2o(stream);
}

std::string fault(const std::string& text) {
  const auto result = parsed(text);
  return std::holds_alternative<PoseGraphFileError>(result) ? std::get<PoseGraphFileError>(result).message : "";
}

TEST(EdgeInformation, IsSymmetricAndBounded) {
  const PoseGraphConfig config{1.0, 2.0, 50.0};
  Matrix6d indefinite = Vector6d(-5.0, 0.0, 3.0, 1e3, 1e12, 20.0).asDiagonal();
  indefinite(0, 5) = 0.3;
  const Matrix6d bounded = edge_information(config, indefinite);
  EXPECT_TRUE(bounded == bounded.transpose());
  const Vector6d values = Eigen::SelfAdjointEigenSolver<Matrix6d>(bounded).eigenvalues();
  EXPECT_GT(values.minCoeff(), 2.0 - 1e-9);
  EXPECT_LT(values.maxCoeff(), 50.0 + 1e-9);
}

TEST(EdgeInformation, KeepsWhatIsWithinTheBounds) {
  std::mt19937 random(1);
  const Matrix6d root = random_matrix(random);
  const Matrix6d information = 100.0 * (root * root.transpose() + Matrix6d::Identity());
  EXPECT_TRUE(edge_information({0.5, 1.0, 1e8}, information).isApprox(0.5 * information, 1e-12));
}

TEST(PoseGraphFile, ReadsBackWhatItWrote) {
  const PoseGraphSnapshot graph = random_graph(20, 2);
  const auto result = parsed(written(graph));
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(result));
  const auto& read = std::get<PoseGraphSnapshot>(result);
  ASSERT_EQ(read.nodes.size(), graph.nodes.size());
  ASSERT_EQ(read.edges.size(), graph.edges.size());
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    EXPECT_EQ(read.nodes[i].id, graph.nodes[i].id);
    EXPECT_TRUE(read.nodes[i].T_map_camera.isApprox(graph.nodes[i].T_map_camera, 1e-12));
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(read.edges[i].from, graph.edges[i].from);
    EXPECT_EQ(read.edges[i].to, graph.edges[i].to);
    EXPECT_TRUE(read.edges[i].T_from_to.isApprox(graph.edges[i].T_from_to, 1e-12));
    EXPECT_TRUE(read.edges[i].information == graph.edges[i].information);
  }
  EXPECT_EQ(written(graph), written(random_graph(20, 2)));
}

// For a small rotation the file's error (vector part of the quaternion) costs what ours (rotation vector) costs.
TEST(PoseGraphFile, InformationMeansTheSameInTheFilesConvention) {
  const PoseGraphSnapshot graph = random_graph(2, 3);
  std::istringstream words(written({0, {}, graph.edges}));
  std::string word;
  for (int i = 0; i < 10; ++i) words >> word;
  Matrix6d upper = Matrix6d::Zero();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) words >> upper(row, column);
  }
  const Matrix6d in_file = upper.selfadjointView<Eigen::Upper>();
  const Vector6d xi = 1e-4 * Vector6d(1.0, -2.0, 0.5, 0.7, 1.5, -1.0);
  Vector6d file_error;
  file_error << geometry::se3_exp(xi).translation(), geometry::unit_quaternion(geometry::se3_exp(xi)).vec();
  const double ours = xi.dot(graph.edges[0].information * xi);
  EXPECT_NEAR(file_error.dot(in_file * file_error), ours, 1e-3 * ours);
}

TEST(PoseGraphFile, NamesTheLineOfAnError) {
  const std::string vertex = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n";
  EXPECT_EQ(fault(vertex + "VERTEX_SE3:QUAT 1 0 0 0\n"), "line 2: VERTEX_SE3:QUAT needs 8 numbers, has 4");
  EXPECT_EQ(fault(vertex + vertex), "line 2: vertex 0 appears twice");
  EXPECT_EQ(fault("VERTEX_SE3:QUAT x 0 0 0 0 0 0 1\n"), "line 1: 'x' is not an id");
  EXPECT_EQ(fault("\n# comment\nVERTEX_SE3:QUAT 1 0 nan 0 0 0 0 1\n"), "line 3: 'nan' is not a finite number");
  EXPECT_EQ(fault("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0\n"), "line 1: quaternion has no length");
  EXPECT_EQ(fault("VERTEX_SE2 0 0 0 0\nFIX 0\n# only what we do not read\n"), "");
}

TEST(PoseGraphFile, ReadsBackAPlanarGraph) {
  const std::string text = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.5 -2 0.5\nEDGE_SE2 0 1 1 -2 0.25 9 1 2 8 3 7\n";
  const auto result = parsed(text);
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(result));
  const auto& graph = std::get<PoseGraphSnapshot>(result);
  EXPECT_TRUE(graph.is_planar);
  EXPECT_EQ(graph.edges[0].information(0, 5), 2.0);
  EXPECT_EQ(graph.edges[0].information(1, 1), 8.0);
  EXPECT_NEAR(geometry::so3_log(graph.nodes[1].T_map_camera.linear()).z(), 0.5, 1e-12);
  EXPECT_NEAR(geometry::so3_log(graph.edges[0].T_from_to.linear()).z(), 0.25, 1e-12);
  const auto again = parsed(written(graph));
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(again));
  const auto& read = std::get<PoseGraphSnapshot>(again);
  EXPECT_TRUE(read.is_planar);
  EXPECT_TRUE(read.nodes[1].T_map_camera.isApprox(graph.nodes[1].T_map_camera, 1e-12));
  EXPECT_TRUE(read.edges[0].T_from_to.isApprox(graph.edges[0].T_from_to, 1e-12));
  EXPECT_TRUE(read.edges[0].information == graph.edges[0].information);
}

// TORO: order of the planar information xx xy yy tt xt yt; roll, pitch, yaw in space, whose error is the angle itself.
TEST(PoseGraphFile, ReadsToroText) {
  const auto in_plane = parsed("VERTEX2 0 0 0 0\nEDGE2 0 1 1 2 0.5 9 1 8 7 2 3\nEQUIV 0 1\n");
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(in_plane));
  const auto in_g2o = parsed("EDGE_SE2 0 1 1 2 0.5 9 1 2 8 3 7\n");
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(in_g2o));
  const auto& toro = std::get<PoseGraphSnapshot>(in_plane).edges;
  const auto& g2o = std::get<PoseGraphSnapshot>(in_g2o).edges;
  ASSERT_EQ(toro.size(), 1U);
  EXPECT_TRUE(toro[0].T_from_to.isApprox(g2o[0].T_from_to, 1e-15));
  EXPECT_TRUE(toro[0].information == g2o[0].information);
  const auto in_space = parsed("EDGE3 0 1 1 2 3 0.1 0.2 0.3 9 0 0 0 0 0 9 0 0 0 0 9 0 0 0 4 0 0 5 0 6\n");
  ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(in_space));
  const PoseGraphEdge& edge = std::get<PoseGraphSnapshot>(in_space).edges[0];
  const Eigen::Vector3d angles = edge.T_from_to.linear().eulerAngles(2, 1, 0);
  EXPECT_TRUE(angles.isApprox(Eigen::Vector3d(0.3, 0.2, 0.1), 1e-9));
  EXPECT_EQ(edge.information(5, 5), 6.0);
}

TEST(PoseGraphFile, RefusesWhatNoMapHolds) {
  const std::string edge = "EDGE_SE2 0 1 1 2 0.5 ";
  EXPECT_EQ(fault(edge + "1 2 0 1 0 1\n"), "line 1: information is not positive semi-definite");
  EXPECT_EQ(fault(edge + "1 0 0 0 0 1\n"), "");
  EXPECT_EQ(fault(edge + "1e19 0 0 1 0 1\n"), "line 1: '1e19' is too large");
  EXPECT_EQ(fault("VERTEX_SE2 0 1e10 0 0\n"), "line 1: '1e10' is too large");
  EXPECT_EQ(fault("EDGE_SE2 4 4 1 2 0.5 1 0 0 1 0 1\n"), "line 1: edge from vertex 4 to itself");
  EXPECT_EQ(fault("VERTEX_SE2 0 0 0 0\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n"),
            "line 2: poses in the plane and in space are mixed");
  EXPECT_EQ(fault("\n" + std::string(kMaxGraphFileLine + 1, ' ')), "line 2: the line is too long");
}

TEST(PoseGraphFile, SurvivesTruncationAndFlippedBits) {
  const std::string text = written(random_graph(6, 4));
  for (std::size_t length = 0; length < text.size(); length += 7) parsed(text.substr(0, length));
  std::mt19937 random(5);
  std::uniform_int_distribution<std::size_t> position(0, text.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string damaged = text;
    for (int flips = 0; flips <= trial % 4; ++flips) {
      char& byte = damaged[position(random)];
      byte = static_cast<char>(byte ^ (1 << bit(random)));
    }
    const auto result = parsed(damaged);
    if (const auto* graph = std::get_if<PoseGraphSnapshot>(&result)) {
      for (const PoseGraphNode& node : graph->nodes) EXPECT_TRUE(geometry::is_valid(node.T_map_camera));
    } else {
      EXPECT_EQ(std::get<PoseGraphFileError>(result).message.rfind("line ", 0), 0U);
    }
  }
}

TEST(PoseGraphFile, ReadsPublicGraphs) {
  const auto folder = lapis::test::find_test_data("posegraph");
  if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("posegraph");
  for (const auto& [name, nodes, edges] :
       {std::tuple("sphere2500.g2o", 2500U, 4949U), std::tuple("parking-garage.g2o", 1661U, 6275U)}) {
    std::ifstream stream(*folder / name);
    const auto result = read_g2o(stream);
    ASSERT_TRUE(std::holds_alternative<PoseGraphSnapshot>(result)) << std::get<PoseGraphFileError>(result).message;
    EXPECT_EQ(std::get<PoseGraphSnapshot>(result).nodes.size(), nodes);
    EXPECT_EQ(std::get<PoseGraphSnapshot>(result).edges.size(), edges);
  }
}

}  // namespace
}  // namespace lapis::slam
