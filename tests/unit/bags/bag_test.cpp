// Bags of both kinds: what was written is read again, whole, split, killed, in parts and compressed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bags/bag_reader.hpp"
#include "common/bags/bag_writer.hpp"
#include "common/bags/input_file.hpp"
#include "common/bags/sqlite_storage.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/zstd_codec.hpp"
#include "sample_messages.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::bags {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr std::size_t kCount = 500;

class Bag : public ::testing::TestWithParam<Storage> {
 protected:
  BagOptions options() const { return {.storage = GetParam(), .mcap = {.compression_level = 1, .chunk_bytes = 4096}}; }

  /// Writes the sample; it is closed only if told so.
  std::unique_ptr<BagWriter> write(const fs::path& folder, const BagOptions& options) const {
    auto writer = std::make_unique<BagWriter>(folder, options);
    for (const Channel& channel : channels_) writer->add_channel(channel);
    for (const Message& message : messages_) writer->write(message);
    return writer;
  }

  static void expect_same(const std::vector<Message>& found, const std::vector<Message>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(test::is_same(found[i], expected[i])) << i;
  }

  lapis::test::TemporaryFolder folder_;
  const std::vector<Channel> channels_{test::sample_channel("/a"), test::sample_channel("/b/c"),
                                       test::sample_channel("/d", "std_msgs/msg/Header")};
  const std::vector<Message> messages_ = test::sample_messages(kCount, 3);
};

TEST_P(Bag, GivesBackWhatWasWritten) {
  write(folder_.path() / "bag", options())->close();
  BagReader reader(folder_.path() / "bag");
  EXPECT_EQ(reader.contents().channels, channels_);
  EXPECT_THAT(reader.contents().message_counts, ::testing::ElementsAre(167, 167, 166));
  EXPECT_EQ(reader.contents().first_ns, messages_.front().log_time_ns);
  EXPECT_EQ(reader.contents().last_ns, messages_.back().log_time_ns);
  EXPECT_THAT(reader.contents().notes, IsEmpty());
  expect_same(test::read_all(reader), messages_);
  EXPECT_FALSE(reader.next());
  reader.select({});
  expect_same(test::read_all(reader), messages_);
}

TEST_P(Bag, IsReadInParts) {
  write(folder_.path() / "bag", options())->close();
  BagReader reader(folder_.path() / "bag");
  const std::int64_t from_ns = messages_[100].log_time_ns, to_ns = messages_[399].log_time_ns;
  reader.select({.topics = std::set<std::string>{"/a", "/d"}, .from_ns = from_ns, .to_ns = to_ns});
  std::vector<Message> expected;
  for (const Message& message : messages_) {
    const bool is_in = message.log_time_ns >= from_ns && message.log_time_ns <= to_ns;
    if (is_in && message.channel != 1) expected.push_back(message);
  }
  expect_same(test::read_all(reader), expected);
  reader.select({.topics = std::set<std::string>{}, .from_ns = {}, .to_ns = {}});
  EXPECT_FALSE(reader.next());
}

TEST_P(Bag, IsSplitBySizeAndByTime) {
  BagOptions by_size = options(), by_time = options();
  by_size.split_bytes = 10'000;
  by_time.split_s = 0.1;  // 100 messages
  const auto sized = write(folder_.path() / "sized", by_size);
  EXPECT_GT(sized->files().size(), 3U);
  sized->close();
  const auto timed = write(folder_.path() / "timed", by_time);
  EXPECT_EQ(timed->files().size(), 5U);
  timed->close();
  for (const char* name : {"sized", "timed"}) {
    BagReader reader(folder_.path() / name);
    expect_same(test::read_all(reader), messages_);
    fs::remove(folder_.path() / name / "metadata.yaml");
    BagReader without_metadata(folder_.path() / name);
    EXPECT_THAT(without_metadata.contents().notes, SizeIs(1));
    expect_same(test::read_all(without_metadata), messages_);
  }
}

TEST_P(Bag, ThatIsNotClosedHasAllThatWasFlushed) {
  const auto writer = write(folder_.path() / "bag", options());
  writer->flush();
  BagReader reader(folder_.path() / "bag");  // as after a kill: nothing else is written
  expect_same(test::read_all(reader), messages_);
}

TEST_P(Bag, OfDisorderedTimesIsReadInTheirOrder) {
  BagWriter writer(folder_.path() / "bag", options());
  writer.add_channel(channels_[0]);
  std::vector<Message> sent = test::sample_messages(200, 1);
  for (std::size_t i = 0; i + 1 < sent.size(); i += 2) std::swap(sent[i], sent[i + 1]);
  for (const Message& message : sent) writer.write(message);
  writer.close();
  BagReader reader(folder_.path() / "bag");
  expect_same(test::read_all(reader), test::sample_messages(200, 1));
}

