#pragma once

#include <map>
#include <span>
#include <variant>
#include <vector>

#include "planner/core/hallucination/hallucination.hpp"

namespace lapis::planner {

/// A run that is over, as slam and semantic_mapper left it.
struct FinishedRun {
  std::vector<Keyframe> keyframes;  ///< by id; poses as corrected in the end
  std::vector<KeyframeEdge> edges;
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
  InformationField field;
  geometry::PinholeCamera camera;
};

/// A place that a stretch of the path was predicted to see again, and what came of it.
struct LoopOutcome {
  int landmarks = 0;  ///< predicted to be seen again
  bool has_closed = false;
};

struct LoopOutcomes {
  std::vector<LoopOutcome> places;
  int loops = 0;       ///< that the stretches closed with key-frames from before
  int unexpected = 0;  ///< of these, far from every place that was predicted
};

/// Cuts the path into stretches of `stretch_m`. For each, hallucinates its own key-frames, `node_spacing_m` apart, on
/// the graph and the landmarks as they were when it began (the map: as in the end), and looks which of the places did
/// close: slam has a loop from a key-frame of the stretch to one within the place's radius. The first stretches see
/// nothing again and give no outcomes. Probabilities of `config` play no part. The error names what is wrong with the
/// graph.
std::variant<LoopOutcomes, GraphError> loop_outcomes(const FinishedRun& run, const HallucinationConfig& config,
                                                     double stretch_m, double node_spacing_m);

/// Places whose predicted probability lies in [from, to), the last one with 1.
struct ReliabilityBin {
  double from = 0.0, to = 0.0;
  int places = 0, closed = 0;
  double mean_probability = 0.0;  ///< predicted; NaN without places
  double low = 0.0, high = 1.0;   ///< 95 % interval of the share that closes [Wilson 1927]
};

/// Predictions of `config` against what happened, in bins of equal width.
std::vector<ReliabilityBin> reliability(std::span<const LoopOutcome> places, const HallucinationConfig& config,
                                        int bins);

/// Of the outcomes under the probabilities of `config`, which are taken to be within [0.01, 0.99] [nats].
double log_likelihood(std::span<const LoopOutcome> places, const HallucinationConfig& config);
/// The landmarks and the largest probability under which the outcomes are most likely, on a grid with steps of about a
/// tenth; everything else as in `config`. Nothing without places that closed and places that did not.
std::optional<HallucinationConfig> fit(std::span<const LoopOutcome> places, const HallucinationConfig& config);

}  // namespace lapis::planner
