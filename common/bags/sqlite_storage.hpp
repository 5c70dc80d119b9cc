#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace lapis::bags {

/// An SQLite database and its prepared statements. Every function throws std::runtime_error, which names the file and
/// what SQLite says.
class Database {
 public:
  enum class Mode { kCreate /* the file must not exist */, kRead };
  Database(const std::filesystem::path& path, Mode mode);

  class Statement {
   public:
    void bind(int index, std::int64_t value);
    void bind(int index, const std::string& value);
    void bind(int index, const std::vector<std::uint8_t>& value);
    /// True while there are rows; a statement that returned false can be bound and run again.
    bool step();
    std::int64_t integer(int column) const;
    std::string text(int column) const;
    std::vector<std::uint8_t> bytes(int column) const;

   private:
    friend class Database;
    struct Deleter {
      void operator()(sqlite3_stmt* statement) const;
    };
    const Database* database_ = nullptr;
    std::unique_ptr<sqlite3_stmt, Deleter> handle_;
  };
  /// The database must not move while the statement is in use.
  Statement prepare(const std::string& sql) const;
  void run(const std::string& sql) const;
  /// Runs a statement once with texts in the places of its question marks.
  void run(const std::string& sql, const std::vector<std::string>& texts) const;
  std::set<std::string> columns(const std::string& table) const;

 private:
  void check(int code, int expected) const;
  struct Deleter {
    void operator()(sqlite3* handle) const;
  };
  std::string path_;
  std::unique_ptr<sqlite3, Deleter> handle_;
};

/// Writes a database in rosbag2's schema, version 4. What is written becomes part of the file at flush(); until close()
/// the newest part may be in SQLite's journal beside it (*.db3-wal), which SQLite reads, too.
class SqliteWriter : public StorageWriter {
 public:
  explicit SqliteWriter(const std::filesystem::path& path);

  std::size_t add_channel(const Channel& channel) override;
  void write(const Message& message) override;
  void flush() override;
  void close() override;
  std::uint64_t bytes() const override { return bytes_; }

 private:
  void begin();

  Database database_;
  Database::Statement insert_;
  std::size_t channels_ = 0;
  std::uint64_t bytes_ = 0;
  bool is_open_ = false;           // a transaction
  std::set<std::string> defined_;  // types
};

/// Reads a database of rosbag2, of any version of its schema. Receive times are all that it knows: publish times are
/// equal to them.
class SqliteReader : public StorageReader {
 public:
  explicit SqliteReader(const std::filesystem::path& path);

  const Contents& contents() const override { return contents_; }
  void select(const Selection& selection) override;
  std::optional<Message> next() override;

 private:
  void read_channels();

  Database database_;
  Contents contents_;
  std::map<std::int64_t, std::size_t> indexes_;  // of topic ids
  Database::Statement query_;
};

}  // namespace lapis::bags
