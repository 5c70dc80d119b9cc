// A process that saves all the time is killed at random instants: map.lapis is always one of the maps that it saved.
#include <chrono>
#include <filesystem>
#include <iostream>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "tests/support/endless_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::mapping {
namespace {

/// Blocks of random counts, which cannot be compressed: most of a save is writing.
MapFile large_map(unsigned seed) {
  MapFile file{VoxelMap(0.1), {}, LabelList::from_names({{1, "wall"}}), {}};
  std::mt19937 random(seed);
  for (std::int32_t x = 0; x < 400; ++x) {
    VoxelBlock block;
    for (int offset = 0; offset < kBlockVoxels; ++offset) block.add_miss(offset, static_cast<std::uint32_t>(random()));
    file.map.set_block({x, 0, 0}, std::move(block));
  }
  return file;
}

TEST(KillSaver, TheMapIsAlwaysWhole) {
  const lapis::test::TemporaryFolder folder;
  const std::string path = (folder.path() / "map.lapis").string();
  const MapFile early = large_map(1), late = large_map(2);
  const auto early_bytes = encode_map(early), late_bytes = encode_map(late);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(save_map(path, early), std::nullopt);
  const std::chrono::duration<double> one_save = std::chrono::steady_clock::now() - begin;

  std::mt19937 random(11);
  std::uniform_real_distribution<double> instant(0.0, 4.0);  // in times of one save
  int kills = 0, in_the_middle = 0;
  for (; kills < 200; ++kills) {
    lapis::test::EndlessProcess saver([&] { return !save_map(path, late) && !save_map(path, early); });
    std::this_thread::sleep_for(instant(random) * one_save);
    ASSERT_TRUE(saver.kill());
    in_the_middle += std::filesystem::exists(path + ".part") ? 1 : 0;
    std::string error;
    const auto bytes = files::read_file(path, error);
    ASSERT_TRUE(bytes) << error;
    ASSERT_TRUE(*bytes == early_bytes || *bytes == late_bytes)
        << "kill " << kills << ": a file that nobody has written";
    const auto loaded = load_map(path, error);
    ASSERT_TRUE(loaded) << error;
  }
  std::cout << "figure: " << kills << " kills, " << in_the_middle << " while a file was being written; a save takes "
            << 1e3 * one_save.count() << " ms, " << late_bytes.size() << " bytes\n";
  EXPECT_GT(in_the_middle, 0);
}

}  // namespace
}  // namespace lapis::mapping
