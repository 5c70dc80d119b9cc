#include "sensor_replay/core/class_list.hpp"

#include <map>
#include <stdexcept>

#include "sensor_replay/core/text_table.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr double kMaxClassId = 65535;

std::uint16_t parse_id(const std::filesystem::path& file, const TableRow& row) {
  const auto id = parse_number(row.fields[0]);
  const bool is_id = id && *id >= 0 && *id <= kMaxClassId && *id == static_cast<double>(static_cast<int>(*id));
  if (!is_id) fail_at(file, row.line, "class_id must be a whole number from 0 to 65535, not \"" + row.fields[0] + "\"");
  return static_cast<std::uint16_t>(*id);
}

}  // namespace

std::vector<ClassName> read_class_list(const std::filesystem::path& file) {
  const std::vector<TableRow> rows = read_table(file, ',');
  if (rows.empty() || rows[0].fields.size() < 2 || rows[0].fields[0] != "class_id" || rows[0].fields[1] != "class") {
    throw std::runtime_error(file.string() + ": must begin with the header line \"class_id,class\"");
  }
  std::map<std::uint16_t, std::string> names;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const TableRow& row = rows[i];
    if (row.fields.size() < 2 || row.fields[1].empty()) fail_at(file, row.line, "the class has no name");
    const std::uint16_t id = parse_id(file, row);
    if (!names.emplace(id, row.fields[1]).second) {
      fail_at(file, row.line, "class_id " + std::to_string(id) + " occurs twice");
    }
  }
  std::vector<ClassName> classes;
  for (const auto& [id, name] : names) {
    if (id != 0) classes.push_back({id, name});
  }
  return classes;
}

ClassName unnamed_class(std::uint16_t id) { return {id, "class_" + std::to_string(id)}; }

}  // namespace lapis::sensor_replay
