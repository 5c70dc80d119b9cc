#include "simulator/core/assets/asset_store.hpp"

#include <algorithm>
#include <system_error>

#include "common/files/atomic_file.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;

bool leaves_folder(const fs::path& normal) { return normal.empty() || normal.is_absolute() || *normal.begin() == ".."; }

}  // namespace

std::optional<std::vector<std::uint8_t>> FolderStore::read(const std::string& name) const {
  const fs::path normal = fs::path(name).lexically_normal();
  if (leaves_folder(normal)) return std::nullopt;
  std::string reason;  // unused: whoever needs the file reports it
  return files::read_file((folder_ / normal).string(), reason);
}

std::vector<std::string> FolderStore::names() const {
  std::vector<std::string> result;
  std::error_code error;
  const auto options = fs::directory_options::skip_permission_denied;
  for (auto it = fs::recursive_directory_iterator(folder_, options, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    std::error_code unreadable;
    if (it->is_regular_file(unreadable)) result.push_back(it->path().lexically_relative(folder_).generic_string());
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace lapis::simulator
