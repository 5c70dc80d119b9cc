// lapis_semantic_mapper among strangers: poses that another process forges, and a flood of calls.
#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <optional>

#include "common/topics/services.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"
#include "tests/support/in_run.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

std::unique_ptr<MapperRun> mapper_of_run(const char* run) {
  const InRun scope(run);
  return std::make_unique<MapperRun>();
}

// A session of somebody else would end the map.
TEST(MapperAmongStrangers, ForgedSessionIsRefusedAndNamed) {
  constexpr std::int64_t kForged = 1'000'000;
  const auto run = mapper_of_run("a");
  ASSERT_TRUE(run->is_ready()) << run->mapper.log();
  ASSERT_TRUE(run->map_frame(0)) << run->mapper.log();
  const auto epoch = run->client.states.back().epoch();
  TopicProbe stranger("stranger");
  auto& forged = stranger.advertise(topics::kTrackedFrame);
  ASSERT_TRUE(stranger.wait_until([&] { return forged.matched() > 0; }));
  ASSERT_TRUE(stranger.wait_until_known_by("semantic_mapper"));
  run->feed.send(run->feed.frame(1));
  ASSERT_TRUE(run->probe.wait_until([&] {
    forged.publish(run->tracked(1, kForged));
    const auto values = newest_values(run->diagnostics, "semantic_mapper");
    return values.contains("refused samples rt/slam/frame");
  })) << run->mapper.log();
  EXPECT_TRUE(run->mapper.wait_for_line("another process publishes this topic", Seconds(2))) << run->mapper.log();
  run->slam.publish(run->tracked(1));
  EXPECT_TRUE(run->probe.wait_until([&] { return run->client.states.back().frames_integrated() == 2; }))
      << "the frame is not lost" << run->mapper.log();
  ASSERT_TRUE(run->map_frame(2)) << run->mapper.log();
  EXPECT_EQ(run->client.states.back().epoch(), epoch) << "the map is still the first one";
}

class MapperWithAFolder : protected TemporaryFolder, public MapperContract {
 protected:
  MapperWithAFolder() : MapperContract({"semantic_mapper.output_dir=" + path().string()}) {}
};

// A camera at 15 Hz, and thousands of calls a second, of which each wants the map to be saved.
TEST_F(MapperWithAFolder, PublishesItsMapInAFloodOfCalls) {
  using Clock = std::chrono::steady_clock;
  constexpr Seconds kFlood(5.0), kPeriod(1.0 / 15.0);
  auto& save = probe.client(topics::kSaveMap);
  ASSERT_TRUE(probe.wait_until([&] { return save.is_ready(); }));
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  const auto first = client.states.back().version();
  std::uint64_t calls = 0, last = 0;
  int frames = 1;
  const auto begin = Clock::now();
  probe.wait_until(
      [&] {
        for (int i = 0; i < 20; ++i, ++calls) last = save.call({}).value_or(last);
        if (Clock::now() - begin > frames * kPeriod) {
          send(feed.frame(frames), frames);
          ++frames;
        }
        return Clock::now() - begin > kFlood;
      },
      2 * kFlood);
  const double rate_hz = static_cast<double>(client.states.back().version() - first) / kFlood.count();
  std::cout << "figure: " << calls << " calls in " << kFlood.count() << " s, map versions at " << rate_hz << " Hz\n";
  EXPECT_GT(calls, 1000U) << "too few for a flood";
  EXPECT_GE(rate_hz, 1.0) << mapper.log();
  std::optional<std_srvs::srv::Trigger_Response> reply;
  ASSERT_TRUE(probe.wait_until([&] { return (reply = save.take_reply(last)).has_value(); })) << "of the last call";
  EXPECT_TRUE(reply->success()) << reply->message();
  EXPECT_TRUE(map_frame(frames)) << mapper.log();
}

}  // namespace
}  // namespace lapis::test
