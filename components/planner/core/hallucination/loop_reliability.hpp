#pragma once

#include <map>
#include <span>
#include <variant>
#include <vector>

#include "planner/core/hallucination/hallucination.hpp"

namespace lapis::planner {

/// A finished run, as slam and semantic_mapper left it.
struct FinishedRun {
  std::vector<Keyframe> keyframes;  ///< sorted by id; final poses
  std::vector<KeyframeEdge> edges;
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
  InformationField field;
  geometry::PinholeCamera camera;
};

/// A place that a stretch of the path was predicted to see again, and whether slam closed a loop with it.
struct LoopOutcome {
  int landmarks = 0;  ///< predicted to be seen again
  bool has_closed = false;
};

struct LoopOutcomes {
  std::vector<LoopOutcome> places;
  int loops = 0;       ///< number that the stretches closed with key-frames from before the stretch
  int unexpected = 0;  ///< number of these that are far from every predicted place
};

/// Cuts the path into stretches of `stretch_m`. For each stretch, hallucinates its own key-frames, `node_spacing_m`
/// apart, on the graph and the landmarks of the stretch's begin and on the final map, and checks which of the predicted
/// places closed: slam has a loop closure between a key-frame of the stretch and one within the place's radius. The
/// first stretches see nothing again and give no outcomes. The probabilities of `config` do not matter. The error says
/// what is wrong with the graph.
std::variant<LoopOutcomes, GraphError> loop_outcomes(const FinishedRun& run, const HallucinationConfig& config,
                                                     double stretch_m, double node_spacing_m);

/// Places whose predicted probability is in [from, to); the last bin includes 1.
struct ReliabilityBin {
  double from = 0.0, to = 0.0;
  int places = 0, closed = 0;
  double mean_probability = 0.0;  ///< of the predictions; NaN without places
  double low = 0.0, high = 1.0;   ///< 95 % interval of the share of places that close [Wilson 1927]
};

/// Compares the predictions of `config` with the outcomes, in bins of equal width.
std::vector<ReliabilityBin> reliability(std::span<const LoopOutcome> places, const HallucinationConfig& config,
                                        int bins);

/// Log-likelihood of the outcomes under the probabilities of `config`, clamped to [0.01, 0.99] [nats].
double log_likelihood(std::span<const LoopOutcome> places, const HallucinationConfig& config);
/// The numbers of landmarks and the largest probability under which the outcomes are most likely, found on a grid with
/// steps of about 15 % for landmarks and of 0.05 for the probability; everything else is as in `config`. Empty unless
/// some places closed and some did not.
std::optional<HallucinationConfig> fit(std::span<const LoopOutcome> places, const HallucinationConfig& config);

}  // namespace lapis::planner
