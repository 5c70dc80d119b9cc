#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "slam/core/files/slam_file.hpp"

namespace lapis::slam {

/// Writes slam.lapis in a thread of its own, one file at a time. Used by one thread; its destructor waits for the file.
class MapSaver {
 public:
  struct Save {
    std::optional<std::string> problem;  ///< why the old file is still there; names the file
  };

  /// Begins to write; not while it is busy.
  void begin(const std::filesystem::path& path, SlamFile file);
  /// True from begin() until the result has been taken.
  bool is_busy() const { return writing_.valid(); }
  /// The result of a save that has ended, once.
  std::optional<Save> take_finished();
  /// The same, after waiting for its end.
  std::optional<Save> wait();

 private:
  std::future<Save> writing_;
};

}  // namespace lapis::slam
