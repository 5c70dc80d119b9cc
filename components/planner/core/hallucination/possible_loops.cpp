#include "planner/core/hallucination/possible_loops.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::planner {

std::vector<PossibleLoop> possible_loops(const AnalysedGraph& graph, const LandmarkIndex& landmarks,
                                         const InformationField& field, const geometry::PinholeCamera& camera,
                                         std::span<const geometry::Pose> T_map_cameras,
                                         const HallucinationConfig& config) {
  std::vector<PossibleLoop> loops;
  const auto is_same_visit = [&](int a, int b) {
    return std::abs(graph.travelled_m[index(a)] - graph.travelled_m[index(b)]) < 2.0 * config.place_radius_m;
  };
  const geometry::Pose* before = &graph.keyframes.back().T_map_camera;
  double path_m = 0.0;
  for (const geometry::Pose& pose : T_map_cameras) {
    path_m += path_between(*before, pose);
    before = &pose;
    std::vector<bool> is_old;
    for (const double since_m : graph.path_from_newest_m) is_old.push_back(since_m + path_m >= config.min_loop_path_m);
    for (const Covisibility& seen :
         landmarks.predict(camera, pose, field, config.covisibility, is_old, config.impossible_landmarks + 1)) {
      const double probability = loop_probability(seen.landmarks, config);
      if (probability == 0.0) continue;
      const PossibleLoop loop{seen.keyframe, pose.translation().head<2>(), path_m, probability};
      const auto known = std::find_if(loops.begin(), loops.end(), [&](const PossibleLoop& other) {
        return is_same_visit(other.keyframe, seen.keyframe);
      });
      if (known == loops.end()) {
        loops.push_back(loop);
      } else if (known->probability < probability) {
        *known = loop;
      }
    }
  }
  return loops;
}

}  // namespace lapis::planner
