#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner::test {

/// Edges of a graph file with the information as the file writes it: 3x3 in the plane, else 6x6.
std::vector<KeyframeEdge> read_edges(const std::filesystem::path& file);

/// Weights of a kind in reference.json: "unit", "det_root", "trace_mean". Nodes in the order of their ids.
WeightedGraph weigh(const std::vector<KeyframeEdge>& edges, const std::string& kind);

}  // namespace lapis::planner::test
