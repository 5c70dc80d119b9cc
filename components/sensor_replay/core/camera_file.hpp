#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "common/geometry/pinhole_camera.hpp"
#include "sensor_replay/core/camera_mount.hpp"

namespace lapis::sensor_replay {

/// What camera.yaml of a data set says. Colour and depth are registered and share one camera.
struct CameraFile {
  geometry::PinholeCamera camera;
  std::array<double, 5> distortion{};  ///< plumb_bob k1 k2 p1 p2 k3, each -10 to 10; absent = all 0
  double depth_scale = 0.0;            ///< value of a depth pixel per metre, 1 to 100000 (TUM 5000, millimetres 1000)
  double fps = 0.0;                    ///< nominal rate of the frames [Hz], 0.1 to 1000
  CameraMount mount;                   ///< camera_height [m] and pitch_down_deg; absent = 0
};

/// Reads camera.yaml.
/// @throws std::runtime_error naming file, line, key, value and bound for missing or unknown keys and bad values. When
///   the file does not exist the message shows what to write into it.
CameraFile read_camera_file(const std::filesystem::path& file);

/// A camera.yaml, as one line, for an original TUM sequence; its name ("rgbd_dataset_freiburg1_xyz") tells the camera.
std::string example_camera_file(const std::string& sequence_name);

}  // namespace lapis::sensor_replay
