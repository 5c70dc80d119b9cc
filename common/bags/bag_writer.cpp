#include "common/bags/bag_writer.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/bags/sqlite_storage.hpp"
#include "common/files/atomic_file.hpp"

namespace lapis::bags {

const char* name_of(Storage storage) { return storage == Storage::kMcap ? "mcap" : "sqlite3"; }

BagWriter::BagWriter(const std::filesystem::path& folder, const BagOptions& options)
    : folder_(std::filesystem::absolute(folder).lexically_normal()), options_(options) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "bag/"
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw std::runtime_error(folder_.string() + ": " + error.message());
  if (!std::filesystem::is_empty(folder_)) throw std::runtime_error(folder_.string() + ": is not empty");
  begin_file();
  write_metadata();
}

void BagWriter::begin_file() {
  const bool is_mcap = options_.storage == Storage::kMcap;
  const std::string name =
      folder_.filename().string() + "_" + std::to_string(files_.size()) + (is_mcap ? ".mcap" : ".db3");
  if (is_mcap) {
    file_ = std::make_unique<McapWriter>(folder_ / name, options_.mcap);
  } else {
    file_ = std::make_unique<SqliteWriter>(folder_ / name);
  }
  for (const Channel& channel : contents_.channels) file_->add_channel(channel);
  files_.push_back({name, contents_.last_ns, contents_.last_ns, 0});
}

std::size_t BagWriter::add_channel(const Channel& channel) {
  file_->add_channel(channel);
  contents_.channels.push_back(channel);
  contents_.message_counts.push_back(0);
  return contents_.channels.size() - 1;
}

bool BagWriter::is_full(const Message& message) const {
  const FileSummary& file = files_.back();
  if (file.messages == 0) return false;
  const double spanned_s = 1e-9 * static_cast<double>(message.log_time_ns - file.first_ns);
  return (options_.split_bytes > 0 && file_->bytes() >= options_.split_bytes) ||
         (options_.split_s > 0.0 && spanned_s >= options_.split_s);
}

void BagWriter::write(const Message& message) {
  if (is_full(message)) {
    file_->close();
    begin_file();
    write_metadata();
  }
  file_->write(message);
  FileSummary& file = files_.back();
  const std::int64_t time_ns = message.log_time_ns;
  const auto extend = [&](std::int64_t& first_ns, std::int64_t& last_ns, bool is_first) {
    first_ns = is_first ? time_ns : std::min(first_ns, time_ns);
    last_ns = is_first ? time_ns : std::max(last_ns, time_ns);
  };
  extend(contents_.first_ns, contents_.last_ns, contents_.message_count() == 0);
  extend(file.first_ns, file.last_ns, file.messages == 0);
  ++file.messages;
  ++contents_.message_counts[message.channel];
}

void BagWriter::flush() {
  file_->flush();
  write_metadata();
}

void BagWriter::close() {
  file_->close();
  write_metadata();
}

void BagWriter::write_metadata() const {
  files::replace_text(folder_ / "metadata.yaml", format_metadata(name_of(options_.storage), contents_, files_));
}

}  // namespace lapis::bags
