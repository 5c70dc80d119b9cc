#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// One line of rgb.txt or depth.txt: the stamp of an image and its path relative to the data set's folder.
struct ListedImage {
  time::Time stamp;
  std::string file;
};

/// A colour image and its depth image, if there is one.
struct ListedFrame {
  ListedImage color;
  std::optional<ListedImage> depth;
};

/// A pair of associated elements, as indices into the two lists.
struct Association {
  std::size_t first = 0;
  std::size_t second = 0;
};

/// Reads rgb.txt or depth.txt ("stamp file"), whose stamps must increase strictly.
/// @throws std::runtime_error naming file and line for bad numbers, missing fields, unsorted or repeated stamps.
std::vector<ListedImage> read_image_list(const std::filesystem::path& file);

/// Reads associations.txt ("stamp file stamp file", colour first). Colour stamps must increase strictly, and no depth
/// image may occur twice.
/// @throws std::runtime_error like read_image_list.
std::vector<ListedFrame> read_associations(const std::filesystem::path& file);

/// Pairs two sorted lists of stamps one to one, the smallest difference first (as the TUM benchmark's own tool does),
/// up to `max_difference`. Ties go to the earlier stamps. Sorted by the first index.
std::vector<Association> associate(const std::vector<time::Time>& first, const std::vector<time::Time>& second,
                                   time::Duration max_difference);

/// Frames of two lists: every colour image, with the depth image that `associate` assigns to it.
std::vector<ListedFrame> pair_by_stamp(const std::vector<ListedImage>& color, const std::vector<ListedImage>& depth,
                                       time::Duration max_difference);

}  // namespace lapis::sensor_replay
