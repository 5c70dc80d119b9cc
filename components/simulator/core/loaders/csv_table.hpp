#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lapis::simulator {

/// Fields of one line. A field in double quotes may contain the separator, and "" for a quote.
std::vector<std::string> split_fields(std::string_view line, char separator);

/// A text table whose first line names the columns. Empty lines are left out.
class CsvTable {
 public:
  struct Row {
    std::size_t line = 0;  ///< line number in the file, from 1
    std::vector<std::string> fields;
  };

  /// `file` is the name that messages show. Fields beyond the columns that the header names are ignored.
  CsvTable(std::string_view text, char separator, std::string file);

  const std::vector<Row>& rows() const { return rows_; }
  bool has(std::string_view column) const;
  /// @throws std::runtime_error naming file and line when there is no such column or the row is too short.
  const std::string& at(const Row& row, std::string_view column) const;
  /// A whole number from 0 to `largest`. @throws std::runtime_error naming file, line and column.
  std::size_t index_at(const Row& row, std::string_view column, std::size_t largest) const;
  /// A finite number. @throws std::runtime_error naming file, line and column.
  float float_at(const Row& row, std::string_view column) const;
  [[noreturn]] void fail(const Row& row, const std::string& what) const;

 private:
  std::string file_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

}  // namespace lapis::simulator
