#include "common/messages/landmarks.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::messages {
namespace {

using ::testing::HasSubstr;

mapping::LandmarkTile tile() {
  mapping::LandmarkTile tile;
  tile.index = {-3, 2, 1};
  tile.graph_version = 17;
  tile.omitted = 4;
  tile.ids = {2, 5, 9};
  tile.positions_m = {{-4.5F, 3.25F, 1.75F}, {-4.6F, 3.3F, 1.8F}, {-4.7F, 3.4F, 2.0F}};
  tile.observer_ends = {1, 4, 6};
  tile.observers = {7, 1, 3, 7, 0, 8};
  return tile;
}

TEST(Landmarks, TileAndStateComeBackAsTheyWere) {
  const auto message = to_message(tile(), 12);
  EXPECT_EQ(message.epoch(), 12);
  const auto back = from_message(message);
  ASSERT_TRUE(back) << back.reason;
  EXPECT_EQ(*back, tile());
  EXPECT_TRUE(from_message(to_message(mapping::LandmarkTile{}, 1))) << "an empty tile";

  const auto state = from_message(to_message(mapping::LandmarkState{5, 9, 6, 7, 8, 1.6, 0.01}));
  EXPECT_EQ(state.session, 5);
  EXPECT_EQ(state.epoch, 9);
  EXPECT_EQ(state.graph_version, 6U);
  EXPECT_EQ(state.tiles, 7U);
  EXPECT_EQ(state.checksum, 8U);
  EXPECT_EQ(state.tile_edge_m, 1.6);
  EXPECT_EQ(state.tolerance_m, 0.01);
}

TEST(Landmarks, TilesThatDoNotFitTogetherAreRefusedWithTheReason) {
  using Message = lapis_msgs::msg::LandmarkTile;
  const auto refusal = [](const std::function<void(Message&)>& spoil) {
    Message message = to_message(tile(), 1);
    spoil(message);
    return from_message(message).reason;
  };
  EXPECT_THAT(refusal([](Message& m) { m.positions().pop_back(); }), HasSubstr("positions and ids"));
  EXPECT_THAT(refusal([](Message& m) { m.positions()[4] = std::numeric_limits<float>::quiet_NaN(); }),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal([](Message& m) { m.ids()[1] = 2; }), HasSubstr("ids are not ascending"));
  EXPECT_THAT(refusal([](Message& m) { m.observer_ends().pop_back(); }), HasSubstr("observer_ends and ids"));
  EXPECT_THAT(refusal([](Message& m) { m.observer_ends()[2] = 7; }), HasSubstr("do not end with the observers"));
  EXPECT_THAT(refusal([](Message& m) { m.observer_ends()[0] = 0; }), HasSubstr("no observer"));
  EXPECT_THAT(refusal([](Message& m) { m.observer_ends()[0] = 100; }), HasSubstr("no observer"));
  EXPECT_THAT(refusal([](Message& m) { m.observers()[2] = 1; }), HasSubstr("observers are not ascending"));
  EXPECT_THAT(refusal([](Message& m) { m.observers().resize(300'000); }), HasSubstr("larger than 1 MiB"));
}

}  // namespace
}  // namespace lapis::messages
