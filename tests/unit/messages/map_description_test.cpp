#include "common/messages/map_description.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::messages {
namespace {

using ::testing::HasSubstr;
using Message = lapis_msgs::msg::MapDescription;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

mapping::MapDescription description() {
  mapping::MapDescription out;
  out.resolution_m = 0.1;
  out.frames = {{0.3, 4.0, -2.0, 3.0, 1.0, 0.002, 2.5}, 3};
  out.sensor_model.fusion = "bki";
  out.sensor_model.hit_gain = 0.7;
  out.sensor_model.miss_gain = 0.3;
  out.sensor_model.label_accuracy = 0.9;
  out.sensor_model.prior_occupied = 0.1;
  out.sensor_model.prior_votes = 3.0;
  out.sensor_model.occupancy_limit = 8.0;
  out.sensor_model.share_limit = 7.0;
  out.sensor_model.use_paper_increments = true;
  out.sensor_model.class_count = 2;
  out.sensor_model.class_priors = {0.4, 0.6};
  out.labels = mapping::LabelList({{1, "wall", {1, 2, 3}}, {2, "chair, red", {4, 5, 6}}});
  out.epoch = 1'000'000'000;
  out.session = -7;
  return out;
}

std_msgs::msg::Header header_at_start() { return header(time::Time{5}, "map"); }

TEST(MapDescriptionMessage, ComesBackAsItWas) {
  for (const auto& sent : {description(), mapping::MapDescription{}}) {
    const Message message = to_message(sent, header_at_start());
    EXPECT_EQ(message.header().frame_id(), "map");
    const auto back = from_message(message);
    ASSERT_TRUE(back) << back.reason;
    EXPECT_EQ(*back, sent);
  }
}

TEST(MapDescriptionMessage, IsRefusedWithTheNameOfWhatIsWrong) {
  const auto refusal = [](const std::function<void(Message&)>& spoil) {
    Message message = to_message(description(), header_at_start());
    spoil(message);
    const auto back = from_message(message);
    return back ? "accepted" : back.reason;
  };
  EXPECT_THAT(refusal([](Message& m) { m.resolution_m(kNaN); }), HasSubstr("resolution_m"));
  EXPECT_THAT(refusal([](Message& m) { m.frames().depth_noise_per_m(kNaN); }), HasSubstr("depth_noise_per_m"));
  EXPECT_THAT(refusal([](Message& m) { m.frames().stride(1u << 31); }), HasSubstr("stride"));
  EXPECT_THAT(refusal([](Message& m) { m.sensor_model().prior_occupied(kNaN); }), HasSubstr("prior_occupied"));
  EXPECT_THAT(refusal([](Message& m) { m.sensor_model().fusion("of another version"); }), HasSubstr("fusion"));
  EXPECT_THAT(refusal([](Message& m) { m.sensor_model().class_count(0xffffffff); }), HasSubstr("class_count"));
  EXPECT_THAT(refusal([](Message& m) { m.sensor_model().class_priors().pop_back(); }), HasSubstr("class_priors"));
  EXPECT_THAT(refusal([](Message& m) { m.labels()[0].id(0); }), HasSubstr("id 0"));
  EXPECT_THAT(refusal([](Message& m) { m.labels()[0].id(2); }), HasSubstr("id 2 twice"));
  EXPECT_THAT(refusal([](Message& m) { m.labels()[1].id(3); }), HasSubstr("class_count"));
}

TEST(MapDescriptionMessage, DefaultMessageIsNoDescription) { EXPECT_FALSE(from_message(Message{})); }

}  // namespace
}  // namespace lapis::messages
