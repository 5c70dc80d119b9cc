#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/core/hallucination/analysed_graph.hpp"

namespace lapis::planner {

/// Ids of the key-frames that a loop closure joins.
struct LoopName {
  std::uint64_t older = 0, newer = 0;

  auto operator<=>(const LoopName&) const = default;
};

/// Names of all loop closures of a graph; sorted.
std::vector<LoopName> names_of_loops(const AnalysedGraph& graph);

/// Contribution of the loop closures of `graph` that are not named in `before` to its log-determinant [nats],
/// comparable to ExpectedGain::loop_gain; 0 when there are none. Empty when the graph without them is not connected or
/// is singular.
/// @param before sorted
std::optional<double> gain_of_new_loops(const AnalysedGraph& graph, std::span<const LoopName> before);

}  // namespace lapis::planner
