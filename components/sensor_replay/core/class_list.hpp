#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lapis::sensor_replay {

/// A class of the label images. Id 0 (unlabelled) is never listed.
struct ClassName {
  std::uint16_t id = 0;
  std::string name;
  bool operator==(const ClassName&) const = default;
};

/// Reads a CSV file whose header begins with "class_id,class"; further columns are ignored. Sorted by id.
/// @throws std::runtime_error naming file and line for a wrong header, ids that are not 1 to 65535 (0 is skipped),
///   empty names and ids that occur twice.
std::vector<ClassName> read_class_list(const std::filesystem::path& file);

/// "class_<id>", for data sets without a list.
ClassName unnamed_class(std::uint16_t id);

}  // namespace lapis::sensor_replay
