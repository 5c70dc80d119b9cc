// lapis_semantic_mapper alone: the camera and slam are played by the test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <set>

#include "common/topics/camera.hpp"
#include "common/topics/map.hpp"
#include "common/topics/map_views.hpp"
#include "common/topics/services.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"

namespace lapis::test {
namespace {

using lapis_msgs::msg::VoxelTile;
using ::testing::HasSubstr;

TEST_F(MapperContract, TilesAndStateMakeAConsistentMirrorAlsoForALateJoiner) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(map_frame(i)) << i << mapper.log();
  EXPECT_EQ(client.damaged, 0);
  EXPECT_EQ(messages::from_message(client.states.back().header().stamp()), CameraFeed::stamp(3));
  EXPECT_EQ(client.states.back().header().frame_id(), "map");
  EXPECT_EQ(client.states.back().frames_integrated(), 4u);
  TopicProbe late("late");
  MapClient late_client(late);
  ASSERT_TRUE(late.wait_until([&] { return late_client.has_map(); })) << mapper.log();
  EXPECT_EQ(late_client.states.back().checksum(), client.states.back().checksum());
  EXPECT_EQ(late_client.mirror.state()->tiles, client.mirror.state()->tiles);
}

class MapperWithItsOwnSettings : public MapperContract {
 protected:
  MapperWithItsOwnSettings()
      : MapperContract({"semantic_mapper.sensor_model.prior_occupied=0.1", "semantic_mapper.frame.stride=3",
                        "robot.sensing_range_m=4"}) {}
};

TEST_F(MapperWithItsOwnSettings, SaysWhatItsMapIsBeforeTheFirstFrameAndBeforeEachMap) {
  const auto& descriptions = client.descriptions;
  ASSERT_TRUE(probe.wait_until([&] { return !descriptions.empty() && descriptions.back().labels.size() > 0; }))
      << mapper.log();
  mapping::MapDescription expected;
  expected.sensor_model.prior_occupied = 0.1;
  expected.frames.stride = 3;
  expected.frames.integration.max_range_m = 4.0;
  expected.labels = *messages::from_message(feed.camera().label_info());
  expected.sensor_model = mapping::with_classes(expected.sensor_model, expected.labels);
  EXPECT_EQ(descriptions.back(), expected) << "no map has begun";
  for (const std::int64_t session : {1, 2}) {
    ASSERT_TRUE(map_frame(static_cast<int>(session), session)) << mapper.log();
    expected.epoch = client.states.back().epoch();
    expected.session = session;
    ASSERT_TRUE(probe.wait_until([&] { return descriptions.back().epoch == expected.epoch; })) << mapper.log();
    EXPECT_EQ(descriptions.back(), expected);
  }
  const std::size_t so_far = descriptions.size();
  ASSERT_TRUE(map_frame(3, 2)) << mapper.log();
  EXPECT_EQ(descriptions.size(), so_far) << "only when it changes";
}

TEST_F(MapperContract, ViewsAreMadeForANewReaderAndAreFinite) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  TopicProbe viewer("viewer");
  const auto& points = viewer.collect(topics::kMapPoints);
  const auto& octomap = viewer.collect(topics::kOctomap);
  const auto& grid = viewer.collect(topics::kOccupancyGrid);
  int index = 1;
  // A voxel is not yet occupied after a single frame, so the first view may be an empty one.
  const auto has_views = [&] {
    return !points.empty() && points.back().width() > 0 && !octomap.empty() && !grid.empty();
  };
  ASSERT_TRUE(viewer.wait_until([&] {
    if (!has_views()) map_frame(index++);
    return has_views();
  })) << mapper.log();
  for (const auto& header : {points[0].header(), octomap[0].header(), grid[0].header()}) {
    EXPECT_EQ(header.frame_id(), "map");
    EXPECT_GE(messages::from_message(header.stamp()), CameraFeed::stamp(0));
  }
  const auto& cloud = points.back();
  ASSERT_EQ(cloud.data().size(), static_cast<std::size_t>(cloud.row_step()) * cloud.height());
  for (std::size_t at = 0; at < cloud.data().size(); at += cloud.point_step()) {
    float xyz[3];
    std::memcpy(xyz, &cloud.data()[at], sizeof xyz);
    ASSERT_TRUE(std::isfinite(xyz[0]) && std::isfinite(xyz[1]) && std::isfinite(xyz[2]));
  }
  EXPECT_FALSE(octomap[0].data().empty());
  EXPECT_EQ(grid[0].data().size(), static_cast<std::size_t>(grid[0].info().width()) * grid[0].info().height());
}

