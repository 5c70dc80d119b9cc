#include "common/bags/bag_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include "common/bags/bag_metadata.hpp"
#include "common/bags/chunk_codec.hpp"
#include "common/bags/input_file.hpp"
#include "common/bags/mcap_reader.hpp"
#include "common/bags/output_file.hpp"
#include "common/bags/sqlite_storage.hpp"

namespace lapis::bags {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> kExtensions{".mcap", ".db3", ".zstd"};

bool has_bag_extension(const fs::path& path) {
  return std::find(kExtensions.begin(), kExtensions.end(), path.extension().string()) != kExtensions.end();
}

/// The number before the extension, for "bag_10.mcap" after "bag_9.mcap".
long number_of(const fs::path& path) {
  const std::string stem = path.stem().stem().string();
  const std::size_t at = stem.find_last_of('_');
  return at == std::string::npos ? 0 : std::strtol(stem.c_str() + at + 1, nullptr, 10);
}

std::vector<fs::path> bag_files(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && has_bag_extension(entry.path())) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(number_of(a), a) < std::pair(number_of(b), b);
  });
  return found;
}

bool starts_with(const std::vector<std::uint8_t>& bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::unique_ptr<StorageReader> open_storage(const fs::path& path) {
  const auto head = InputFile(path).read(0, 16);
  if (starts_with(head, "SQLite format 3")) return std::make_unique<SqliteReader>(path);
  return std::make_unique<McapReader>(path);
}

/// A file that exists as long as this.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::vector<std::uint8_t>& content) {
    std::string name = (fs::temp_directory_path() / "lapis_bag_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be created");
    folder_ = name;
    OutputFile file(path());
    file.append(content);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  fs::path path() const { return folder_ / "bag"; }

 private:
  fs::path folder_;
};

}  // namespace

struct BagReader::File {
  std::unique_ptr<TemporaryFile> unpacked;  // of a file that is compressed as a whole
  std::unique_ptr<StorageReader> reader;
  std::vector<std::size_t> channels;  // index in the bag of each of its channels
  std::optional<Message> ahead;       // its next message
  bool is_at_end = false;
};

bool looks_like_a_bag(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return fs::exists(path / "metadata.yaml", ignored) || !bag_files(path).empty();
  return has_bag_extension(path);
}

BagReader::BagReader(const fs::path& path) {
  if (!fs::is_directory(path)) {
    open(path);
  } else if (!fs::exists(path / "metadata.yaml")) {
    for (const fs::path& file : bag_files(path)) open(file);
    if (files_.empty()) throw std::runtime_error(path.string() + ": no metadata.yaml and no files of bags in it");
    contents_.notes.push_back("there is no metadata.yaml; all files of the folder are read");
  } else {
    const BagMetadata metadata = read_metadata(path / "metadata.yaml");
    if (metadata.storage != "mcap" && metadata.storage != "sqlite3") {
      throw std::runtime_error(path.string() + ": storage '" + metadata.storage + "' (known: mcap, sqlite3)");
    }
    if (!metadata.compression_format.empty() && metadata.compression_format != "zstd") {
      throw std::runtime_error(path.string() + ": compression '" + metadata.compression_format + "' (known: zstd)");
    }
    has_compressed_messages_ = metadata.compression_mode == "message" && !metadata.compression_format.empty();
    for (const std::string& file : metadata.files) open(path / file);
    if (files_.empty()) throw std::runtime_error((path / "metadata.yaml").string() + ": lists no files");
  }
  std::stable_sort(files_.begin(), files_.end(), [](const auto& a, const auto& b) {
    return a->reader->contents().first_ns < b->reader->contents().first_ns;
  });
}

BagReader::~BagReader() = default;
BagReader::BagReader(BagReader&&) noexcept = default;

void BagReader::open(const fs::path& path) {
  auto file = std::make_unique<File>();
  if (path.extension() == ".zstd") {
    const InputFile packed(path);
    try {
      file->unpacked = std::make_unique<TemporaryFile>(unpack_zstd(packed.read(0, packed.size())));
    } catch (const std::runtime_error& error) {
      packed.fail(error.what());
    }
  }
  file->reader = open_storage(file->unpacked ? file->unpacked->path() : path);
  merge(file->reader->contents(), *file);
  files_.push_back(std::move(file));
}

void BagReader::merge(const Contents& contents, File& file) {
  if (contents.message_count() > 0) {
    const bool is_first = contents_.message_count() == 0;
    contents_.first_ns = is_first ? contents.first_ns : std::min(contents_.first_ns, contents.first_ns);
    contents_.last_ns = is_first ? contents.last_ns : std::max(contents_.last_ns, contents.last_ns);
  }
  for (std::size_t i = 0; i < contents.channels.size(); ++i) {
    const Channel& channel = contents.channels[i];
    const auto known = std::find_if(contents_.channels.begin(), contents_.channels.end(), [&](const Channel& other) {
      return other.topic == channel.topic && other.type == channel.type && other.encoding == channel.encoding;
    });
    file.channels.push_back(static_cast<std::size_t>(known - contents_.channels.begin()));
    if (known == contents_.channels.end()) {
      contents_.channels.push_back(channel);
      contents_.message_counts.push_back(0);
    }
    contents_.message_counts[file.channels.back()] += contents.message_counts[i];
  }
  contents_.notes.insert(contents_.notes.end(), contents.notes.begin(), contents.notes.end());
}

void BagReader::select(const Selection& selection) {
  for (const auto& file : files_) {
    file->reader->select(selection);
    file->ahead.reset();
    file->is_at_end = false;
  }
}

std::optional<Message> BagReader::next() {
  File* first = nullptr;
  for (const auto& file : files_) {
    const bool may_come_first = first == nullptr || file->reader->contents().first_ns <= first->ahead->log_time_ns;
    if (!file->ahead && !file->is_at_end && may_come_first) {
      file->ahead = file->reader->next();
      file->is_at_end = !file->ahead;
    }
    if (file->ahead && (first == nullptr || file->ahead->log_time_ns < first->ahead->log_time_ns)) first = file.get();
  }
  if (first == nullptr) return std::nullopt;
  Message message = std::move(*first->ahead);
  first->ahead.reset();
  message.channel = first->channels.at(message.channel);
  if (has_compressed_messages_) message.data = unpack_zstd(message.data);
  return message;
}

}  // namespace lapis::bags
