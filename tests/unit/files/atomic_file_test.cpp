#include "common/files/atomic_file.hpp"

#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace lapis::files {
namespace {

TEST(ReplaceFile, ThatCannotBeIsNamedAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const auto full = folder.path() / "full";
  std::filesystem::create_symlink("/dev/full", full.string() + ".part");
  EXPECT_EQ(replace_file(full.string(), std::vector<std::uint8_t>(10)),
            full.string() + ": cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RequireWritableFolder, IsNotDisturbedByOthersThatTryTheSameFolder) {
  const test::TemporaryFolder folder;
  std::atomic<int> refused = 0;
  std::vector<std::thread> others;
  for (int i = 0; i < 8; ++i) {
    others.emplace_back([&] {
      for (int trial = 0; trial < 200; ++trial) {
        try {
          require_writable_folder(folder.path().string(), "key");
        } catch (const std::runtime_error&) {
          ++refused;
        }
      }
    });
  }
  for (std::thread& other : others) other.join();
  EXPECT_EQ(refused, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RequireWritableFolder, NamesFolderAndKey) {
  try {
    require_writable_folder("/proc", "some.key");
    FAIL() << "nobody can write there";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("some.key: no file can be written there: /proc: open:"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lapis::files
