// lapis_planner of a run, and a process in its DDS domain that does not belong to the run.
#include <gmock/gmock.h>

#include <limits>
#include <optional>
#include <utility>

#include "tests/contract/planner/planner_contract.hpp"
#include "tests/support/in_run.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

/// All that starts before run_a_.reset() belongs to a run.
class InRunA {
 protected:
  std::optional<InRun> run_a_{std::in_place, "a"};
};

class PlannerOfARun : protected InRunA, public PlannerContract {};

TEST_F(PlannerOfARun, AStrangersTileOfTheLargestEpochDoesNotFreezeItsMap) {
  get_going();
  const double volume_m3 = statuses.back().explored_volume_m3();
  run_a_.reset();
  TopicProbe stranger("stranger");
  auto& tiles = stranger.advertise(topics::kVoxelTiles);
  ASSERT_TRUE(stranger.wait_until_matched());
  auto tile = peers.tile(drawn_map(kRoomWithDoor, kResolution_m), {0, 0, 0});
  tile.epoch(std::numeric_limits<std::int64_t>::max());
  ASSERT_TRUE(wait_until([&] {
    tiles.publish(tile);
    return count_of("refused samples lapis/semantic_mapper/tiles") > 0.0;
  })) << planner->log();
  ++peers.epoch;
  peers.draw(Drawing(kRoomWithDoor.begin() + 8, kRoomWithDoor.end()));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_NEAR(statuses.back().explored_volume_m3(), 0.5 * volume_m3, 0.01) << "the map of its own mapper";
}

}  // namespace
}  // namespace lapis::test
