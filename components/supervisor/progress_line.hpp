#pragma once

#include <string>

namespace lapis::supervisor {

/// Shows the progress of a run on standard output. On a terminal, each line replaces the previous one.
class ProgressLine {
 public:
  /// Shows a text when it differs from the previous one.
  void show(const std::string& text);
  /// Ends the line, so that further output begins on a new line.
  void end();

 private:
  std::string shown_;
  bool is_open_ = false;
};

}  // namespace lapis::supervisor
