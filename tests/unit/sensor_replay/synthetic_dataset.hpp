#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include "common/geometry/image.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::sensor_replay::test {

using lapis::test::TemporaryFolder;

inline constexpr int kWidth = 32;
inline constexpr int kHeight = 24;
inline constexpr const char* kCameraFile =
    "width: 32\nheight: 24\nfx: 20.0\nfy: 21.0\ncx: 15.5\ncy: 11.5\ndistortion: [0, 0, 0, 0, 0]\n"
    "depth_scale: 1000.0\nfps: 10.0\n";

/// Formulas of the synthetic images, so that a test knows every pixel.
geometry::Rgb8 synthetic_color(int frame, int column, int row);
std::uint16_t synthetic_depth(int frame, int column, int row);
std::uint16_t synthetic_label(int frame, int column, int row);

/// Writes a whole TUM RGB-D folder: PNG images of 32 x 24 pixels at 10 Hz, lists, camera.yaml, labels 1 to 3, and a
/// ground truth that moves 0.1 m along x per frame. No associations.txt.
void write_dataset(const std::filesystem::path& folder, int frames);

void write_text(const std::filesystem::path& file, const std::string& text);
std::string read_text(const std::filesystem::path& file);
/// Keeps the first `share` of a file's bytes.
void truncate(const std::filesystem::path& file, double share);

void write_gray8(const std::filesystem::path& file, int width, int height, int value);
void write_gray16(const std::filesystem::path& file, const geometry::Image<std::uint16_t>& image);
void write_rgb8(const std::filesystem::path& file, int width, int height);

/// Message of the std::exception that `action` throws; empty when it throws none.
std::string error_of(const std::function<void()>& action);

}  // namespace lapis::sensor_replay::test
