#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "planner/conversions.hpp"

namespace lapis::planner {

/// What the pose graph and the landmarks of one version are good for.
struct GraphKnowledge {
  AnalysedGraph graph;
  LandmarkIndex landmarks;
};

/// What a decision is made from; nothing of it changes while one is being made.
struct DecisionInput {
  const Surroundings* surroundings = nullptr;
  const View* view = nullptr;
  geometry::Pose T_base_camera;
  Pose2 robot;
  Memory memory;
  DecisionConfig config;
  std::shared_ptr<const GraphKnowledge> knowledge;  ///< of an earlier decision
  /// When the graph or the landmarks are newer than `knowledge`.
  std::optional<GraphMessage> graph;
  double position_variance_m2 = 0.0;  ///< of each axis, as slam says; 0: it does not
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
};

struct DecisionOutput {
  Decision decision;
  std::shared_ptr<const GraphKnowledge> knowledge;
  double time_s = 0.0;  ///< wall time that it took
};

/// At once.
DecisionOutput make_decision(DecisionInput input);

/// Makes decisions in a thread of its own. The result is due at a fixed frame, so that in lock-step, where who asks
/// waits for it, runs are the same on fast and on slow machines.
class DecisionWorker {
 public:
  bool is_busy() const { return result_.valid(); }
  /// Begins; the result is due at frame number `due`. Not while busy. What the input points to must stay as it is.
  void start(DecisionInput input, std::uint64_t due);
  /// The result once it is due; nothing while it is late, unless that is waited for.
  std::optional<DecisionOutput> take(std::uint64_t frame, bool waits);
  /// Waits for a decision that nobody wants any more.
  void discard();

 private:
  std::future<DecisionOutput> result_;
  std::uint64_t due_ = 0;
};

}  // namespace lapis::planner
