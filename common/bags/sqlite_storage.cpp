#include "common/bags/sqlite_storage.hpp"

#include <algorithm>
#include <stdexcept>

#include <sqlite3.h>

namespace lapis::bags {
namespace {

// rosbag2's layout (rosbag2_storage_sqlite3, schema version 4).
constexpr const char* kSchema = R"(
  CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
  CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
  CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
                      offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
  CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
                                   encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
  CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                        data BLOB NOT NULL);
  CREATE INDEX timestamp_idx ON messages (timestamp ASC);
  INSERT INTO schema(schema_version, ros_distro) VALUES (4, 'jazzy');
)";

int flags(Database::Mode mode) {
  return mode == Database::Mode::kCreate ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXCLUSIVE
                                         : SQLITE_OPEN_READONLY;
}

}  // namespace

void Database::Deleter::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
void Database::Statement::Deleter::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Database::Database(const std::filesystem::path& path, Mode mode) : path_(path.string()) {
  if (mode == Mode::kCreate && std::filesystem::exists(path)) throw std::runtime_error(path_ + ": exists already");
  if (mode == Mode::kRead && !std::filesystem::is_regular_file(path))
    throw std::runtime_error(path_ + ": no such file");
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(path_.c_str(), &opened, flags(mode), nullptr);
  handle_.reset(opened);
  check(code, SQLITE_OK);
  sqlite3_extended_result_codes(opened, 1);
  if (mode == Mode::kRead) run("SELECT count(*) FROM sqlite_master");  // reads the header
}

void Database::check(int code, int expected) const {
  if (code != expected) throw std::runtime_error(path_ + ": " + sqlite3_errmsg(handle_.get()));
}

Database::Statement Database::prepare(const std::string& sql) const {
  sqlite3_stmt* prepared = nullptr;
  const int code = sqlite3_prepare_v2(handle_.get(), sql.c_str(), static_cast<int>(sql.size()), &prepared, nullptr);
  check(code, SQLITE_OK);
  Statement statement;
  statement.database_ = this;
  statement.handle_.reset(prepared);
  return statement;
}

void Database::run(const std::string& sql) const {
  check(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
}

void Database::run(const std::string& sql, const std::vector<std::string>& texts) const {
  Statement statement = prepare(sql);
  for (std::size_t i = 0; i < texts.size(); ++i) statement.bind(static_cast<int>(i) + 1, texts[i]);
  statement.step();
}

std::set<std::string> Database::columns(const std::string& table) const {
  std::set<std::string> names;
  Statement info = prepare("PRAGMA table_info(" + table + ")");
  while (info.step()) names.insert(info.text(1));
  return names;
}

void Database::Statement::bind(int index, std::int64_t value) {
  database_->check(sqlite3_bind_int64(handle_.get(), index, value), SQLITE_OK);
}

void Database::Statement::bind(int index, const std::string& value) {
  database_->check(
      sqlite3_bind_text(handle_.get(), index, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT),
      SQLITE_OK);
}

void Database::Statement::bind(int index, const std::vector<std::uint8_t>& value) {
  database_->check(sqlite3_bind_blob64(handle_.get(), index, value.data(), value.size(), SQLITE_TRANSIENT), SQLITE_OK);
}

bool Database::Statement::step() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  sqlite3_reset(handle_.get());
  database_->check(code, SQLITE_DONE);
  return false;
}

std::int64_t Database::Statement::integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }

std::string Database::Statement::text(int column) const {
  const std::vector<std::uint8_t> found = bytes(column);
  return {found.begin(), found.end()};
}

std::vector<std::uint8_t> Database::Statement::bytes(int column) const {
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(handle_.get(), column));
  const int size = sqlite3_column_bytes(handle_.get(), column);
  if (data == nullptr || size <= 0) return {};
  return {data, data + size};
}

SqliteWriter::SqliteWriter(const std::filesystem::path& path) : database_(path, Database::Mode::kCreate) {
  database_.run("PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;");
  database_.run(kSchema);
  insert_ = database_.prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)");
}

void SqliteWriter::begin() {
  if (!is_open_) database_.run("BEGIN");
  is_open_ = true;
}

