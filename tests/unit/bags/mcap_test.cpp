// MCAP's container: files that end anywhere, and those that others write.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include "common/bags/input_file.hpp"
#include "common/bags/mcap_reader.hpp"
#include "common/bags/mcap_writer.hpp"
#include "common/files/crc32.hpp"
#include "sample_messages.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::bags {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

class Mcap : public ::testing::Test {
 protected:
  void write_bytes(std::span<const std::uint8_t> bytes) const { test::write_file(path_, bytes); }

  /// A file of another writer: header, one schema, one channel, then whatever.
  static files::ByteWriter foreign_head() {
    files::ByteWriter out;
    out.raw(mcap::kMagic);
    put(out, mcap::Header{"ros2", "somebody"});
    put(out, mcap::Schema{7, "std_msgs/msg/String", "ros2msg", "string data\n"});
    put(out, mcap::Channel{9, 7, "/a", "cdr", {}});
    return out;
  }

  static std::vector<std::uint8_t> message_records(const std::vector<Message>& messages) {
    files::ByteWriter out;
    for (const Message& message : messages) {
      const auto time = static_cast<std::uint64_t>(message.log_time_ns);
      put(out, mcap::Message{9, message.sequence, time, time, message.data});
    }
    return out.take();
  }

  void expect_all(const std::vector<Message>& expected) const {
    McapReader reader(path_);
    const auto found = test::read_all(reader);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(test::is_same(found[i], expected[i])) << i;
    EXPECT_EQ(reader.contents().message_count(), expected.size());
  }

  lapis::test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "a.mcap";
};

TEST_F(Mcap, OfAKilledRecorderIsReadUpToItsLastWholeChunk) {
  const auto sent = test::sample_messages(120, 2, 60);
  {
    McapWriter writer(path_, {.compression_level = 1, .chunk_bytes = 512});
    writer.add_channel(test::sample_channel("/a"));
    writer.add_channel(test::sample_channel("/b"));
    for (const Message& message : sent) writer.write(message);
    writer.close();
  }
  const InputFile file(path_);
  const auto whole = file.read(0, file.size());
  std::size_t before = 0;
  for (std::size_t size = mcap::kMagic.size(); size < whole.size(); size += 7) {
    write_bytes(std::span(whole).first(size));
    McapReader reader(path_);
    const auto found = test::read_all(reader);
    ASSERT_GE(found.size(), before) << size;  // nothing that is whole is ever lost
    for (std::size_t i = before; i < found.size(); ++i) ASSERT_TRUE(test::is_same(found[i], sent[i])) << size;
    ASSERT_THAT(reader.contents().notes, SizeIs(1)) << size;
    before = found.size();
  }
  EXPECT_EQ(before, sent.size());
}

TEST_F(Mcap, OfChunksThatOverlapInTime) {
  files::ByteWriter out = foreign_head();
  const auto sent = test::sample_messages(60, 1);
  for (std::size_t first = 0; first < 3; ++first) {  // every third message in each of three chunks
    std::vector<Message> part;
    for (std::size_t i = first; i < sent.size(); i += 3) part.push_back(sent[i]);
    const auto records = message_records(part);
    const auto time = [](const Message& message) { return static_cast<std::uint64_t>(message.log_time_ns); };
    put(out, mcap::Chunk{time(part.front()), time(part.back()), records.size(), files::crc32(records), "", records});
  }
  write_bytes(out.bytes());
  expect_all(sent);
}

TEST_F(Mcap, OfMessagesOutsideOfChunks) {
  files::ByteWriter out = foreign_head();
  const auto sent = test::sample_messages(20, 1);
  out.raw(message_records(sent));
  mcap::put_data_end(out);
  put(out, mcap::Footer{});
  out.raw(mcap::kMagic);
  write_bytes(out.bytes());
  expect_all(sent);
  EXPECT_THAT(McapReader(path_).contents().notes, SizeIs(0));
}

TEST_F(Mcap, OfChunksInLz4) {
  files::ByteWriter out = foreign_head();
  const auto sent = test::sample_messages(100, 1);
  const auto records = message_records(sent);
  std::vector<std::uint8_t> packed(LZ4F_compressFrameBound(records.size(), nullptr));
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
  put(out, mcap::Chunk{0, 1, records.size(), files::crc32(records), "lz4", packed});
  write_bytes(out.bytes());
  expect_all(sent);
}

TEST_F(Mcap, LeavesOutAChunkThatIsDamagedAndSaysSo) {
  const auto sent = test::sample_messages(100, 1);
  {
    McapWriter writer(path_, {.compression_level = 0, .chunk_bytes = 1024});
    writer.add_channel(test::sample_channel("/a"));
    for (const Message& message : sent) writer.write(message);
    writer.close();
  }
  const InputFile file(path_);
  auto bytes = file.read(0, file.size());
  const auto& data = sent[50].data;
  const auto at = std::search(bytes.begin(), bytes.end(), data.begin(), data.end());
  ASSERT_NE(at, bytes.end());
  *at ^= 1;
  write_bytes(bytes);
  McapReader reader(path_);
  std::size_t errors = 0, read = 0;
  for (bool is_at_end = false; !is_at_end;) {
    try {
      is_at_end = !reader.next();
      read += is_at_end ? 0 : 1;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("checksum"));
      ++errors;
    }
  }
  EXPECT_EQ(errors, 1U);
  EXPECT_GT(read, 80U);
  EXPECT_LT(read, 100U);
}

TEST_F(Mcap, IgnoresFieldsAndRecordsOfTheFuture) {
  files::ByteWriter out = foreign_head();
  out.u8(0x70);  // a record of an unknown kind
  out.u64(3);
  out.raw(std::vector<std::uint8_t>{1, 2, 3});
  const auto sent = test::sample_messages(5, 1);
  out.raw(message_records(sent));
  write_bytes(out.bytes());
  expect_all(sent);
}

}  // namespace
}  // namespace lapis::bags
