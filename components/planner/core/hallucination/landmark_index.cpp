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

std::vector<LandmarkIndex::InView> LandmarkIndex::in_view(const geometry::PinholeCamera& camera,
                                                          const geometry::Pose& T_map_camera,
                                                          const CovisibilityConfig& config) const {
  const geometry::Pose T_camera_map = T_map_camera.inverse();
  const Eigen::Vector3d eye = T_map_camera.translation();
  const Eigen::Vector3d ahead = T_map_camera.linear().col(2);
  const double reach_m2 = std::pow(config.max_range_m + resolution_m_, 2);
  std::vector<InView> views;
  std::uint32_t first = 0;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const std::uint32_t begin = std::exchange(first, cell.landmarks_end);
    if ((cell.center - eye).squaredNorm() > reach_m2) continue;
    if (ahead.dot(cell.center - eye) < -resolution_m_) continue;
    std::vector<int> nodes;
    for (std::uint32_t i = begin; i < cell.landmarks_end; ++i) {
      const Eigen::Vector3d p_camera = T_camera_map * landmarks_[i].p_map.cast<double>();
      if (is_on_image(camera, p_camera, config.max_range_m)) collect_observers(i, eye.cast<float>(), config, nodes);
    }
    if (!nodes.empty()) views.push_back({c, std::move(nodes)});
  }
  return views;
}

std::vector<Covisibility> LandmarkIndex::predict(const geometry::PinholeCamera& camera,
                                                 const geometry::Pose& T_map_camera, const InformationField& field,
                                                 const CovisibilityConfig& config) const {
  return predict(camera, T_map_camera, field, config, std::vector<bool>(shared_.size(), true), 1);
}

std::vector<Covisibility> LandmarkIndex::predict(const geometry::PinholeCamera& camera,
                                                 const geometry::Pose& T_map_camera, const InformationField& field,
                                                 const CovisibilityConfig& config, const std::vector<bool>& wanted,
                                                 int least_landmarks) const {
  const std::vector<InView> views = in_view(camera, T_map_camera, config);
  std::vector<int> possible(shared_.size(), 0), counts(shared_.size(), 0);
  for (const InView& view : views) {
    for (const int node : view.seen_by) ++possible[index(node)];
  }
  const auto is_possible = [&](int node) { return wanted[index(node)] && possible[index(node)] >= least_landmarks; };
  for (const InView& view : views) {
    if (std::none_of(view.seen_by.begin(), view.seen_by.end(), is_possible)) continue;
    const Eigen::Vector3d& center = cells_[view.cell].center;
    if (free_probability(field, T_map_camera.translation(), center) < config.min_visibility) continue;
    for (const int node : view.seen_by) ++counts[index(node)];
  }
  std::vector<Covisibility> result;
  for (int node = 0; node < std::ssize(counts); ++node) {
    if (is_possible(node) && counts[index(node)] >= least_landmarks) result.push_back({node, counts[index(node)]});
  }
  return result;
}

void LandmarkIndex::collect_observers(std::size_t landmark, const Eigen::Vector3f& camera,
                                      const CovisibilityConfig& config, std::vector<int>& nodes) const {
  const Eigen::Vector3f towards = landmarks_[landmark].p_map - camera;
  const auto min_cosine = static_cast<float>(std::cos(config.max_viewing_angle_rad));
  const auto max_ratio = static_cast<float>(config.max_range_ratio);
  const float range = towards.norm();
  std::uint32_t o = landmark == 0 ? 0 : landmarks_[landmark - 1].observations_end;
  for (; o < landmarks_[landmark].observations_end; ++o) {
    const Observation& seen = observations_[o];
    const float seen_range = seen.towards.norm();
    if (range > max_ratio * seen_range || seen_range > max_ratio * range) continue;
    if (towards.dot(seen.towards) >= min_cosine * range * seen_range) nodes.push_back(seen.keyframe);
  }
}

}  // namespace lapis::planner
