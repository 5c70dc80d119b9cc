#include "sensor_replay/core/tum_lists.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <tuple>

#include "sensor_replay/core/text_table.hpp"

namespace lapis::sensor_replay {
namespace {

ListedImage parse_image(const std::filesystem::path& file, const TableRow& row, std::size_t first_field) {
  const std::string& text = row.fields[first_field];
  const auto stamp = parse_stamp(text);
  if (!stamp) fail_at(file, row.line, "\"" + text + "\" is not a time stamp in decimal seconds");
  return {*stamp, row.fields[first_field + 1]};
}

void check_fields(const std::filesystem::path& file, const TableRow& row, std::size_t count, const char* format) {
  if (row.fields.size() == count) return;
  fail_at(file, row.line,
          std::to_string(row.fields.size()) + " fields instead of " + std::to_string(count) + " (" + format +
              "; file names hold no blanks)");
}

void check_order(const std::filesystem::path& file, int line, time::Time previous, time::Time stamp) {
  if (stamp == previous) fail_at(file, line, "time stamp " + time::to_string(stamp) + " occurs twice");
  if (stamp < previous) {
    fail_at(file, line,
            "time stamps are not sorted: " + time::to_string(stamp) + " after " + time::to_string(previous));
  }
}

}  // namespace

std::vector<ListedImage> read_image_list(const std::filesystem::path& file) {
  std::vector<ListedImage> images;
  for (const TableRow& row : read_table(file)) {
    check_fields(file, row, 2, "stamp file");
    const ListedImage image = parse_image(file, row, 0);
    if (!images.empty()) check_order(file, row.line, images.back().stamp, image.stamp);
    images.push_back(image);
  }
  return images;
}

std::vector<ListedFrame> read_associations(const std::filesystem::path& file) {
  std::vector<ListedFrame> frames;
  std::set<std::string> depth_files;
  for (const TableRow& row : read_table(file)) {
    check_fields(file, row, 4, "colour stamp, file, depth stamp, file");
    ListedFrame frame{parse_image(file, row, 0), parse_image(file, row, 2)};
    if (!frames.empty()) check_order(file, row.line, frames.back().color.stamp, frame.color.stamp);
    if (!depth_files.insert(frame.depth->file).second) {
      fail_at(file, row.line, frame.depth->file + " belongs to two colour images");
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<Association> associate(const std::vector<time::Time>& first, const std::vector<time::Time>& second,
                                   time::Duration max_difference) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  std::size_t window = 0;  // first element of `second` that is not too early for the current stamp
  for (std::size_t i = 0; i < first.size(); ++i) {
    while (window < second.size() && second[window] < first[i] - max_difference) ++window;
    for (std::size_t j = window; j < second.size() && second[j] <= first[i] + max_difference; ++j) {
      candidates.emplace_back(time::abs(first[i] - second[j]).nanoseconds, i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<Association> pairs;
  std::vector<bool> is_first_used(first.size(), false);
  std::vector<bool> is_second_used(second.size(), false);
  for (const auto& [difference, i, j] : candidates) {
    if (is_first_used[i] || is_second_used[j]) continue;
    is_first_used[i] = is_second_used[j] = true;
    pairs.push_back({i, j});
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return pairs;
}

std::vector<ListedFrame> pair_by_stamp(const std::vector<ListedImage>& color, const std::vector<ListedImage>& depth,
                                       time::Duration max_difference) {
  const auto stamps = [](const std::vector<ListedImage>& images) {
    std::vector<time::Time> result;
    for (const ListedImage& image : images) result.push_back(image.stamp);
    return result;
  };
  std::vector<ListedFrame> frames;
  for (const ListedImage& image : color) frames.push_back({image, std::nullopt});
  for (const Association& pair : associate(stamps(color), stamps(depth), max_difference)) {
    frames[pair.first].depth = depth[pair.second];
  }
  return frames;
}

}  // namespace lapis::sensor_replay
