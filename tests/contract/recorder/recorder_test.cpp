// lapis_recorder alone, with topics that the test publishes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <random>

#include "common/bags/bag_reader.hpp"
#include "common/bags/leading_stamp.hpp"
#include "common/dds/raw.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/services.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRecorder = "lapis_recorder";
constexpr const char* kForeignTopic = "rt/other/strange";
constexpr const char* kForeignType = "other_msgs::msg::dds_::Strange_";

sensor_msgs::msg::Image image(int number) {
  sensor_msgs::msg::Image message;
  message.header().stamp(messages::to_message(time::Time{1'000'000'000LL * number}));
  message.width(64);
  message.height(48);
  message.encoding("mono8");
  message.step(64);
  message.data().resize(64 * 48, static_cast<std::uint8_t>(number));
  return message;
}

/// What a bag has of a topic.
std::vector<bags::Message> messages_of(const std::filesystem::path& bag, const std::string& topic) {
  bags::BagReader reader(bag);
  reader.select({.topics = std::set<std::string>{topic}, .from_ns = {}, .to_ns = {}});
  std::vector<bags::Message> found;
  while (auto message = reader.next()) found.push_back(std::move(*message));
  return found;
}

class RecorderContract : public ::testing::Test {
 protected:
  std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), bag().string());
    return more;
  }
  std::filesystem::path bag() const { return folder_.path() / "bag"; }

  TemporaryFolder folder_;
};

class RecorderOf : public RecorderContract, public ::testing::WithParamInterface<std::string> {};

TEST_P(RecorderOf, RecordsWhatAnybodyPublishes) {
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  auto& mount = probe.advertise(topics::kStaticTransforms);
  dds::RawPublisher foreign(probe.participant(), kForeignTopic, kForeignType, "RIHS01_00", {.depth = 10});
  dds::RawPublisher latched(probe.participant(), "rt/other/latched", kForeignType, "RIHS01_00", dds::kLatched);
  mount.publish({});
  const dds::RawType::Bytes strange{0, 1, 0, 0, 7, 8, 9, 10};
  latched.publish(strange);
  ChildProcess recorder(kRecorder, arguments({"--storage", GetParam()}));
  ASSERT_TRUE(wait_until_ready(recorder)) << recorder.log();
  ASSERT_TRUE(probe.wait_until([&] { return color.matched() > 0 && foreign.matched() > 0; })) << recorder.log();
  color.publish(image(0));  // what comes before both sides have matched is lost, but for the last samples
  foreign.publish(strange);
  ASSERT_TRUE(recorder.wait_for_line("records " + std::string(topics::kColor.name))) << recorder.log();
  ASSERT_TRUE(recorder.wait_for_line("records /other/strange")) << recorder.log();
  for (int i = 1; i < 30; ++i) {
    color.publish(image(i));
    foreign.publish(strange);
  }
  ASSERT_TRUE(color.wait_until_acknowledged(5.0));
  ASSERT_TRUE(foreign.wait_until_acknowledged(5.0));
  ASSERT_TRUE(recorder.wait_for_line("records /other/latched")) << recorder.log();
  ASSERT_TRUE(recorder.wait_for_line("records /tf_static")) << recorder.log();
  EXPECT_EQ(recorder.stop(SIGINT), 0) << recorder.log();

  const auto images = messages_of(bag(), topics::kColor.name);
  ASSERT_EQ(images.size(), 30U);
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(bags::leading_stamp(images[i].data)->nanoseconds, 1'000'000'000LL * static_cast<int>(i));
    EXPECT_GT(images[i].data.size(), 64U * 48U);
    EXPECT_LE(images[i].publish_time_ns, images[i].log_time_ns);
  }
  const auto strangers = messages_of(bag(), "/other/strange");
  ASSERT_EQ(strangers.size(), 30U);
  EXPECT_EQ(strangers[0].data, strange);
  EXPECT_EQ(messages_of(bag(), "/other/latched").size(), 1U);
  EXPECT_EQ(messages_of(bag(), "/tf_static").size(), 1U);
  const bags::BagReader reader(bag());
  for (const bags::Channel& channel : reader.contents().channels) {
    const bool is_foreign = channel.topic.starts_with("/other/");
    EXPECT_EQ(channel.type_hash.starts_with("RIHS01_"), true) << channel.topic;
    EXPECT_EQ(channel.schema.empty(), is_foreign) << channel.topic;
    const bool is_latched = channel.offered_qos.find("durability: 1") != std::string::npos;
    const bool is_of_test = is_foreign || channel.topic == topics::kColor.name || channel.topic == "/tf_static";
    const bool should_be = channel.topic == "/tf_static" || channel.topic == "/other/latched";
    EXPECT_EQ(is_latched, is_of_test ? should_be : is_latched) << channel.topic;
  }
}

INSTANTIATE_TEST_SUITE_P(Storages, RecorderOf, ::testing::Values("mcap", "sqlite3"),
                         [](const auto& storage) { return storage.param; });

