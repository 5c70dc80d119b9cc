#include "tests/unit/planner/spectral/public_graphs.hpp"

#include <fstream>
#include <map>
#include <stdexcept>

#include "common/geometry/se3.hpp"
#include "slam/core/files/pose_graph_file.hpp"
#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner::test {
namespace {

// read_g2o changes to rotation vectors, twice what g2o's error is in space.
Information as_in_file(const geometry::Matrix6d& information, bool is_planar) {
  if (is_planar) {
    const std::vector<int> free{0, 1, 5};
    return information(free, free);
  }
  const geometry::Vector6d scale = (geometry::Vector6d() << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0).finished();
  return scale.asDiagonal() * information * scale.asDiagonal();
}

double weight_of(const Information& information, const std::string& kind) {
  if (kind == "unit") return 1.0;
  return edge_weight(information, kind == "det_root" ? Criterion::kD : Criterion::kT).value();
}

}  // namespace

std::vector<KeyframeEdge> read_edges(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const auto result = slam::read_g2o(stream);
  if (const auto* error = std::get_if<slam::PoseGraphFileError>(&result)) throw std::runtime_error(error->message);
  const auto& graph = std::get<slam::PoseGraphSnapshot>(result);
  std::vector<KeyframeEdge> edges;
  for (const slam::PoseGraphEdge& edge : graph.edges) {
    edges.push_back({edge.from, edge.to, as_in_file(edge.information, graph.is_planar)});
  }
  return edges;
}

WeightedGraph weigh(const std::vector<KeyframeEdge>& edges, const std::string& kind) {
  std::map<std::uint64_t, int> nodes;
  for (const KeyframeEdge& edge : edges) nodes[edge.from] = nodes[edge.to] = 0;
  int count = 0;
  for (auto& [id, node] : nodes) node = count++;
  std::vector<WeightedEdge> weighted;
  for (const KeyframeEdge& edge : edges) {
    weighted.push_back({nodes[edge.from], nodes[edge.to], weight_of(edge.information, kind)});
  }
  return make_graph(count, std::move(weighted));
}

}  // namespace lapis::planner::test
