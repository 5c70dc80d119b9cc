#pragma once

// Makes what the core works with from the configuration.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/core/generator/building_kind.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "simulator/core/scene/scene_spec.hpp"
#include "simulator/core/simulation.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// The folder config/ that belongs to this executable: that of the source tree in which it was built, or
/// share/lapis/config beside an installed bin/.
/// @throws std::runtime_error when there is none.
std::filesystem::path config_folder();

/// Folder that keeps files of one kind between runs: lapis/NAME in the user's cache folder; empty when there is none.
std::filesystem::path cache_folder(const std::string& name);

/// Names of the bundled scenes, sorted.
std::vector<std::string> bundled_scenes();

/// Generates a building, with the labels of the bundled scenes.
SceneSpec generated_building(const BuildingName& name);

/// Opens the scene that the configuration names, furnished for its seed. The functions of this header throw
/// std::runtime_error with one line that names the file or key and the remedy.
Scene open_scene(const SimulatorConfig& config);
WorldConfig world_config(const Scene& scene, const SimulatorConfig& config);
World open_world(const SimulatorConfig& config);
SimulationConfig simulation_config(const SimulatorConfig& config);
/// Pose in a text "x y yaw_deg" [m, m, deg] such as simulator.start; nothing when the text has another form.
std::optional<StartPose> given_start(std::string_view text);
/// The configured start, or one that the seed draws when none is configured.
StartPose start_pose(const World& world, const SimulatorConfig& config);
/// Settings with which this robot drives a tour.
TourConfig tour_config(const SimulatorConfig& config);
/// The tour that the robot drives by itself; nothing when none is configured.
std::optional<TourFollower> plan_tour(const World& world, const StartPose& start, const SimulatorConfig& config);

}  // namespace lapis::simulator
