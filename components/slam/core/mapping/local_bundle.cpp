#include "slam/core/mapping/local_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace lapis::slam {
namespace {

constexpr double kOutlierGate = 11.34;  // chi-square, 99 % of 3 degrees of freedom

// The part of the map under adjustment; ordered containers keep the result independent of memory addresses.
struct LocalMap {
  std::map<KeyframeId, std::size_t> cameras;
  std::vector<LandmarkId> landmarks;
  std::vector<Observation> observations;  // parallel to BundleProblem::observations
  BundleProblem problem;
};

void add_camera(const Map& map, KeyframeId id, bool is_fixed, LocalMap& local) {
  const Keyframe& keyframe = map.keyframe(id);
  local.cameras.emplace(id, local.problem.cameras.size());
  local.problem.cameras.push_back({keyframe.camera, keyframe.T_map_camera, is_fixed});
}

void choose_landmarks(const SlamConfig& config, const Map& map, const std::vector<KeyframeId>& window,
                      LocalMap& local) {
  for (const LandmarkId id : map.landmarks_of(window)) {
    if (map.landmark(id).observations.size() >= 2) local.landmarks.push_back(id);
  }
  const auto most = static_cast<std::size_t>(config.bundle.max_landmarks);
  if (local.landmarks.size() > most) {
    local.landmarks.erase(local.landmarks.begin(), local.landmarks.end() - static_cast<std::ptrdiff_t>(most));
  }
}

// Adds as fixed the key-frames outside the window that see most of the chosen landmarks.
void add_fixed_cameras(const SlamConfig& config, const Map& map, LocalMap& local) {
  std::map<KeyframeId, int> seen;
  for (const LandmarkId id : local.landmarks) {
    for (const Observation& observation : map.landmark(id).observations) {
      if (!local.cameras.contains(observation.keyframe)) ++seen[observation.keyframe];
    }
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [id, count] : seen) ranked.emplace_back(count, id);
  std::sort(ranked.rbegin(), ranked.rend());
  ranked.resize(std::min(ranked.size(), static_cast<std::size_t>(config.bundle.max_fixed)));
  for (const auto& [count, id] : ranked) add_camera(map, id, true, local);
}

void add_observations(const SlamConfig& config, const Map& map, LocalMap& local) {
  for (const LandmarkId id : local.landmarks) {
    const std::size_t point = local.problem.points_map.size();
    local.problem.points_map.push_back(map.landmark(id).p_map);
    for (const Observation& observation : map.landmark(id).observations) {
      const auto camera = local.cameras.find(observation.keyframe);
      if (camera == local.cameras.end()) continue;
      const Feature& feature =
          map.keyframe(observation.keyframe).features[static_cast<std::size_t>(observation.feature)];
      const double sigma = config.noise.pixel_sigma_px * std::pow(config.features.scale_factor, feature.octave);
      local.problem.observations.push_back({camera->second, point, feature.pixel, sigma, feature.depth_m});
      local.observations.push_back(observation);
    }
  }
}

LocalMap cut_out(const SlamConfig& config, const std::vector<KeyframeLink>& links, const Map& map) {
  LocalMap local;
  const KeyframeId newest = map.keyframes().back().id;
  std::vector<KeyframeId> window = map.covisible(newest, static_cast<std::size_t>(config.bundle.window - 1));
  window.push_back(newest);
  for (const KeyframeId id : window) add_camera(map, id, false, local);
  choose_landmarks(config, map, window, local);
  add_fixed_cameras(config, map, local);
  if (local.problem.cameras.size() == window.size()) {
    const KeyframeId oldest = *std::min_element(window.begin(), window.end());
    local.problem.cameras[local.cameras.at(oldest)].is_fixed = true;
  }
  add_observations(config, map, local);
  for (const KeyframeLink& link : links) {
    const auto from = local.cameras.find(link.from);
    const auto to = local.cameras.find(link.to);
    if (from == local.cameras.end() || to == local.cameras.end()) continue;
    local.problem.links.push_back({from->second, to->second, link.T_from_to, link.information});
  }
  return local;
}

void remove_outliers(const SlamConfig& config, const LocalMap& local, Map& map) {
  for (std::size_t i = 0; i < local.observations.size(); ++i) {
    const BundleObservation& observation = local.problem.observations[i];
    const BundleCamera& camera = local.problem.cameras[observation.camera];
    Eigen::Vector3d residual;
    const bool in_front = bundle_residual(config.noise, camera.camera, observation, camera.T_map_camera,
                                          local.problem.points_map[observation.point], residual, nullptr, nullptr);
    if (in_front && residual.squaredNorm() < kOutlierGate) continue;
    map.remove_observation(local.landmarks[observation.point], local.observations[i]);
  }
}

}  // namespace

std::vector<KeyframeId> adjust_local_map(const SlamConfig& config, const std::vector<KeyframeLink>& links, Map& map) {
  std::vector<KeyframeId> moved;
  if (map.keyframes().size() < 2) return moved;
  LocalMap local = cut_out(config, links, map);
  if (local.observations.empty() || !adjust_bundle(config.bundle, config.noise, local.problem).is_usable) return moved;
  for (const auto& [id, camera] : local.cameras) {
    if (local.problem.cameras[camera].is_fixed) continue;
    map.set_pose(id, local.problem.cameras[camera].T_map_camera);
    moved.push_back(id);
  }
  for (std::size_t i = 0; i < local.landmarks.size(); ++i) {
    map.set_position(local.landmarks[i], local.problem.points_map[i]);
  }
  remove_outliers(config, local, map);
  return moved;
}

}  // namespace lapis::slam
