#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>

#include "common/geometry/image.hpp"

namespace lapis::sensor_replay {

/// z-depth in millimetres; 0 = no measurement.
using DepthMillimetres = geometry::Image<std::uint16_t>;

/// Why an image could not be used.
enum class ImageFault {
  kNotListed,       ///< the lists have no such image for this frame
  kMissing,         ///< the file does not exist or cannot be opened
  kUndecodable,     ///< truncated, or not an image
  kWrongSize,       ///< not the size in camera.yaml
  kWrongPixelType,  ///< wrong number of channels or bits
};

/// A few words for counters and messages: "truncated or not an image".
std::string to_string(ImageFault fault);

/// Size of an image [px].
struct ImageSize {
  int width = 0;
  int height = 0;
  bool operator==(const ImageSize&) const = default;
};

/// Reads an 8-bit colour image (JPEG or PNG).
std::variant<geometry::ColorImage, ImageFault> read_color(const std::filesystem::path& file, ImageSize size);

/// Reads a 16-bit depth PNG in units of 1/depth_scale metres and converts it to millimetres, rounded to the nearest.
/// The values 0 and 65535 and depths above 65534 mm become 0 (no measurement).
std::variant<DepthMillimetres, ImageFault> read_depth(const std::filesystem::path& file, ImageSize size,
                                                      double depth_scale);

/// Reads an 8-bit or 16-bit PNG of class ids.
std::variant<geometry::LabelImage, ImageFault> read_label(const std::filesystem::path& file, ImageSize size);

/// Size of a stored image of any type.
std::variant<ImageSize, ImageFault> read_size(const std::filesystem::path& file);

}  // namespace lapis::sensor_replay
