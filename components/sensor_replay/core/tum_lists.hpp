#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// One line of rgb.txt or depth.txt: when an image was taken and where it lies, relative to the data set's folder.
struct ListedImage {
  time::Time stamp;
  std::string file;
};

/// A colour image and its depth image, if there is one.
struct ListedFrame {
  ListedImage color;
  std::optional<ListedImage> depth;
};

/// Pair of indices into the two lists that were associated.
struct Association {
  std::size_t first = 0;
  std::size_t second = 0;
};

/// Reads rgb.txt or depth.txt ("stamp file"), stamps strictly increasing.
/// @throws std::runtime_error naming file and line for bad numbers, missing fields, unsorted or repeated stamps.
std::vector<ListedImage> read_image_list(const std::filesystem::path& file);

/// Reads associations.txt ("stamp file stamp file", colour first), colour stamps strictly increasing, no depth image
/// twice.
/// @throws std::runtime_error as read_image_list.
std::vector<ListedFrame> read_associations(const std::filesystem::path& file);

/// Pairs two sorted lists of stamps one to one, the smallest difference first (as the TUM benchmark's own tool does),
/// up to `max_difference`. Ties go to the earlier stamps. Sorted by the first index.
std::vector<Association> associate(const std::vector<time::Time>& first, const std::vector<time::Time>& second,
                                   time::Duration max_difference);

/// Frames of two lists: every colour image, with the depth image that `associate` gives it.
std::vector<ListedFrame> pair_by_stamp(const std::vector<ListedImage>& color, const std::vector<ListedImage>& depth,
                                       time::Duration max_difference);

}  // namespace lapis::sensor_replay
