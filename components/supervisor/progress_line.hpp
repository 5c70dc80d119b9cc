#pragma once

#include <string>

namespace lapis::supervisor {

/// Shows how far a run is, on standard output. On a terminal each line replaces the one before.
class ProgressLine {
 public:
  /// Shows a text when it is another than before.
  void show(const std::string& text);
  /// What is shown next begins on a line of its own.
  void end();

 private:
  std::string shown_;
  bool is_open_ = false;
};

}  // namespace lapis::supervisor