TEST_P(Bag, OfMessagesThatAreCompressedOneByOne) {
  BagWriter writer(folder_.path() / "bag", options());
  writer.add_channel(channels_[0]);
  const std::vector<Message> sent = test::sample_messages(50, 1);
  for (Message message : sent) {
    message.data = files::zstd_compress(message.data, 1);
    writer.write(message);
  }
  writer.close();
  const fs::path metadata = folder_.path() / "bag" / "metadata.yaml";
  std::string error, text;
  const auto bytes = files::read_file(metadata.string(), error).value();
  text.assign(bytes.begin(), bytes.end());
  const auto set = [&](const std::string& key, const std::string& value) {
    const std::string old = key + ": \"\"";
    text.replace(text.find(old), old.size(), key + ": " + value);
  };
  set("compression_format", "zstd");
  set("compression_mode", "MESSAGE");
  files::replace_text(metadata, text);
  BagReader reader(folder_.path() / "bag");
  expect_same(test::read_all(reader), sent);
}

TEST_P(Bag, WhoseFileIsCompressedAsAWhole) {
  const auto writer = write(folder_.path() / "bag", options());
  writer->close();
  const fs::path plain = folder_.path() / "bag" / writer->files().front().name;
  const InputFile file(plain);
  const auto packed = files::zstd_compress(file.read(0, file.size()), 1);
  const fs::path zstd = folder_.path() / (plain.filename().string() + ".zstd");
  test::write_file(zstd, packed);
  EXPECT_TRUE(looks_like_a_bag(zstd));
  BagReader reader(zstd);
  expect_same(test::read_all(reader), messages_);
}

TEST_P(Bag, DoesNotReplaceAnother) {
  write(folder_.path() / "bag", options())->close();
  EXPECT_THAT([&] { BagWriter(folder_.path() / "bag", options()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("is not empty")));
}

TEST_P(Bag, SurvivesDamage) {
  const auto writer = write(folder_.path() / "bag", options());
  writer->close();
  const fs::path path = folder_.path() / "bag" / writer->files().front().name;
  const InputFile file(path);
  const auto whole = file.read(0, file.size());
  std::mt19937 random(2);
  int refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    auto bytes = whole;
    for (int change = 0; change < 3; ++change)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random());
    if (trial % 3 == 0) bytes.resize(random() % bytes.size());
    test::write_file(path, bytes);
    try {
      BagReader reader(folder_.path() / "bag");
      for (int errors = 0; errors < 100;) {
        try {
          if (!reader.next()) break;
        } catch (const std::runtime_error& error) {
          EXPECT_THAT(error.what(), HasSubstr(path.string()));
          ++errors;
        }
      }
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
      ++refused;
    }
  }
  EXPECT_LT(refused, 300);
}

INSTANTIATE_TEST_SUITE_P(Storages, Bag, ::testing::Values(Storage::kMcap, Storage::kSqlite3),
                         [](const auto& storage) { return name_of(storage.param); });

TEST(BagReader, NamesWhatIsWrong) {
  const lapis::test::TemporaryFolder folder;
  const auto read = [&](const char* name) { return [=, &folder] { BagReader reader(folder.path() / name); }; };
  const auto write = [&](const char* name, const std::string& text) {
    fs::create_directories((folder.path() / name).parent_path());
    files::replace_text(folder.path() / name, text);
  };
  EXPECT_THAT(read("none.mcap"), ThrowsMessage<std::runtime_error>(HasSubstr("none.mcap: no such file")));
  EXPECT_THAT(read(""), ThrowsMessage<std::runtime_error>(HasSubstr("no metadata.yaml and no files of bags")));
  write("text.mcap", "nothing");
  EXPECT_THAT(read("text.mcap"), ThrowsMessage<std::runtime_error>(HasSubstr("is no MCAP file")));
  write("text.db3", "SQLite format 3");
  EXPECT_THAT(read("text.db3"), ThrowsMessage<std::runtime_error>(HasSubstr("text.db3: ")));
  const std::string root = "rosbag2_bagfile_information:\n";
  write("rosbag1/metadata.yaml", root + "  storage_identifier: rosbag_v2\n  relative_file_paths: [a.bag]\n");
  EXPECT_THAT(read("rosbag1"), ThrowsMessage<std::runtime_error>(HasSubstr("storage 'rosbag_v2'")));
  write("empty/metadata.yaml", root + "  storage_identifier: mcap\n  relative_file_paths: []\n");
  EXPECT_THAT(read("empty"), ThrowsMessage<std::runtime_error>(HasSubstr("lists no files")));
  write("bare/metadata.yaml", root + "  storage_identifier: mcap\n");
  EXPECT_THAT(read("bare"), ThrowsMessage<std::runtime_error>(HasSubstr("'relative_file_paths'")));
  write("other/metadata.yaml", "a: 1\n");
  EXPECT_THAT(read("other"), ThrowsMessage<std::runtime_error>(HasSubstr("rosbag2_bagfile_information")));
  write("broken/metadata.yaml", "a: [\n");
  EXPECT_THAT(read("broken"), ThrowsMessage<std::runtime_error>(HasSubstr("metadata.yaml")));
  EXPECT_FALSE(looks_like_a_bag(folder.path() / "none"));
}

TEST(Sqlite, NeedsTheTablesOfRosbag2) {
  const lapis::test::TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db3";
  Database(path, Database::Mode::kCreate).run("CREATE TABLE topics(id INTEGER)");
  EXPECT_THAT([&] { BagReader reader(path); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no tables 'topics' and 'messages'")));
}

}  // namespace
}  // namespace lapis::bags
