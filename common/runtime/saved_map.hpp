#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/runtime/context.hpp"

namespace lapis::runtime {

struct SavedMapConfig {
  std::string component;    ///< name of the component, whose keys are COMPONENT.output_dir and COMPONENT.resume_from
  std::string folder;       ///< empty: the map is not kept
  std::string resume_from;  ///< file of an earlier session; empty: none
  std::vector<std::string> files;  ///< names in the folder, of one map; resume_from may be any of them
  double period_s = 0.0;           ///< time between saves [s]; 0: at the end only
};

/// Manages a component's map on disk: resumes the map of an earlier session or begins a new one, renames the files of
/// the previous map, and says when the map is due to be saved.
class SavedMap {
 public:
  /// Throws std::runtime_error when no files can be written into the folder.
  SavedMap(SavedMapConfig config, Context& context);

  bool is_kept() const { return !config_.folder.empty(); }
  std::string path(const std::string& name) const { return (std::filesystem::path(config_.folder) / name).string(); }

  /// Result of `read(path, error)` for the file to resume; empty without such a file. Throws std::runtime_error, which
  /// names the key and the reason, when the file cannot be read.
  template <class Read>
  auto resume(const Read& read) const {
    std::string error;
    decltype(read(config_.resume_from, error)) file;
    if (config_.resume_from.empty()) return file;
    const LongWork work(context_.heart(), "loads the map", kLongestLoading_s);
    file = read(config_.resume_from, error);
    if (!file) throw std::runtime_error(key() + ": " + error);
    return file;
  }
  /// Error text "slam.resume_from: FILE: WHAT" for a file that does not fit.
  std::string misfit(const std::string& what) const { return key() + ": " + config_.resume_from + ": " + what; }

  /// Begins a map at `stamp`. Files of the previous map are kept under another name, except when one of them was
  /// resumed: the new files include their content.
  void begin(time::Time stamp, bool is_resumed);
  /// True when a period has passed since the map was begun or last saved.
  bool is_due(time::Time now) const;
  void note_save(time::Time now) { saved_ = now; }

 private:
  static constexpr double kLongestLoading_s = 300.0;

  std::string key() const { return config_.component + ".resume_from"; }
  void set_aside(bool is_resumed) const;

  const SavedMapConfig config_;
  Context& context_;
  time::Time saved_;
};

}  // namespace lapis::runtime
