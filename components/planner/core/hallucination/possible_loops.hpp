#pragma once

#include <span>
#include <vector>

#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/uncertainty/map_worth.hpp"

namespace lapis::planner {

/// The loops that a path may close. Key-frames that were taken on the same visit of a place count as one, so that a
/// visit before an error arose counts beside one after it; of a visit, the key-frame of which most landmarks are seen
/// again counts. Deterministic.
/// @param T_map_cameras nodes along the path
std::vector<PossibleLoop> possible_loops(const AnalysedGraph& graph, const LandmarkIndex& landmarks,
                                         const InformationField& field, const geometry::PinholeCamera& camera,
                                         std::span<const geometry::Pose> T_map_cameras,
                                         const HallucinationConfig& config);

}  // namespace lapis::planner
