#pragma once

#include <chrono>
#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "slam/core/files/slam_file.hpp"

namespace lapis::slam {

/// Writes slam.lapis in a separate thread, one file at a time. For use by one thread; its destructor waits for the
/// file.
class MapSaver {
 public:
  struct Save {
    std::optional<std::string> problem;           ///< why the old file was not replaced; names the file
    std::chrono::steady_clock::time_point ended;  ///< when it was written, or had failed
  };

  /// True when a save may begin: none is under way, and together they take at most a twentieth of the time.
  bool is_free() const;
  /// Begins to write; not allowed while busy.
  void begin(const std::filesystem::path& path, SlamFile file);
  /// True from begin() until the result has been taken.
  bool is_busy() const { return writing_.valid(); }
  /// The result of a save that has ended; each result is returned once.
  std::optional<Save> take_finished();
  /// The same, after waiting for the save to end.
  std::optional<Save> wait();

 private:
  using Clock = std::chrono::steady_clock;

  Save note(Save save);

  std::future<Save> writing_;
  Clock::time_point began_;
  Clock::time_point next_;  // earliest begin of the next save
};

}  // namespace lapis::slam
