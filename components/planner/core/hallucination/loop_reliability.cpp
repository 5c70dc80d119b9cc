#include "planner/core/hallucination/loop_reliability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lapis::planner {
namespace {

constexpr double kNormal95 = 1.959964;
constexpr double kLeastProbability = 0.01;  // a single surprise must not rule out a set of parameters
constexpr double kGridFactor = 1.15;
constexpr int kMostLandmarks = 1000;

// Key-frames [begin, end) of a run.
struct Stretch {
  std::size_t begin = 0, end = 0;
};

std::vector<Stretch> stretches_of(const std::vector<Keyframe>& keyframes, double length_m) {
  std::vector<Stretch> stretches;
  double path_m = 0.0;
  std::size_t begin = 2;  // the first graph has two key-frames
  for (std::size_t i = begin; i < keyframes.size(); ++i) {
    path_m += path_between(keyframes[i - 1].T_map_camera, keyframes[i].T_map_camera);
    if (path_m < length_m) continue;
    stretches.push_back({begin, i + 1});
    begin = i + 1;
    path_m = 0.0;
  }
  return stretches;
}

std::vector<geometry::Pose> nodes_of(const std::vector<Keyframe>& keyframes, const Stretch& stretch, double spacing_m) {
  std::vector<geometry::Pose> nodes;
  double path_m = 0.0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    path_m += path_between(keyframes[i - 1].T_map_camera, keyframes[i].T_map_camera);
    if (path_m < spacing_m && i + 1 < stretch.end) continue;
    nodes.push_back(keyframes[i].T_map_camera);
    path_m = 0.0;
  }
  return nodes;
}

std::vector<KeyframeEdge> edges_until(const std::vector<KeyframeEdge>& edges, std::uint64_t newest) {
  std::vector<KeyframeEdge> before;
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(before),
               [&](const KeyframeEdge& edge) { return std::max(edge.from, edge.to) <= newest; });
  return before;
}

/// Positions of the old key-frames to which a stretch closed loops.
std::vector<Eigen::Vector3d> loops_of(const FinishedRun& run, const Stretch& stretch) {
  std::vector<Eigen::Vector3d> loops;
  const std::uint64_t first = run.keyframes[stretch.begin].id, last = run.keyframes[stretch.end - 1].id;
  for (const KeyframeEdge& edge : run.edges) {
    const std::uint64_t older = std::min(edge.from, edge.to), newer = std::max(edge.from, edge.to);
    if (!edge.is_loop_closure || older >= first || newer < first || newer > last) continue;
    const auto found = std::lower_bound(run.keyframes.begin(), run.keyframes.end(), older,
                                        [](const Keyframe& k, std::uint64_t id) { return k.id < id; });
    if (found != run.keyframes.end() && found->id == older) loops.emplace_back(found->T_map_camera.translation());
  }
  return loops;
}

void compare(const std::vector<Eigen::Vector3d>& loops, const std::vector<std::pair<Eigen::Vector3d, int>>& places,
             double radius_m, LoopOutcomes& outcomes) {
  const auto is_near = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm() < radius_m; };
  for (const auto& [p, landmarks] : places) {
    const bool has_closed =
        std::any_of(loops.begin(), loops.end(), [&, at = p](const auto& l) { return is_near(l, at); });
    outcomes.places.push_back({landmarks, has_closed});
  }
  outcomes.loops += static_cast<int>(loops.size());
  outcomes.unexpected += static_cast<int>(std::count_if(loops.begin(), loops.end(), [&](const auto& loop) {
    return std::none_of(places.begin(), places.end(), [&](const auto& place) { return is_near(loop, place.first); });
  }));
}

/// A configuration that predicts every place, however improbable it is.
HallucinationConfig all_places(HallucinationConfig config) {
  config.impossible_landmarks = 0;
  config.certain_landmarks = std::numeric_limits<int>::max();
  config.max_probability = 1.0;
  config.max_places = std::numeric_limits<int>::max();
  return config;
}

}  // namespace

