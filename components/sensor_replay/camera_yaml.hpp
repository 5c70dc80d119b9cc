#pragma once

#include <filesystem>
#include <string>

#include "sensor_replay/core/camera_file.hpp"

namespace lapis::sensor_replay {

/// Reads camera.yaml.
/// @throws std::runtime_error naming file, line, key, value and bound for missing or unknown keys and bad values. When
///   the file does not exist the message shows what to write into it.
CameraFile read_camera_file(const std::filesystem::path& file);

/// A camera.yaml, as one line, for an original TUM sequence; its name ("rgbd_dataset_freiburg1_xyz") says which camera.
std::string example_camera_file(const std::string& sequence_name);

}  // namespace lapis::sensor_replay
