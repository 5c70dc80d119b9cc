#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "planner/conversions.hpp"

namespace lapis::planner {

/// What decisions need from one version of the pose graph and the landmarks.
struct GraphKnowledge {
  AnalysedGraph graph;
  LandmarkIndex landmarks;
};

/// The input of a decision; it must not change while the decision is being made.
struct DecisionInput {
  const Surroundings* surroundings = nullptr;
  const View* view = nullptr;
  geometry::Pose T_base_camera;
  Pose2 robot;
  Memory memory;
  DecisionConfig config;
  std::shared_ptr<const GraphKnowledge> knowledge;  ///< of an earlier decision
  /// Set when the graph or the landmarks are newer than `knowledge`.
  std::optional<GraphMessage> graph;
  double position_variance_m2 = 0.0;  ///< per axis, as slam publishes it; 0 when slam does not publish it
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
};

struct DecisionOutput {
  Decision decision;
  std::shared_ptr<const GraphKnowledge> knowledge;
  double time_s = 0.0;  ///< wall-clock time of the decision
};

/// Makes a decision in the calling thread.
DecisionOutput make_decision(DecisionInput input);

/// Makes decisions in a thread of its own. The result is due at a fixed frame. In lock-step the planner waits for it,
/// so that runs are the same on fast and on slow machines.
class DecisionWorker {
 public:
  bool is_busy() const { return result_.valid(); }
  /// Begins a decision whose result is due at frame number `due`. Must not be called while busy. What the input points
  /// to must not change.
  void start(DecisionInput input, std::uint64_t due);
  /// The result once it is due. If it is late: nothing, or the result after a wait when `waits`.
  std::optional<DecisionOutput> take(std::uint64_t frame, bool waits);
  /// Waits for a decision that is no longer wanted.
  void discard();

 private:
  std::future<DecisionOutput> result_;
  std::uint64_t due_ = 0;
};

}  // namespace lapis::planner
