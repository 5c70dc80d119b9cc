#include "common/runtime/saved_map.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/logging/logging.hpp"

namespace lapis::runtime {

SavedMap::SavedMap(SavedMapConfig config, Context& context) : config_(std::move(config)), context_(context) {
  if (is_kept()) files::require_writable_folder(config_.folder, config_.component + ".output_dir");
}

void SavedMap::begin(time::Time stamp, bool is_resumed) {
  if (is_kept()) set_aside(is_resumed);
  saved_ = stamp;
}

void SavedMap::set_aside(bool is_resumed) const {
  const auto is_resumed_file = [this](const std::string& name) {
    std::error_code error;
    return std::filesystem::equivalent(path(name), config_.resume_from, error);
  };
  if (is_resumed && std::any_of(config_.files.begin(), config_.files.end(), is_resumed_file)) return;
  for (const std::string& name : config_.files) {
    if (const auto problem = files::set_aside(path(name))) spdlog::error(*problem);
  }
}

bool SavedMap::is_due(time::Time now) const {
  return is_kept() && config_.period_s > 0.0 && (now - saved_).seconds() >= config_.period_s;
}

}  // namespace lapis::runtime
