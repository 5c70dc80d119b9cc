#pragma once

#include <filesystem>

namespace lapis::test {

/// Writes scene.yaml, a small flat of two rooms with a door, some furniture and a short tour, and its list of classes,
/// into a folder; returns the scene's path. No model comes from outside.
std::filesystem::path write_small_scene(const std::filesystem::path& folder);

}  // namespace lapis::test
