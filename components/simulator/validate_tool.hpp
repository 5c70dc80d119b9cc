#pragma once

#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Checks the configured scene, prints a table, and writes its navigation map as SCENE_navmap.png into
/// simulator.output_dir or, without it, the current folder. Exit status: 0, or 1 when a check fails.
/// @throws std::runtime_error with one line for a scene that cannot be opened or a folder that cannot be written
int validate_scene(const SimulatorConfig& config);

}  // namespace lapis::simulator