std::size_t SqliteWriter::add_channel(const Channel& channel) {
  begin();
  database_.run(
      "INSERT INTO topics(name, type, serialization_format, offered_qos_profiles, type_description_hash) "
      "VALUES (?, ?, ?, ?, ?)",
      {channel.topic, channel.type, channel.encoding, channel.offered_qos, channel.type_hash});
  if (!channel.schema.empty() && defined_.insert(channel.type).second) {
    database_.run(
        "INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, type_description_hash) "
        "VALUES (?, ?, ?, ?)",
        {channel.type, channel.schema_encoding, channel.schema, channel.type_hash});
  }
  return channels_++;
}

void SqliteWriter::write(const Message& message) {
  begin();
  insert_.bind(1, static_cast<std::int64_t>(message.channel) + 1);
  insert_.bind(2, message.log_time_ns);
  insert_.bind(3, message.data);
  insert_.step();
  bytes_ += message.data.size();
}

void SqliteWriter::flush() {
  if (is_open_) database_.run("COMMIT");
  is_open_ = false;
}

void SqliteWriter::close() {
  flush();
  insert_ = {};
  database_.run("PRAGMA journal_mode=DELETE");  // all into one file
}

SqliteReader::SqliteReader(const std::filesystem::path& path) : database_(path, Database::Mode::kRead) {
  if (database_.columns("topics").empty() || database_.columns("messages").empty()) {
    throw std::runtime_error(path.string() + ": is no database of rosbag2 (no tables 'topics' and 'messages')");
  }
  read_channels();
  auto times = database_.prepare("SELECT min(timestamp), max(timestamp) FROM messages");
  if (times.step()) {
    contents_.first_ns = times.integer(0);
    contents_.last_ns = times.integer(1);
  }
  select({});
}

void SqliteReader::read_channels() {
  const auto columns = database_.columns("topics");
  const auto optional = [&](const char* column) { return columns.contains(column) ? column : "''"; };
  const std::string sql = std::string("SELECT id, name, type, serialization_format, ") +
                          optional("offered_qos_profiles") + ", " + optional("type_description_hash") +
                          " FROM topics ORDER BY id";
  auto topics = database_.prepare(sql);
  while (topics.step()) {
    indexes_[topics.integer(0)] = contents_.channels.size();
    contents_.channels.push_back({.topic = topics.text(1),
                                  .type = topics.text(2),
                                  .encoding = topics.text(3),
                                  .schema_encoding = "",
                                  .schema = "",
                                  .type_hash = topics.text(5),
                                  .offered_qos = topics.text(4)});
    contents_.message_counts.push_back(0);
  }
  auto counts = database_.prepare("SELECT topic_id, count(*) FROM messages GROUP BY topic_id");
  while (counts.step()) {
    const auto index = indexes_.find(counts.integer(0));
    if (index != indexes_.end())
      contents_.message_counts[index->second] = static_cast<std::uint64_t>(counts.integer(1));
  }
  if (database_.columns("message_definitions").empty()) return;
  auto definitions =
      database_.prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
  while (definitions.step()) {
    for (Channel& channel : contents_.channels) {
      if (channel.type != definitions.text(0)) continue;
      channel.schema_encoding = definitions.text(1);
      channel.schema = definitions.text(2);
    }
  }
}

void SqliteReader::select(const Selection& selection) {
  std::string ids;
  for (const auto& [id, index] : indexes_) {
    if (selection.topics && !selection.topics->contains(contents_.channels[index].topic)) continue;
    ids += (ids.empty() ? "" : ", ") + std::to_string(id);
  }
  std::string sql = "SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN (" + ids + ")";
  if (selection.from_ns) sql += " AND timestamp >= " + std::to_string(*selection.from_ns);
  if (selection.to_ns) sql += " AND timestamp <= " + std::to_string(*selection.to_ns);
  query_ = database_.prepare(sql + " ORDER BY timestamp, id");
}

std::optional<Message> SqliteReader::next() {
  if (!query_.step()) {
    query_ = database_.prepare("SELECT topic_id, timestamp, data FROM messages WHERE 0");  // stay at the end
    return std::nullopt;
  }
  const std::int64_t time_ns = query_.integer(1);
  return Message{indexes_.at(query_.integer(0)), 0, time_ns, time_ns, query_.bytes(2)};
}

}  // namespace lapis::bags
