#include "simulator/core/assets/zip_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>

#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using test::Bytes;
using test::error_of;
using test::Files;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Bytes all_bytes() {
  Bytes bytes;
  for (int i = 0; i < 4096; ++i) bytes.push_back(static_cast<std::uint8_t>(i * i >> 3));
  return bytes;
}

const Files kFiles{{"b.txt", test::to_bytes("hello")}, {"a/deep/x y.bin", all_bytes()}, {"empty", {}}, {"a/", {}}};

class ZipStoreTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "library.zip";
};

TEST_F(ZipStoreTest, GivesBackWhatWasPacked) {
  test::write_zip(file_, kFiles);
  const ZipStore store(file_);
  EXPECT_THAT(store.names(), ElementsAre("a/deep/x y.bin", "b.txt", "empty"));
  for (const auto& name : store.names()) EXPECT_EQ(store.read(name), kFiles.at(name)) << name;
  EXPECT_EQ(store.read("a/"), std::nullopt);
  EXPECT_EQ(store.read("B.txt"), std::nullopt);
  EXPECT_EQ(store.description(), file_.string());
}

TEST_F(ZipStoreTest, NamesFileAndRemedyWhenTheArchiveIsUnusable) {
  const auto error = [&] { return error_of([&] { const ZipStore store(file_); }); };
  EXPECT_THAT(error(), AllOf(HasSubstr(file_.string()), HasSubstr("no such file")));
  test::write_file(file_, {});
  EXPECT_THAT(error(), AllOf(HasSubstr(file_.string()), HasSubstr("0 bytes")));
  test::write_file(file_, all_bytes());
  EXPECT_THAT(error(), AllOf(HasSubstr(file_.string()), HasSubstr("not a whole zip archive")));
  test::write_zip(file_, kFiles, "secret");
  EXPECT_THAT(error(), AllOf(HasSubstr(file_.string()), HasSubstr("encrypted"), HasSubstr("password")));
}

TEST_F(ZipStoreTest, TruncatedArchivesNeverGiveWrongContent) {
  test::write_zip(file_, kFiles);
  const Bytes whole = test::read_file(file_);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    test::write_file(file_, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_FALSE(error_of([&] { const ZipStore store(file_); }).empty()) << size << " of " << whole.size();
  }
}

TEST_F(ZipStoreTest, DamagedContentIsNotReturned) {
  test::write_zip(file_, {{"x", all_bytes()}});
  Bytes bytes = test::read_file(file_);
  for (std::size_t i = 60; i < 90; ++i) bytes[i] ^= 0x55;  // within the packed data: the local header takes 31 bytes
  test::write_file(file_, bytes);
  EXPECT_EQ(ZipStore(file_).read("x"), std::nullopt);
}

// The size that the central directory promises: 4 bytes, 24 after its signature [APPNOTE.TXT 4.3.12].
void promise_size(const std::filesystem::path& file, std::uint32_t size) {
  Bytes bytes = test::read_file(file);
  constexpr std::array<std::uint8_t, 4> kSignature{'P', 'K', 1, 2};
  const auto entry = std::search(bytes.begin(), bytes.end(), kSignature.begin(), kSignature.end());
  ASSERT_NE(entry, bytes.end());
  for (int i = 0; i < 4; ++i) *(entry + 24 + i) = static_cast<std::uint8_t>(size >> (8 * i));
  test::write_file(file, bytes);
}

TEST_F(ZipStoreTest, DoesNotBelieveAWrongSize) {
  for (const std::uint32_t size : {1U, 4095U, 4097U, 300U << 20}) {
    test::write_zip(file_, {{"x", all_bytes()}});
    promise_size(file_, size);
    EXPECT_EQ(ZipStore(file_).read("x"), std::nullopt) << size;
  }
}

TEST_F(ZipStoreTest, SeveralThreadsReadAtOnce) {
  Files files;
  for (int i = 0; i < 20; ++i) files["f" + std::to_string(i)] = Bytes(5000, static_cast<std::uint8_t>(i));
  test::write_zip(file_, files);
  const ZipStore store(file_);
  std::array<int, 4> matches{};
  std::vector<std::thread> threads;
  for (auto& count : matches) {
    threads.emplace_back([&store, &files, &count] {
      for (const auto& [name, bytes] : files) count += store.read(name) == bytes ? 1 : 0;
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_THAT(matches, ::testing::Each(20));
}

TEST(FolderStoreTest, ReadsBelowItsFolderOnly) {
  const test::TemporaryFolder outer;
  const auto inside = outer.path() / "assets";
  test::write_file(outer.path() / "secret", test::to_bytes("s"));
  test::write_file(inside / "sub/b", test::to_bytes("b"));
  test::write_file(inside / "a", test::to_bytes("a"));
  const FolderStore store(inside);
  EXPECT_THAT(store.names(), ElementsAre("a", "sub/b"));
  EXPECT_EQ(store.read("sub/../a"), test::to_bytes("a"));
  for (const auto* name : {"../secret", "sub/../../secret", "sub", "", ".", "missing"})
    EXPECT_EQ(store.read(name), std::nullopt) << name;
  EXPECT_EQ(store.read((outer.path() / "secret").string()), std::nullopt);
}

TEST(FolderStoreTest, AMissingFolderHoldsNothing) {
  const FolderStore store("/nowhere/at/all");
  EXPECT_TRUE(store.names().empty());
  EXPECT_EQ(store.read("a"), std::nullopt);
}

}  // namespace
}  // namespace lapis::simulator
