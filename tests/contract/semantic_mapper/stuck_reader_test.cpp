// A reader of the map that hangs. The test starts itself again as that reader, because it has to be a process of its
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>

#include "common/topics/map.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"
#include "tests/support/private_domain.hpp"

namespace lapis::test {
namespace {

/// Stores no frames, which would take more and more memory.
class StuckReader : public MapperContract {
 protected:
  StuckReader() : MapperContract({"semantic_mapper.re_anchor=false", "semantic_mapper.resolution_m=0.05"}) {}
  /// Frame `index` from the place of frame `place`: the map itself does not grow for ever.
  bool map_again(int index, int place) {
    auto pose = tracked(place);
    pose.header().stamp(messages::to_message(CameraFeed::stamp(index)));
    feed.send(feed.frame(CameraFeed::stamp(index), slow_motion(place)));
    slam.publish(pose);
    const auto integrated = static_cast<std::uint64_t>(index) + 1;
    return probe.wait_until([&] {
      return !client.states.empty() && client.states.back().frames_integrated() == integrated && client.has_map();
    });
  }
};

TEST_F(StuckReader, CostsOthersNoDataAndTheMapperNoMemory) {
  constexpr int kWarm = 60, kFrames = 240;
  std::size_t bytes = 0;
  probe.listen<lapis_msgs::msg::VoxelTile>(topics::kVoxelTiles, [&](auto& tile) { bytes += tile.data().size(); });
  ASSERT_TRUE(probe.wait_until_known_by("semantic_mapper"));
  ChildProcess reader("/proc/self/exe", {"--reader"});
  for (int i = 0; i < kWarm; ++i) ASSERT_TRUE(map_again(i, i)) << mapper.log();
  ASSERT_TRUE(reader.wait_for_line("map of " + std::to_string(kWarm) + " frames")) << reader.log();
  const long before_mb = peak_memory_mb(mapper.pid());
  bytes = 0;
  reader.signal(SIGSTOP);
  for (int i = kWarm; i < kFrames; ++i) ASSERT_TRUE(map_again(i, i % kWarm)) << i << mapper.log();
  const long grown_mb = peak_memory_mb(mapper.pid()) - before_mb;
  std::cout << "figure: " << bytes / 1'000'000 << " MB of tiles while a reader hung; the mapper grew by " << grown_mb
            << " MB\n";
  EXPECT_GT(bytes, 20'000'000u) << "too little to show a leak";
  EXPECT_LE(grown_mb, 5);
  reader.signal(SIGCONT);
  EXPECT_TRUE(reader.wait_for_line("map of " + std::to_string(kFrames) + " frames")) << reader.log();
}

/// Prints a line for each version of the map.
int read_map() {
  TopicProbe probe("reader");
  MapClient client(probe);
  std::size_t published = 0;
  const auto is_new = [&] { return client.has_map() && client.states.size() > published; };
  while (true) {
    if (!probe.wait_until(is_new, Seconds(1))) continue;
    published = client.states.size();
    std::cout << "map of " << client.states.back().frames_integrated() << " frames" << std::endl;
  }
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--reader") return lapis::test::read_map();
  std::cout << lapis::test::enter_private_domain() << std::endl;
  // AddressSanitizer keeps what was freed, by default 256 MB of it: that is no growth of the mapper.
  const char* options = std::getenv("ASAN_OPTIONS");
  setenv("ASAN_OPTIONS", (std::string(options ? options : "") + ":quarantine_size_mb=1").c_str(), 1);
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
