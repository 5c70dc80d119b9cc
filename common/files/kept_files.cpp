#include "common/files/kept_files.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

namespace lapis::files {
namespace {

namespace fs = std::filesystem;

struct KeptFile {
  fs::path path;
  fs::file_time_type written;
  std::uintmax_t bytes = 0;
};

}  // namespace

void keep_newest(const fs::path& folder, const std::string& extension, std::uintmax_t most) {
  std::error_code problem;
  std::vector<KeptFile> files;
  for (const auto& entry : fs::directory_iterator(folder, problem)) {
    if (entry.path().extension() != extension) continue;
    const KeptFile file{entry.path(), entry.last_write_time(problem), entry.file_size(problem)};
    if (!problem) files.push_back(file);
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.written > b.written; });
  std::uintmax_t sum = 0;
  for (const KeptFile& file : files) {
    sum += file.bytes;
    if (sum > most) fs::remove(file.path, problem);
  }
}

}  // namespace lapis::files
