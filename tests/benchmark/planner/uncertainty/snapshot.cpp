#include "tests/benchmark/planner/uncertainty/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "planner/core/uncertainty/planar_graph.hpp"
#include "planner/core/uncertainty/surviving_share.hpp"

namespace lapis::planner::benchmark {
namespace {

PlanarGraph planar_graph(const slam::PoseGraphSnapshot& graph) {
  std::vector<Keyframe> keyframes;
  for (const auto& node : graph.nodes) keyframes.push_back({node.id, node.T_map_camera});
  std::vector<KeyframeEdge> edges;
  for (const auto& edge : graph.edges)
    edges.push_back({edge.from, edge.to, edge.information, edge.type == slam::EdgeType::kLoopClosure});
  auto made = PlanarGraph::make(keyframes, edges);
  if (const auto* error = std::get_if<GraphError>(&made)) throw std::runtime_error(error->message);
  return std::get<PlanarGraph>(std::move(made));
}

/// How far off a surface lies that a key-frame has seen so far ahead.
Eigen::Vector2d displacement_m(const geometry::Pose& T_map_camera, const geometry::Pose& T_map_true, double range_m) {
  const auto surface = [range_m](const geometry::Pose& T) -> Eigen::Vector2d {
    return T.translation().head<2>() + range_m * T.linear().col(2).head<2>().normalized();
  };
  return surface(T_map_camera) - surface(T_map_true);
}

std::uint64_t hits_of(const mapping::VoxelCounts& counts) {
  std::uint64_t sum = 0;
  for (const mapping::ClassCount& hit : counts.hits) sum += hit.count;
  return sum;
}

}  // namespace

Survival survival_of(const slam::PoseGraphSnapshot& graph, const std::map<std::uint64_t, geometry::Pose>& truth,
                     const std::map<std::uint64_t, semantic_mapper::Stake>& stakes, double resolution_m) {
  const PlanarGraph planar = planar_graph(graph);
  const auto marginals = planar.marginals();
  Survival sum;
  double squares = 0.0, variances = 0.0;
  for (std::size_t i = 0; i < marginals.size(); ++i) {
    const Keyframe& keyframe = planar.keyframes()[i];
    const geometry::Pose& T_map_true = truth.at(keyframe.id);
    squares += (keyframe.T_map_camera.translation() - T_map_true.translation()).squaredNorm();
    variances += 0.5 * marginals[i].topLeftCorner<2, 2>().trace();
    const auto known = stakes.find(keyframe.id);
    if (known == stakes.end()) continue;
    for (std::size_t bin = 0; bin < known->second.size(); ++bin) {
      const double voxels = static_cast<double>(known->second[bin]) / static_cast<double>(semantic_mapper::kOneVoxel);
      const double range_m = (static_cast<double>(bin) + 0.5) * semantic_mapper::kStakeBin_m;
      const double sigma_m = surface_sigma_m(marginals[i], keyframe.T_map_camera.linear().col(2), range_m);
      sum.voxels += voxels;
      sum.actual +=
          voxels * surviving_share_of(displacement_m(keyframe.T_map_camera, T_map_true, range_m), resolution_m);
      sum.predicted += voxels * surviving_share(sigma_m, resolution_m);
      sum.predicted_wide += voxels * surviving_share(kWideFactor * sigma_m, resolution_m);
    }
  }
  if (!(sum.voxels > 0.0)) throw std::runtime_error("nothing of the map hangs on a key-frame of the graph");
  for (double* share : {&sum.actual, &sum.predicted, &sum.predicted_wide}) *share /= sum.voxels;
  const auto nodes = static_cast<double>(marginals.size());
  sum.ate_m = std::sqrt(squares / nodes);
  sum.sigma_m = std::sqrt(variances / nodes);
  return sum;
}

double common_share(const mapping::VoxelMap& map, const mapping::VoxelMap& at_true_poses) {
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  double sum = 0.0;
  std::size_t voxels = 0;
  map.for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    const std::uint64_t hits = hits_of(counts);
    if (hits == 0 || !reader.is_occupied(counts)) return;
    const std::uint64_t there = hits_of(at_true_poses.read(voxel));
    sum += static_cast<double>(std::min(hits, there)) / static_cast<double>(hits);
    ++voxels;
  });
  return voxels == 0 ? 0.0 : sum / static_cast<double>(voxels);
}

}  // namespace lapis::planner::benchmark