TEST_F(MapperContract, LabelsAboveTheListAreUnlabelledAndCounted) {
  int index = 0;
  // Repeated: the label list may come after the first frames.
  EXPECT_TRUE(probe.wait_until([&] {
    auto frame = feed.frame(index);
    std::fill(frame.labels->data().begin(), frame.labels->data().end(), 200);
    feed.send(frame);
    slam.publish(tracked(index++));
    return wait_for_count("label not in the list", 1);
  })) << mapper.log();
  EXPECT_TRUE(client.has_map());
}

TEST_F(MapperContract, LabelsWithoutConfidenceLeaveNoTraceButSurfacesDo) {
  auto& confidence = probe.advertise(topics::kLabelConfidence);
  ASSERT_TRUE(probe.wait_until([&] { return confidence.matched() > 0; }));
  int index = 0;
  const auto send_with = [&](const char* encoding, std::int64_t session) {
    auto frame = feed.frame(index);
    auto image = *frame.labels;
    image.encoding(encoding);
    std::fill(image.data().begin(), image.data().end(), 0);
    confidence.publish(image);
    send(frame, index++, session);
  };
  // Repeated: the mapper may find the publisher of confidence after the first frames.
  ASSERT_TRUE(probe.wait_until([&] {
    send_with("rgb8", 1);
    return wait_for_count("confidence encoding 'rgb8'", 1);
  })) << mapper.log();
  for (int i = 0; i < 4; ++i) send_with("mono8", 2);
  ASSERT_TRUE(probe.wait_until([&] {
    return client.has_map() && client.states.back().session() == 2 &&
           messages::from_message(client.states.back().header().stamp()) == CameraFeed::stamp(index - 1);
  })) << mapper.log();
  std::size_t labelled = 0, unlabelled = 0;
  client.mirror.map()->for_each_observed([&](const auto&, const mapping::VoxelCounts& counts) {
    for (const auto& hit : counts.hits) ++(hit.label == 0 ? unlabelled : labelled);
  });
  EXPECT_EQ(labelled, 0u);
  EXPECT_GT(unlabelled, 100u);
}

TEST_F(MapperContract, LabelsThatComeMoreThanASecondLateAreJoined) {
  constexpr int kFrames = 36, kBurst = 4;  // 1.2 s at 30 Hz; fewer at once than the topics keep
  std::vector<sensor_msgs::msg::Image> late;
  for (int i = 0; i < kFrames; ++i) {
    CameraFrame frame = feed.frame(i);
    late.push_back(*frame.labels);
    frame.labels.reset();
    send(frame, i);
    if (i % kBurst < kBurst - 1) continue;
    feed.send({.color = {}, .depth = frame.depth, .labels = {}, .info = {}});  // when it is refused, all have come
    ASSERT_TRUE(wait_for_count("depth dropped: stamp was there before", (i + 1) / kBurst)) << mapper.log();
  }
  EXPECT_FALSE(client.has_map()) << "frames wait for labels";
  for (int i = 0; i < kFrames; ++i) {
    feed.send({.color = {}, .depth = {}, .labels = late[static_cast<std::size_t>(i)], .info = {}});
    ASSERT_TRUE(probe.wait_until([&] {
      return !client.states.empty() && client.states.back().frames_integrated() > static_cast<std::uint64_t>(i);
    })) << i
        << mapper.log();
  }
  ASSERT_TRUE(probe.wait_until([&] { return client.has_map(); }));
  EXPECT_EQ(client.states.back().frames_dropped(), 0u);
  client.mirror.map()->for_each_observed([&](const auto&, const mapping::VoxelCounts& counts) {
    for (const auto& hit : counts.hits) EXPECT_NE(hit.label, 0);
  });
}

class ImpatientMapper : public MapperContract {
 protected:
  ImpatientMapper() : MapperContract({"semantic_mapper.label_wait_s=0.05"}) {}
};

TEST_F(ImpatientMapper, WhatWaitedLongEnoughEntersTheMapWithoutLabels) {
  for (int i = 0; i < 4; ++i) {
    CameraFrame frame = feed.frame(i);
    frame.labels.reset();
    send(frame, i);
  }
  ASSERT_TRUE(probe.wait_until([&] {
    return !client.states.empty() &&
           messages::from_message(client.states.back().header().stamp()) == CameraFeed::stamp(1);
  })) << mapper.log();
  feed.send({.color = {}, .depth = {}, .labels = feed.frame(0).labels, .info = {}});
  EXPECT_TRUE(wait_for_count("labels dropped: older than what was processed", 1)) << mapper.log();
}

TEST_F(MapperContract, DuplicateAndBackwardStampsAreDropped) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(map_frame(i)) << mapper.log();
  for (const int old : {3, 1}) {
    feed.send(feed.frame(old));
    slam.publish(tracked(old));
  }
  ASSERT_TRUE(map_frame(4)) << mapper.log();
  EXPECT_EQ(client.states.back().frames_integrated(), 5u);
  EXPECT_TRUE(wait_for_count("slam frame dropped", 2)) << mapper.log();
}

