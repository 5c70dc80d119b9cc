#pragma once

#include <map>
#include <string>
#include <vector>

#include "controller/controller_config.hpp"
#include "planner/core/exploration/path_ledger.hpp"
#include "planner/planner_config.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::planner::benchmark {

struct ExplorationSetting {
  simulator::SimulatorConfig simulated;
  PlannerComponentConfig planner;
  controller::ControllerComponentConfig controller;
  double longest_s = 300.0;  ///< of simulated time
  int known_places = 0;      ///< drawn of what is known at the end; driven to and back, twice
};

/// What is known at a time.
struct ExplorationMoment {
  double t_s = 0.0;
  Pose2 robot;                  ///< true, in the map frame
  double explored_share = 0.0;  ///< of what is explorable
  std::string doing;            ///< the planner's reason
};

struct Exploration {
  std::vector<ExplorationMoment> moments;  ///< one a second, and the end
  State state = State::kIdle;              ///< at the end
  double path_m = 0.0;
  std::vector<ExplorationMoment> contacts;  ///< when the robot came to touch something
  int decisions = 0;
  double decision_cpu_s = 0.0;
  std::vector<DrivenPath> paths;
  std::vector<DrivenPath> known_paths;   ///< to places that are known, and back, the first time
  std::vector<DrivenPath> driven_paths;  ///< the same ones, the second time
  std::map<std::string, double> left_m;  ///< length of the frontiers of the last decision, by why they were not judged

  /// When this share was explored [s]; infinite: never.
  double time_to_s(double share) const;
};

/// Explores with the real map, planner and controller, but at true poses, and with true depth and labels, five times a
/// second: no slam, no noise, no DDS. Deterministic.
/// @throws std::runtime_error with one line that says what is wrong
Exploration explore(const simulator::World& world, const ExplorationSetting& setting);

}  // namespace lapis::planner::benchmark