TEST_F(RecorderContract, RecordsWhatIsChosenByTheTimeOfTheClock) {
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  auto& depth = probe.advertise(topics::kDepth);
  auto& clock = probe.advertise(topics::kClock);
  ChildProcess recorder(kRecorder,
                        arguments({"--topic", "/camera/*", "--exclude", "*depth*", "--set", "recorder.time=clock"}));
  ASSERT_TRUE(wait_until_ready(recorder)) << recorder.log();
  ASSERT_TRUE(probe.wait_until([&] { return color.matched() > 0 && clock.matched() > 0; })) << recorder.log();
  color.publish(image(1));
  ASSERT_TRUE(color.wait_until_acknowledged(5.0));
  ASSERT_TRUE(recorder.wait_for_line("records /camera/color/image_raw")) << recorder.log();
  rosgraph_msgs::msg::Clock now;
  now.clock(messages::to_message(time::Time{42'000'000'000}));
  clock.publish(now);
  depth.publish(image(1));
  ASSERT_TRUE(clock.wait_until_acknowledged(5.0));
  EXPECT_EQ(recorder.stop(SIGINT), 0) << recorder.log();
  const auto images = messages_of(bag(), topics::kColor.name);
  ASSERT_EQ(images.size(), 1U);
  EXPECT_EQ(bags::BagReader(bag()).contents().channels.size(), 1U);
  EXPECT_TRUE(images[0].log_time_ns == 42'000'000'000 || images[0].log_time_ns == 0) << images[0].log_time_ns;
}

TEST_F(RecorderContract, KilledAtAnyInstantLeavesABag) {
  const char* given = std::getenv("LAPIS_KILLS");  // NOLINT(concurrency-mt-unsafe): tests do not set it
  const int kills = given == nullptr ? 4 : std::atoi(given);
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  std::mt19937 random(1);
  std::size_t kept = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const auto folder = folder_.path() / std::to_string(kill);
    ChildProcess recorder(
        kRecorder, {folder.string(), "--storage", kill % 2 == 0 ? "mcap" : "sqlite3", "--set", "recorder.split_mb=1"});
    ASSERT_TRUE(wait_until_ready(recorder)) << recorder.log();
    ASSERT_TRUE(probe.wait_until([&] { return color.matched() > 0; })) << recorder.log();
    color.publish(image(0));
    ASSERT_TRUE(recorder.wait_for_line("records " + std::string(topics::kColor.name))) << recorder.log();
    const int most = 100 + static_cast<int>(random() % 400);
    for (int i = 1; i < most; ++i) {
      color.publish(image(i));
      if (i % 4 == 0) color.wait_until_acknowledged(1.0);
    }
    EXPECT_EQ(recorder.stop(SIGKILL), -SIGKILL);
    const auto images = messages_of(folder, topics::kColor.name);
    for (std::size_t i = 0; i < images.size(); ++i) {
      ASSERT_EQ(bags::leading_stamp(images[i].data)->nanoseconds, 1'000'000'000LL * static_cast<int>(i)) << folder;
    }
    kept += images.size();
    ASSERT_TRUE(probe.wait_until([&] { return color.matched() == 0; }));
  }
  EXPECT_GT(kept, 0U);
}

TEST_F(RecorderContract, WritesTheLastSecondsWhenAsked) {
  TopicProbe probe;
  auto& color = probe.advertise(topics::kColor);
  auto& client = probe.client(topics::kSnapshot);
  ChildProcess recorder(kRecorder, arguments({"--snapshot", "60"}));
  ASSERT_TRUE(wait_until_ready(recorder)) << recorder.log();
  ASSERT_TRUE(probe.wait_until([&] { return color.matched() > 0 && client.is_ready(); })) << recorder.log();
  color.publish(image(0));
  ASSERT_TRUE(recorder.wait_for_line("records " + std::string(topics::kColor.name))) << recorder.log();
  for (int snapshot = 0; snapshot < 2; ++snapshot) {
    for (int i = snapshot == 0 ? 1 : 0; i < 10; ++i) color.publish(image(i));
    ASSERT_TRUE(color.wait_until_acknowledged(5.0));
    const auto call = client.call({});
    ASSERT_TRUE(call);
    std::optional<std_srvs::srv::Trigger_Response> reply;
    ASSERT_TRUE(probe.wait_until([&] { return (reply = client.take_reply(*call)).has_value(); })) << recorder.log();
    EXPECT_TRUE(reply->success()) << reply->message();
    const auto folder = bag() / ("snapshot_" + std::to_string(snapshot));
    EXPECT_THAT(reply->message(), HasSubstr(folder.string()));
    EXPECT_EQ(messages_of(folder, topics::kColor.name).size(), 10U);
  }
  EXPECT_EQ(recorder.stop(SIGTERM), 0) << recorder.log();
}

TEST_F(RecorderContract, RefusesAFolderThatIsNotEmpty) {
  {
    ChildProcess first(kRecorder, arguments());
    ASSERT_TRUE(wait_until_ready(first)) << first.log();
    EXPECT_EQ(first.stop(SIGTERM), 0) << first.log();
  }
  ChildProcess second(kRecorder, arguments());
  EXPECT_EQ(second.wait(), 2);
  EXPECT_THAT(second.log(), HasSubstr("is not empty"));
  ChildProcess nowhere(kRecorder);
  EXPECT_EQ(nowhere.wait(), 2);
  EXPECT_THAT(nowhere.log(), HasSubstr("no folder given"));
}

}  // namespace
}  // namespace lapis::test
