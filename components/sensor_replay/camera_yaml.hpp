#pragma once

#include <filesystem>
#include <string>

#include "sensor_replay/core/camera_file.hpp"

namespace lapis::sensor_replay {

/// Reads camera.yaml.
/// @throws std::runtime_error naming file, line, key, value and bound for missing or unknown keys and bad values. When
///   the file does not exist the message shows what to write into it.
CameraFile read_camera_file(const std::filesystem::path& file);

/// Content of a camera.yaml, in one line, for an original TUM sequence, whose name ("rgbd_dataset_freiburg1_xyz")
/// identifies the camera.
std::string example_camera_file(const std::string& sequence_name);

}  // namespace lapis::sensor_replay
