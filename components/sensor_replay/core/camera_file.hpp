#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::sensor_replay {

/// A depth camera beside the colour camera.
struct DepthCameraFile {
  geometry::LensCamera camera;   ///< of the depth images as they are recorded
  geometry::Pose T_color_depth;  ///< in the optical frame of the colour camera
};

/// Content of a data set's camera.yaml.
struct CameraFile {
  geometry::PinholeCamera camera;               ///< of the colour images, and of labels
  std::optional<DepthCameraFile> depth_camera;  ///< none: depth is registered to colour, and shares its camera
  std::array<double, 5> distortion{};  ///< plumb_bob k1 k2 p1 p2 k3, of the recorded images, -10 to 10; absent = all 0
  double depth_scale = 0.0;            ///< value of a depth pixel per metre, 1 to 100000 (TUM 5000, millimetres 1000)
  double fps = 0.0;                    ///< nominal rate of the frames [Hz], 0.1 to 1000
  geometry::CameraMount mount;         ///< camera_height [m] and pitch_down_deg; absent = 0
};

/// Reads the calibration of a data set from a file of any format. Throws std::runtime_error, whose text names the file
/// and the remedy in one line.
using CameraReader = std::function<CameraFile(const std::filesystem::path& file)>;

}  // namespace lapis::sensor_replay