std::variant<LoopOutcomes, GraphError> loop_outcomes(const FinishedRun& run, const HallucinationConfig& config,
                                                     double stretch_m, double node_spacing_m) {
  LoopOutcomes outcomes;
  for (const Stretch& stretch : stretches_of(run.keyframes, stretch_m)) {
    const std::span<const Keyframe> before(run.keyframes.data(), stretch.begin);
    const auto analysed = analyse_graph(before, edges_until(run.edges, before.back().id));
    if (const auto* error = std::get_if<GraphError>(&analysed)) return *error;
    const auto& graph = std::get<AnalysedGraph>(analysed);
    const LandmarkIndex landmarks(run.landmarks, graph, run.field.resolution_m());
    const Hallucination path = hallucinate(graph, landmarks, run.field, run.camera,
                                           nodes_of(run.keyframes, stretch, node_spacing_m), all_places(config));
    std::vector<std::pair<Eigen::Vector3d, int>> places;
    for (const Place& place : path.places) {
      const auto keyframe = static_cast<std::size_t>(place.keyframe);
      places.emplace_back(graph.keyframes[keyframe].T_map_camera.translation(), place.landmarks);
    }
    compare(loops_of(run, stretch), places, config.place_radius_m, outcomes);
  }
  return outcomes;
}

std::vector<ReliabilityBin> reliability(std::span<const LoopOutcome> places, const HallucinationConfig& config,
                                        int bins) {
  std::vector<ReliabilityBin> table(static_cast<std::size_t>(bins));
  for (const LoopOutcome& place : places) {
    const double p = loop_probability(place.landmarks, config);
    ReliabilityBin& bin = table[static_cast<std::size_t>(std::min(p * bins, bins - 1.0))];
    ++bin.places;
    bin.closed += place.has_closed ? 1 : 0;
    bin.mean_probability += p;
  }
  for (std::size_t i = 0; i < table.size(); ++i) {
    ReliabilityBin& bin = table[i];
    bin.from = static_cast<double>(i) / bins;
    bin.to = static_cast<double>(i + 1) / bins;
    const double n = bin.places, z2 = kNormal95 * kNormal95;
    bin.mean_probability /= n;
    if (bin.places == 0) continue;
    const double share = bin.closed / n;
    const double middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
    const double half = kNormal95 / (1.0 + z2 / n) * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
    bin.low = middle - half;
    bin.high = middle + half;
  }
  return table;
}

double log_likelihood(std::span<const LoopOutcome> places, const HallucinationConfig& config) {
  double sum = 0.0;
  for (const LoopOutcome& place : places) {
    const double p = std::clamp(loop_probability(place.landmarks, config), kLeastProbability, 1.0 - kLeastProbability);
    sum += std::log(place.has_closed ? p : 1.0 - p);
  }
  return sum;
}

std::optional<HallucinationConfig> fit(std::span<const LoopOutcome> places, const HallucinationConfig& config) {
  const auto closed = std::count_if(places.begin(), places.end(), [](const LoopOutcome& p) { return p.has_closed; });
  if (closed == 0 || closed == static_cast<std::ptrdiff_t>(places.size())) return std::nullopt;
  const auto next = [](int n) { return std::max(n + 1, static_cast<int>(std::lround(n * kGridFactor))); };
  HallucinationConfig tried = config, best = config;
  double most = -std::numeric_limits<double>::infinity();
  for (int twentieths = 1; twentieths <= 20; ++twentieths) {
    tried.max_probability = 0.05 * twentieths;
    for (int low = 1; low < kMostLandmarks; low = next(low)) {
      tried.impossible_landmarks = low;
      for (int high = next(low); high <= kMostLandmarks; high = next(high)) {
        tried.certain_landmarks = high;
        const double likelihood = log_likelihood(places, tried);
        if (likelihood <= most) continue;
        most = likelihood;
        best = tried;
      }
    }
  }
  return best;
}

}  // namespace lapis::planner
