#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/sensors.hpp"
#include "simulator/simulator_config.hpp"
#include "slam/core/frame.hpp"

namespace lapis::slam::benchmark {

/// What slam gets for one frame of a tour, and where the camera truly was.
struct TourFrame {
  RgbdFrame frame;
  std::vector<simulator::WheelSample> wheels;  ///< since the frame before
  geometry::Pose T_map_camera;                 ///< true; the map's origin is where base_link began
};

/// Colour and depth as slam gets them.
RgbdFrame to_frame(time::Time stamp, const geometry::PinholeCamera& camera, const simulator::CameraImages& images);

/// Plays the tour of a simulated scene. With `folder`, the frames of a tour are kept there, 0.7 MB each, and read from
/// there the next time.
/// @throws std::runtime_error with one line that says what is wrong
void play_tour(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
               const std::function<void(const TourFrame&)>& take);

}  // namespace lapis::slam::benchmark
