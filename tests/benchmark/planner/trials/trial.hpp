#pragma once

#include <string>
#include <vector>

#include "planner/planner_config.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"
#include "tests/benchmark/planner/trials/pose_model.hpp"

namespace lapis::planner::benchmark {

struct TrialSetting {
  simulator::SimulatorConfig simulated;
  PlannerComponentConfig planner;
  double longest_s = 300.0;  ///< of simulated time
  bool with_gains = false;   ///< notes TrialResult::gains
};

/// What a decision promised to secure of the map, and what came of it until the next decision: by how much the worth of
/// the voxels that were known when it was taken grew.
struct Gain {
  double time_s = 0.0, path_m = 0.0;
  bool is_revisit = false;
  int loops = 0;
  double map_nats = 0.0;       ///< if no pose had an error
  double promised_nats = 0.0;  ///< by the candidate's loops
  double by_graph_nats = 0.0;  ///< as the pose graph has it
  double true_nats = 0.0;      ///< by the true errors of the key-frames
};

struct TrialResult {
  double explored_share = 0.0, time_to_90_s = 0.0, path_m = 0.0;
  double done_s = 0.0;  ///< when nothing was left to explore; the mission time when that did not happen
  double ate_se3_m = 0.0, ate_raw_m = 0.0;
  double surviving_share = 0.0;  ///< of the map's evidence, by the true errors of the key-frames
  double predicted_share = 0.0;  ///< the same, by the pose graph
  int keyframes = 0, loops = 0, decisions = 0, revisits = 0;
  double decision_cpu_s = 0.0, cpu_s = 0.0;
  std::vector<Gain> gains;  ///< of each decision but the last one, with TrialSetting::with_gains
};

/// A mission without images, controller and DDS: real planner and map, depth by rays, a robot that follows its path,
/// and poses by PoseModel. Deterministic.
/// @throws std::runtime_error with one line that says what is wrong
TrialResult run_trial(const simulator::World& world, const TrialSetting& setting, const ErrorModel& errors);

}  // namespace lapis::planner::benchmark
