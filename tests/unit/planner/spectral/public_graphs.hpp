#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner::test {

/// Edge of a graph file with its information as the file writes it: 3x3 in the plane, else 6x6.
struct FileEdge {
  std::uint64_t from = 0, to = 0;
  Eigen::MatrixXd information;
};

std::vector<FileEdge> read_edges(const std::filesystem::path& file);

/// Weights of a kind in reference.json: "unit", "det_root", "trace_mean". Nodes in the order of their ids.
WeightedGraph weigh(const std::vector<FileEdge>& edges, const std::string& kind);

}  // namespace lapis::planner::test