TEST_F(MapperContract, RestartedSlamBeginsANewMapAndOldTilesAreGone) {
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(map_frame(i)) << mapper.log();
  const auto first_epoch = client.states.back().epoch();
  ASSERT_TRUE(map_frame(3, 2)) << mapper.log();
  EXPECT_GT(client.states.back().epoch(), first_epoch);
  TopicProbe late("late");
  std::set<std::int64_t> epochs;
  std::size_t tiles = 0;
  late.listen<VoxelTile>(topics::kVoxelTiles, [&](auto& tile) {
    epochs.insert(tile.epoch());
    ++tiles;
  });
  MapClient late_client(late);
  ASSERT_TRUE(late.wait_until([&] { return late_client.has_map() && tiles >= late_client.states.back().tiles(); }))
      << mapper.log();
  EXPECT_EQ(epochs, (std::set<std::int64_t>{client.states.back().epoch()})) << "ended keys leave no samples behind";
}

class MapperWithSmallTiles : public MapperContract {
 protected:
  MapperWithSmallTiles() : MapperContract({"semantic_mapper.resolution_m=0.0235", "semantic_mapper.tile_edge_m=0.1"}) {}
};

TEST_F(MapperWithSmallTiles, TilesGrowWithTheMapAndNothingIsLost) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  const auto first = client.states.back();
  EXPECT_NEAR(first.tile_edge_m(), 0.188, 1e-9);
  for (int i = 10; client.states.back().epoch() == first.epoch(); i += 10) {
    ASSERT_LT(i, 300) << client.states.back().tiles() << " tiles" << mapper.log();
    ASSERT_TRUE(map_frame(i)) << mapper.log();
  }
  EXPECT_NEAR(client.states.back().tile_edge_m(), 0.376, 1e-9);
  EXPECT_TRUE(probe.wait_until([&] { return client.descriptions.back().epoch == client.states.back().epoch(); }));
  EXPECT_EQ(client.states.back().session(), first.session());
  EXPECT_LT(client.states.back().tiles(), first.tiles());
  EXPECT_GE(client.mirror.map()->block_count(), first.tiles()) << "the old part is there, too";
  TopicProbe late("late");
  MapClient late_client(late);
  ASSERT_TRUE(late.wait_until([&] { return late_client.has_map(); })) << mapper.log();
  EXPECT_EQ(*late_client.mirror.map(), *client.mirror.map());
}

TEST_F(MapperContract, SaveWithoutAFolderIsRefusedWithTheKey) {
  auto& save = probe.client(topics::kSaveMap);
  ASSERT_TRUE(probe.wait_until([&] { return save.is_ready(); }));
  const auto call = save.call({});
  ASSERT_TRUE(call);
  std::optional<std_srvs::srv::Trigger_Response> reply;
  ASSERT_TRUE(probe.wait_until([&] { return (reply = save.take_reply(*call)).has_value(); })) << mapper.log();
  EXPECT_FALSE(reply->success());
  EXPECT_THAT(reply->message(), HasSubstr("semantic_mapper.output_dir"));
}

std::string fresh_folder(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string();
}

class MapperWithFolder : public MapperContract {
 protected:
  MapperWithFolder() : MapperContract({"semantic_mapper.output_dir=" + folder_}) {}
  static inline const std::string folder_ = fresh_folder("lapis_mapper_contract");
};

TEST_F(MapperWithFolder, MapIsSavedOnRequestAndAtTheEnd) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  auto& save = probe.client(topics::kSaveMap);
  ASSERT_TRUE(probe.wait_until([&] { return save.is_ready(); }));
  const auto call = save.call({});
  std::optional<std_srvs::srv::Trigger_Response> reply;
  ASSERT_TRUE(probe.wait_until([&] { return (reply = save.take_reply(*call)).has_value(); })) << mapper.log();
  EXPECT_TRUE(reply->success()) << reply->message();
  for (const char* file : {"map.lapis", "map.ot", "map.ply"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folder_) / file)) << file;
    std::filesystem::remove(std::filesystem::path(folder_) / file);
  }
  EXPECT_EQ(mapper.stop(SIGTERM), 0) << mapper.log();
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folder_) / "map.lapis"));
}

TEST(MapperSetUp, FolderThatCannotBeWrittenIsStatus2) {
  ChildProcess mapper(kMapper, {"--set", "semantic_mapper.output_dir=/proc/nowhere"});
  EXPECT_EQ(mapper.wait(), 2) << mapper.log();
  EXPECT_THAT(mapper.log(), HasSubstr("semantic_mapper.output_dir"));
}

}  // namespace
}  // namespace lapis::test
