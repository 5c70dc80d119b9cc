#include "planner/core/hallucination/landmark_index.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace lapis::planner {
namespace {

mapping::VoxelIndex voxel_of(const Eigen::Vector3d& p, double resolution_m) {
  const auto cell = [&](double x) { return static_cast<std::int32_t>(std::floor(x / resolution_m)); };
  return {cell(p.x()), cell(p.y()), cell(p.z())};
}

// A landmark of a tile that key-frames of the graph have seen.
struct Seen {
  mapping::VoxelIndex voxel;
  std::uint32_t id;
  Eigen::Vector3f p_map;
  std::vector<int> observers;
};

std::vector<int> observers_of(const mapping::LandmarkTile& tile, std::size_t i, const AnalysedGraph& graph) {
  std::vector<int> observers;
  for (std::uint32_t o = i == 0 ? 0 : tile.observer_ends[i - 1]; o < tile.observer_ends[i]; ++o) {
    if (const auto node = graph.node_of(tile.observers[o])) observers.push_back(*node);
  }
  return observers;
}

std::vector<Seen> collect(const std::map<mapping::TileIndex, mapping::LandmarkTile>& tiles, const AnalysedGraph& graph,
                          double resolution_m) {
  std::vector<Seen> seen;
  for (const auto& entry : tiles) {
    const mapping::LandmarkTile& tile = entry.second;
    for (std::size_t i = 0; i < tile.ids.size(); ++i) {
      std::vector<int> observers = observers_of(tile, i, graph);
      if (observers.empty()) continue;
      const Eigen::Vector3f& p = tile.positions_m[i];
      seen.push_back({voxel_of(p.cast<double>(), resolution_m), tile.ids[i], p, std::move(observers)});
    }
  }
  std::sort(seen.begin(), seen.end(),
            [](const Seen& a, const Seen& b) { return std::tie(a.voxel, a.id) < std::tie(b.voxel, b.id); });
  return seen;
}

bool is_on_image(const geometry::PinholeCamera& camera, const Eigen::Vector3d& p_camera, double max_range_m) {
  return p_camera.z() > 0.0 && p_camera.squaredNorm() <= max_range_m * max_range_m &&
         camera.contains(camera.project(p_camera));
}

}  // namespace

double free_probability(const InformationField& field, const Eigen::Vector3d& from_map, const Eigen::Vector3d& to_map) {
  const double step_m = 0.5 * field.resolution_m();
  const Eigen::Vector3d ray = to_map - from_map;
  const double length = ray.norm() - 1.5 * field.resolution_m();
  double probability = 1.0;
  mapping::VoxelIndex last = voxel_of(from_map, field.resolution_m());
  for (double t = step_m; t < length && probability > 0.0; t += step_m) {
    const mapping::VoxelIndex voxel = voxel_of(from_map + ray.normalized() * t, field.resolution_m());
    if (voxel == last) continue;
    probability *= field.cell(voxel).free;
    last = voxel;
  }
  return probability;
}

LandmarkIndex::LandmarkIndex(const std::map<mapping::TileIndex, mapping::LandmarkTile>& tiles,
                             const AnalysedGraph& graph, double resolution_m)
    : shared_(graph.keyframes.size(), 0), resolution_m_(resolution_m) {
  const std::vector<Seen> seen = collect(tiles, graph, resolution_m);
  for (std::size_t first = 0, last = 0; first < seen.size(); first = last) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; last < seen.size() && seen[last].voxel == seen[first].voxel; ++last) {
      const Seen& landmark = seen[last];
      sum += landmark.p_map.cast<double>();
      for (const int node : landmark.observers) {
        const Eigen::Vector3f eye = graph.keyframes[index(node)].T_map_camera.translation().cast<float>();
        observations_.push_back({node, landmark.p_map - eye});
        shared_[index(node)] += landmark.observers.size() > 1 ? 1 : 0;
      }
      landmarks_.push_back({landmark.p_map, static_cast<std::uint32_t>(observations_.size())});
    }
    cells_.push_back({sum / static_cast<double>(last - first), static_cast<std::uint32_t>(landmarks_.size())});
  }
}

std::vector<int> LandmarkIndex::counts(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                                       const InformationField* field, const CovisibilityConfig& config) const {
  const geometry::Pose T_camera_map = T_map_camera.inverse();
  const Eigen::Vector3d eye = T_map_camera.translation();
  std::vector<int> counts(shared_.size(), 0);
  std::uint32_t first = 0;
  for (const Cell& cell : cells_) {
    const std::uint32_t begin = std::exchange(first, cell.landmarks_end);
    if ((cell.center - eye).norm() > config.max_range_m + resolution_m_) continue;
    if ((T_camera_map * cell.center).z() < -resolution_m_) continue;
    bool is_visible = false;  // computed once for all landmarks of the cell, when the first is in the image
    for (std::uint32_t i = begin; i < cell.landmarks_end; ++i) {
      const Eigen::Vector3d p_camera = T_camera_map * landmarks_[i].p_map.cast<double>();
      if (!is_on_image(camera, p_camera, config.max_range_m)) continue;
      is_visible =
          is_visible || field == nullptr || free_probability(*field, eye, cell.center) >= config.min_visibility;
      if (!is_visible) break;
      count(i, eye.cast<float>(), config, counts);
    }
  }
  return counts;
}

std::vector<Covisibility> LandmarkIndex::predict(const geometry::PinholeCamera& camera,
                                                 const geometry::Pose& T_map_camera, const InformationField& field,
                                                 const CovisibilityConfig& config) const {
  const std::vector<int> seen = counts(camera, T_map_camera, &field, config);
  std::vector<Covisibility> result;
  for (std::size_t node = 0; node < seen.size(); ++node) {
    if (seen[node] > 0) result.push_back({static_cast<int>(node), seen[node]});
  }
  return result;
}

std::vector<Covisibility> LandmarkIndex::predict(const geometry::PinholeCamera& camera,
                                                 const geometry::Pose& T_map_camera, const InformationField& field,
                                                 const CovisibilityConfig& config, const std::vector<bool>& wanted,
                                                 int least_landmarks) const {
  const std::vector<int> possible = counts(camera, T_map_camera, nullptr, config);
  bool is_any = false;
  for (std::size_t node = 0; node < possible.size(); ++node)
    is_any = is_any || (wanted[node] && possible[node] >= least_landmarks);
  if (!is_any) return {};
  std::vector<Covisibility> result = predict(camera, T_map_camera, field, config);
  std::erase_if(result, [&](const Covisibility& seen) {
    return !wanted[index(seen.keyframe)] || seen.landmarks < least_landmarks;
  });
  return result;
}

void LandmarkIndex::count(std::size_t landmark, const Eigen::Vector3f& camera, const CovisibilityConfig& config,
                          std::vector<int>& counts) const {
  const Eigen::Vector3f towards = landmarks_[landmark].p_map - camera;
  const auto min_cosine = static_cast<float>(std::cos(config.max_viewing_angle_rad));
  const auto max_ratio = static_cast<float>(config.max_range_ratio);
  const float range = towards.norm();
  std::uint32_t o = landmark == 0 ? 0 : landmarks_[landmark - 1].observations_end;
  for (; o < landmarks_[landmark].observations_end; ++o) {
    const Observation& seen = observations_[o];
    const float seen_range = seen.towards.norm();
    if (range > max_ratio * seen_range || seen_range > max_ratio * range) continue;
    if (towards.dot(seen.towards) >= min_cosine * range * seen_range) ++counts[index(seen.keyframe)];
  }
}

}  // namespace lapis::planner
