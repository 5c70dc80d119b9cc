#include "common/files/spill_file.hpp"

#include <filesystem>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace lapis::files {
namespace {

std::vector<std::uint8_t> bytes_of(std::mt19937& random) {
  std::vector<std::uint8_t> bytes(std::uniform_int_distribution<std::size_t>(0, 30'000)(random));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

TEST(SpillFile, GivesBackWhatItGotThroughManyReleases) {
  SpillFile file;
  ASSERT_FALSE(file.open(testing::TempDir()));
  std::mt19937 random(1);
  std::vector<std::pair<SpillFile::Extent, std::vector<std::uint8_t>>> kept;
  std::string error;
  for (int i = 0; i < 500; ++i) {
    if (kept.size() > 20) {
      const std::size_t victim = random() % kept.size();
      file.release(kept[victim].first);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(victim));
    }
    const auto bytes = bytes_of(random);
    const auto extent = file.write(bytes, error);
    ASSERT_TRUE(extent) << error;
    kept.emplace_back(*extent, bytes);
  }
  for (const auto& [extent, bytes] : kept) EXPECT_EQ(file.read(extent), bytes);
  EXPECT_LT(file.bytes(), 500u * 15'000u / 4);  // released places were used again
}

TEST(SpillFile, HasNoNameThatCouldStayBehind) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "spill_file_test";
  std::filesystem::create_directories(folder);
  SpillFile file;
  ASSERT_FALSE(file.open(folder.string()));
  std::string error;
  ASSERT_TRUE(file.write(std::vector<std::uint8_t>(5000, 7), error)) << error;
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove(folder);
}

TEST(SpillFile, NamesTheFolderThatIsMissing) {
  SpillFile file;
  const auto reason = file.open("/no/such/folder");
  ASSERT_TRUE(reason);
  EXPECT_NE(reason->find("/no/such/folder"), std::string::npos);
  EXPECT_FALSE(file.is_open());
}

TEST(SpillFile, WhatWasNeverWrittenIsNotRead) {
  SpillFile file;
  ASSERT_FALSE(file.open(testing::TempDir()));
  EXPECT_FALSE(file.read({4096, 10}));
}

}  // namespace
}  // namespace lapis::files
