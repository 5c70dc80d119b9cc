#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/runtime/context.hpp"

namespace lapis::runtime {

struct SavedMapConfig {
  std::string component;    ///< whose keys are COMPONENT.output_dir and COMPONENT.resume_from
  std::string folder;       ///< empty: the map is not kept
  std::string resume_from;  ///< file of an earlier session; empty: none
  std::vector<std::string>
      files;              ///< names in the folder; the first one is the map's own, of which the others are made
  double period_s = 0.0;  ///< between saves; 0: at the end only
};

/// The life of a component's map on disk: it resumes the one of an earlier session or begins anew, sets the files of
/// the one before aside, and is saved from time to time.
class SavedMap {
 public:
  /// Throws std::runtime_error when the folder cannot be written into.
  SavedMap(SavedMapConfig config, Context& context);

  bool is_kept() const { return !config_.folder.empty(); }
  std::string path(const std::string& name) const { return (std::filesystem::path(config_.folder) / name).string(); }

  /// What `read(path, error)` makes of the file to resume, if there is one. Throws std::runtime_error naming the key
  /// and why it cannot be read.
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
  /// "slam.resume_from: FILE: WHAT", for a file that does not fit.
  std::string misfit(const std::string& what) const { return key() + ": " + config_.resume_from + ": " + what; }

  /// A map begins. Files of the map before stay under another name, but for those of the map that is resumed: the new
  /// ones hold all of it.
  void begin(time::Time stamp, bool is_resumed);
  /// A period is over since it was begun or saved last.
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
