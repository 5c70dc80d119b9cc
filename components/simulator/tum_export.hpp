#pragma once

#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Drives the configured tour (the bundled one by default) and writes what the robot sees, with noise, as a data set in
/// the layout of the TUM RGB-D benchmark, with label/, classes.csv, camera.yaml and ground_truth/, into
/// config.export_dir. A replay of it with sensor_replay in lock-step gives the same as a run of the simulator, except
/// wheel odometry and IMU. The ground truth is for a mapper with the default configuration. Returns the exit status.
int export_tum(const SimulatorConfig& config);

}  // namespace lapis::simulator
