#include "slam/core/calibration/focal_correction.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/core/mapping/bundle_adjuster.hpp"

namespace lapis::slam {
namespace {

constexpr std::size_t kMostKeyframes = 60;  // a bundle adjustment of a second or two
constexpr int kMostAdjustments = 30;

/// All key-frames, and the landmarks that several of them show, whose ids are added to `landmarks`.
BundleProblem problem_of(const SlamConfig& config, const Map& map, std::vector<LandmarkId>& landmarks) {
  BundleProblem problem;
  for (const Keyframe& keyframe : map.keyframes()) {
    problem.cameras.push_back({keyframe.camera, keyframe.T_map_camera, keyframe.id == 0});
  }
  for (LandmarkId id = 0; id < map.landmarks().size(); ++id) {
    const Landmark& landmark = map.landmark(id);
    if (landmark.observations.size() < 2) continue;
    for (const auto& [keyframe, index] : landmark.observations) {
      const Feature& feature = map.keyframe(keyframe).features[static_cast<std::size_t>(index)];
      const double sigma_px = config.noise.pixel_sigma_px * std::pow(config.features.scale_factor, feature.octave);
      problem.observations.push_back(
          {static_cast<std::size_t>(keyframe), problem.points_map.size(), feature.pixel, sigma_px, feature.depth_m});
    }
    problem.points_map.push_back(landmark.p_map);
    landmarks.push_back(id);
  }
  return problem;
}

}  // namespace

bool can_be_remade(const Map& map, const SlamGraph& graph) {
  const bool is_by_vision = graph.count(EdgeType::kOdometry) + 1 == map.keyframes().size();
  return map.keyframes().size() <= kMostKeyframes && is_by_vision && graph.count(EdgeType::kLoopClosure) == 0;
}

void remake_map(const SlamConfig& config, double ratio, Map& map) {
  map.change_focal_length(ratio);
  adjust_whole_map(config, map);
}

void adjust_whole_map(const SlamConfig& config, Map& map) {
  std::vector<LandmarkId> landmarks;
  BundleProblem problem = problem_of(config, map, landmarks);
  BundleConfig bundle = config.bundle;
  bundle.max_iterations = kMostAdjustments;
  if (!adjust_bundle(bundle, config.noise, problem).is_usable) return;
  std::vector<geometry::Pose> moves;
  for (const Keyframe& keyframe : map.keyframes()) {
    moves.push_back(problem.cameras[moves.size()].T_map_camera * keyframe.T_map_camera.inverse());
  }
  map.move(moves);
  for (std::size_t i = 0; i < landmarks.size(); ++i) map.set_position(landmarks[i], problem.points_map[i]);
}

}  // namespace lapis::slam
