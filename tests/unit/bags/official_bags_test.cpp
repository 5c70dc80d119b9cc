// The bags of rosbag2's own tests (test data `rosbag2`): what their metadata counts is read, from both storages alike.

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "common/bags/bag_reader.hpp"
#include "sample_messages.hpp"
#include "tests/support/test_data.hpp"

namespace lapis::bags {
namespace {

class OfficialBag : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    folder_ = lapis::test::find_test_data("rosbag2");
    if (!folder_) GTEST_SKIP() << lapis::test::missing_test_data("rosbag2");
  }
  std::filesystem::path path(const std::string& storage) const { return *folder_ / (GetParam() + "_" + storage); }
  std::optional<std::filesystem::path> folder_;
};

TEST_P(OfficialBag, HasWhatItsMetadataCounts) {
  for (const char* storage : {"mcap", "sqlite3"}) {
    SCOPED_TRACE(storage);
    BagReader reader(path(storage));
    const auto information = YAML::LoadFile((path(storage) / "metadata.yaml").string())["rosbag2_bagfile_information"];
    std::map<std::string, std::uint64_t> expected, counted, found;
    for (const auto& topic : information["topics_with_message_count"]) {
      const auto count = topic["message_count"].as<std::uint64_t>();
      if (count > 0) expected[topic["topic_metadata"]["name"].as<std::string>()] = count;
    }
    const Contents& contents = reader.contents();
    for (std::size_t i = 0; i < contents.channels.size(); ++i) {
      if (contents.message_counts[i] > 0) counted[contents.channels[i].topic] += contents.message_counts[i];
    }
    for (const Message& message : test::read_all(reader)) ++found[contents.channels[message.channel].topic];
    EXPECT_EQ(counted, expected);
    EXPECT_EQ(found, expected);
  }
}

TEST_P(OfficialBag, IsTheSameInBothStorages) {
  BagReader mcap(path("mcap")), sqlite(path("sqlite3"));
  const auto all = [](BagReader& reader) {
    std::map<std::string, std::vector<std::vector<std::uint8_t>>> data;
    for (const Message& message : test::read_all(reader)) {
      data[reader.contents().channels[message.channel].topic].push_back(message.data);
    }
    return data;
  };
  EXPECT_EQ(all(mcap), all(sqlite));
}

INSTANTIATE_TEST_SUITE_P(All, OfficialBag, ::testing::Values("cdr_test", "talker", "wbag", "wrong_rmw_test"),
                         [](const auto& bag) { return bag.param; });

}  // namespace
}  // namespace lapis::bags
