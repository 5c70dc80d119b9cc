#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/sensors.hpp"
#include "simulator/simulator_config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/slam_config.hpp"

namespace lapis::slam::benchmark {

/// What slam gets for one frame of a tour, and where the camera truly was.
struct TourFrame {
  RgbdFrame frame;
  std::vector<simulator::OdometrySample> odometry;  ///< since the frame before
  geometry::Pose T_start_camera;                    ///< true; from where base_link began
};

/// Pose in the plane at height `z_m`.
geometry::Pose planar(const Eigen::Vector2d& position, double yaw_rad, double z_m = 0.0);
/// What slam is told of a reading: T_odom_base.
geometry::Pose pose_of(const simulator::OdometrySample& reading);
/// Colour and depth as slam gets them.
RgbdFrame to_frame(time::Time stamp, const geometry::PinholeCamera& camera, const simulator::CameraImages& images);

/// Black, without depth.
RgbdFrame black_frame(time::Time stamp, const geometry::PinholeCamera& camera);

/// A simulator with the bundled tour, and slam.
struct TourConfig {
  simulator::SimulatorConfig simulated;
  SlamComponentConfig slam;
};

/// The default configuration with assignments of the command line: slam.KEY=VALUE, simulator.KEY=VALUE,
/// robot.KEY=VALUE. `worlds`: files of config/worlds, applied before. Throws std::runtime_error with one line that says
/// what is wrong.
TourConfig tour_config(const std::vector<std::string>& assignments, const std::vector<std::string>& worlds = {});

/// Plays the tour of a simulated scene. With `folder`, the frames of a tour are kept there, 0.7 MB each, and read from
/// there the next time.
/// @throws std::runtime_error with one line that says what is wrong
void play_tour(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
               const std::function<void(const TourFrame&)>& take);

}  // namespace lapis::slam::benchmark
