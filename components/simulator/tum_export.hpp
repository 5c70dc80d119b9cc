#pragma once

#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Drives the configured tour (the bundled one by default) and writes what the robot sees, with noise, as a data set in
/// the layout of the TUM RGB-D benchmark, with label/, classes.csv, camera.yaml and ground_truth/, into
/// config.export_dir. Lock-step of sensor_replay on it gives what a run of the simulator would have given, but for
/// wheel odometry and IMU. The ground truth is for a mapper that nobody configured. Returns the exit status.
int export_tum(const SimulatorConfig& config);

}  // namespace lapis::simulator
