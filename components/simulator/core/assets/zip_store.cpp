#include "simulator/core/assets/zip_store.hpp"

#include <zip.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>

namespace lapis::simulator {
namespace {

constexpr std::size_t kLeastStep = 1 << 20;  // [bytes]

struct CloseEntry {
  void operator()(zip_file* entry) const { zip_fclose(entry); }
};

std::string reason_of(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  std::string reason = zip_error_strerror(&error);
  zip_error_fini(&error);
  return reason;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

bool is_encrypted(const zip_stat_t& stat) {
  return (stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE;
}

}  // namespace

void ZipStore::Close::operator()(zip* archive) const { zip_discard(archive); }

ZipStore::ZipStore(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) fail(file, "no such file; check the path");
  if (std::filesystem::file_size(file, error) == 0) fail(file, "the archive is empty (0 bytes); fetch it again");
  int code = 0;
  archive_.reset(zip_open(file.c_str(), ZIP_RDONLY, &code));
  if (!archive_) fail(file, "not a whole zip archive (" + reason_of(code) + "); fetch it again");
  list_entries();
}

void ZipStore::list_entries() {
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive_.get(), 0));
  for (std::uint64_t i = 0; i < count; ++i) {
    zip_stat_t stat;
    if (zip_stat_index(archive_.get(), i, ZIP_FL_ENC_GUESS, &stat) != 0) continue;
    const std::string name = stat.name;
    if (name.empty() || name.back() == '/') continue;  // a folder
    if (is_encrypted(stat)) fail(file_, "'" + name + "' is encrypted; make the archive without a password");
    entries_.try_emplace(name, Entry{i, stat.size});
  }
}

std::optional<std::vector<std::uint8_t>> ZipStore::read(const std::string& name) const {
  const auto found = entries_.find(name);
  if (found == entries_.end() || found->second.size > kMaxEntryBytes) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const std::unique_ptr<zip_file, CloseEntry> entry(zip_fopen_index(archive_.get(), found->second.index, 0));
  if (!entry) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < found->second.size) {  // in steps: the announced size may be far more than the data
    const std::size_t had = bytes.size();
    bytes.resize(std::min<std::size_t>(found->second.size, had + std::max(had, kLeastStep)));
    const std::size_t wanted = bytes.size() - had;
    if (zip_fread(entry.get(), bytes.data() + had, wanted) != static_cast<zip_int64_t>(wanted)) return std::nullopt;
  }
  std::uint8_t beyond = 0;  // reading past the end checks the CRC, and finds files longer than announced
  if (zip_fread(entry.get(), &beyond, 1) != 0) return std::nullopt;
  return bytes;
}

std::vector<std::string> ZipStore::names() const {
  std::vector<std::string> result;
  for (const auto& [name, entry] : entries_) result.push_back(name);
  return result;
}

}  // namespace lapis::simulator
