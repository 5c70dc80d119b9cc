#include "planner/core/hallucination/hallucination.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "planner/core/spectral/graph_optimality.hpp"

namespace lapis::planner {
namespace {

constexpr double kLeastHallucinatedLength_m = 0.02;  // least length of a hallucinated odometry edge

// Finds, pose by pose, the old places that a path sees again.
class PlaceFinder {
 public:
  PlaceFinder(const AnalysedGraph& graph, const HallucinationConfig& config) : graph_(graph), config_(config) {}

  void look(int node, double path_m, std::span<const Covisibility> seen) {
    const Covisibility* best = nullptr;
    for (const Covisibility& one : seen) {
      if ((best == nullptr || one.landmarks > best->landmarks) && may_close(one.keyframe, path_m)) best = &one;
    }
    if (best == nullptr) return;
    const double probability = loop_probability(best->landmarks, config_);
    if (probability > 0.0) add({best->keyframe, node, best->landmarks, probability});
  }

  std::vector<Place> most_probable() {
    std::stable_sort(places_.begin(), places_.end(),
                     [](const Place& a, const Place& b) { return a.probability > b.probability; });
    places_.resize(std::min(places_.size(), static_cast<std::size_t>(config_.max_places)));
    return places_;
  }

 private:
  bool is_same_place(int a, int b) const {
    const auto& keyframes = graph_.keyframes;
    const Eigen::Vector3d offset =
        keyframes[index(a)].T_map_camera.translation() - keyframes[index(b)].T_map_camera.translation();
    return offset.norm() < config_.place_radius_m;
  }

  bool may_close(int keyframe, double path_m) const {
    if (graph_.path_from_newest_m[index(keyframe)] + path_m < config_.min_loop_path_m) return false;
    return std::none_of(graph_.loops.begin(), graph_.loops.end(), [&](const LoopClosure& loop) {
      const double since = graph_.travelled_m.back() - graph_.travelled_m[index(loop.newer)] + path_m;
      return since < config_.revisit_spacing_m && is_same_place(loop.older, keyframe);
    });
  }

  void add(const Place& place) {
    for (Place& known : places_) {
      if (!is_same_place(known.keyframe, place.keyframe)) continue;
      if (place.probability > known.probability) known = place;
      return;
    }
    places_.push_back(place);
  }

  const AnalysedGraph& graph_;
  const HallucinationConfig& config_;
  std::vector<Place> places_;
};

// Reduces the gain of a set of loops to the part that brings the variance at the path's end down to the limit.
double saturated(double gain, double variance_without, double variance, double limit) {
  if (variance_without <= limit || variance >= variance_without) return 0.0;
  if (variance >= limit) return gain;
  return gain * std::log(variance_without / limit) / std::log(variance_without / variance);
}

double probability_of(PlaceSet closed, const std::vector<Place>& places) {
  double probability = 1.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool is_closed = (closed & only_place(static_cast<int>(i))) != 0;
    probability *= is_closed ? places[i].probability : 1.0 - places[i].probability;
  }
  return probability;
}

std::variant<double, GraphError> optimality_with(const HallucinatedGraph& path, const AnalysedGraph& graph) {
  std::vector<WeightedEdge> edges = graph.graph.edges();
  for (const HallucinatedEdge& edge : path.edges) edges.push_back(edge.edge);
  const auto extended = WeightedGraph::make(graph.graph.node_count() + path.node_count, std::move(edges));
  if (const auto* error = std::get_if<GraphError>(&extended)) return *error;
  return optimality(std::get<WeightedGraph>(extended), graph.criterion);
}

}  // namespace

double loop_probability(int landmarks, const HallucinationConfig& config) {
  const double share = static_cast<double>(landmarks - config.impossible_landmarks) /
                       (config.certain_landmarks - config.impossible_landmarks);
  return config.max_probability * std::clamp(share, 0.0, 1.0);
}

Hallucination hallucinate(const AnalysedGraph& graph, const LandmarkIndex& landmarks, const InformationField& field,
                          const geometry::PinholeCamera& camera, std::span<const geometry::Pose> T_map_cameras,
                          const HallucinationConfig& config) {
  Hallucination result;
  PlaceFinder finder(graph, config);
  const int first = graph.factor.node_count();
  const geometry::Pose* before = &graph.keyframes.back().T_map_camera;
  double path_m = 0.0;
  for (const geometry::Pose& pose : T_map_cameras) {
    const int node = result.graph.node_count++;
    const double length = std::max(path_between(*before, pose), kLeastHallucinatedLength_m);
    result.graph.edges.push_back({{first + node - 1, first + node, graph.odometry_weight_metres / length}});
    path_m += length;
    finder.look(node, path_m, landmarks.predict(camera, pose, field, config.covisibility));
    before = &pose;
  }
  result.places = finder.most_probable();
  const double loop_weight =
      config.loop_weight > 0.0 ? config.loop_weight * graph.odometry_weight_metres : graph.loop_weight;
  for (std::size_t i = 0; i < result.places.size(); ++i) {
    const Place& place = result.places[i];
    result.graph.edges.push_back({{first + place.node, place.keyframe, loop_weight}, static_cast<int>(i)});
  }
  return result;
}

std::variant<ExpectedGain, GraphError> expect_gain(const AnalysedGraph& graph, const Hallucination& path,
                                                   double sigma_limit_m) {
  auto made = CandidateGain::make(graph.factor, path.graph);
  if (auto* error = std::get_if<GraphError>(&made)) return *error;
  const auto& gain = std::get<CandidateGain>(made);
  const int end = graph.factor.node_count() + path.graph.node_count - 1;
  const auto variance = [&](PlaceSet places) {
    return gain.variance(end, places) * graph.position_variance_per_resistance;
  };
  const double without = variance(kNoPlace);
  ExpectedGain expected;
  expected.end_sigma_without_loops_m = std::sqrt(without);
  for (PlaceSet closed = 0; closed < PlaceSet{1} << path.places.size(); ++closed) {
    const double probability = probability_of(closed, path.places);
    if (probability == 0.0) continue;
    const double with = variance(closed);
    const double loop_gain = gain.loop_gain(closed);
    expected.loop_gain += probability * loop_gain;
    expected.saturated_loop_gain += probability * saturated(loop_gain, without, with, sigma_limit_m * sigma_limit_m);
    expected.fixed_n_change += probability * gain.fixed_n_change(closed);
    expected.end_sigma_m += probability * std::sqrt(with);
  }
  return expected;
}

std::variant<double, GraphError> literal_optimality(const AnalysedGraph& graph, const Hallucination& path) {
  HallucinatedGraph weighted = path.graph;
  for (HallucinatedEdge& edge : weighted.edges) {
    if (edge.place != HallucinatedEdge::kCertain)
      edge.edge.weight *= path.places[static_cast<std::size_t>(edge.place)].probability;
  }
  if (graph.criterion != Criterion::kD) return optimality_with(weighted, graph);
  auto gain = CandidateGain::make(graph.factor, weighted);
  if (auto* error = std::get_if<GraphError>(&gain)) return *error;
  return std::get<CandidateGain>(gain).d_optimality(kEveryPlace);
}

}  // namespace lapis::planner
