// lapis_semantic_mapper alone, with inputs and a disk that fail: what is wrong is reported and counted, the map stays
// as it is, and mapping continues.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "common/topics/services.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

namespace fs = std::filesystem;
using lapis_msgs::msg::TrackedFrame;
using ::testing::HasSubstr;

/// A frame that has to be refused, and how that is counted.
struct Spoiled {
  const char* reason;
  void (*change)(CameraFrame& frame, TrackedFrame& pose);
};

const Spoiled kSpoiled[] = {
    {"depth encoding 'rgb8'", [](CameraFrame& f, TrackedFrame&) { f.depth->encoding("rgb8"); }},
    {"depth image has not step x height bytes", [](CameraFrame& f, TrackedFrame&) { f.depth->data().resize(10); }},
    {"depth image rows are shorter than their width", [](CameraFrame& f, TrackedFrame&) { f.depth->step(17); }},
    {"depth image is big-endian", [](CameraFrame& f, TrackedFrame&) { f.depth->is_bigendian(1); }},
    {"label encoding '32FC1'", [](CameraFrame& f, TrackedFrame&) { f.labels->encoding("32FC1"); }},
    {"label image is ",
     [](CameraFrame& f, TrackedFrame&) {
       f.labels->height(f.labels->height() / 2);
       f.labels->data().resize(f.labels->step() * f.labels->height());
     }},
    {"x17", [](CameraFrame& f, TrackedFrame&) { f.info->height(17); }},
    {"keyframe_pose: quaternion is not a unit one",
     [](CameraFrame&, TrackedFrame& pose) { pose.keyframe_pose().orientation().w(7.0); }},
    {"pose_in_keyframe: pose has numbers that are not finite",
     [](CameraFrame&, TrackedFrame& pose) { pose.pose_in_keyframe().position().x(std::nan("")); }},
    {"keyframe_pose: pose has numbers that are not finite",
     [](CameraFrame&, TrackedFrame& pose) { pose.keyframe_pose().orientation().y(INFINITY); }},
    {"more than 10 km", [](CameraFrame&, TrackedFrame& pose) { pose.pose_in_keyframe().position().x(1e7); }},
    {"drift is no sigma", [](CameraFrame&, TrackedFrame& pose) { pose.drift_rad(std::nan("")); }},
    {"a pose by odometry alone does not say its drift",
     [](CameraFrame&, TrackedFrame& pose) { pose.source(lapis_msgs::msg::TrackedFrame_Constants::SOURCE_ODOMETRY); }},
    {"slam has no pose",
     [](CameraFrame&, TrackedFrame& pose) {
       pose.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_LOST);
       pose.keyframe_pose({});
     }},
};

class MapperFaults : public MapperContract {
 protected:
  using MapperContract::MapperContract;
  void send_spoiled(const Spoiled& spoiled, int index) {
    auto frame = feed.frame(index);
    auto pose = tracked(index);
    spoiled.change(frame, pose);
    feed.send(frame);
    slam.publish(pose);
  }
  /// The map and its state as a client gets them that comes now, whatever is still on its way to the other one.
  void expect_map(const mapping::VoxelMap& expected, const lapis_msgs::msg::MapState& state) {
    TopicProbe late("late");
    MapClient late_client(late);
    ASSERT_TRUE(late.wait_until([&] { return late_client.has_map(); })) << mapper.log();
    EXPECT_EQ(late_client.states.back().checksum(), state.checksum());
    EXPECT_EQ(late_client.states.back().version(), state.version());
    EXPECT_EQ(*late_client.mirror.map(), expected);
  }
};

TEST_F(MapperFaults, GarbageIsCountedAndMappingContinues) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  int index = 1;
  for (const Spoiled& spoiled : kSpoiled) {
    send_spoiled(spoiled, index++);
    EXPECT_TRUE(map_frame(index++)) << spoiled.reason << mapper.log();
  }
  for (const Spoiled& spoiled : kSpoiled) {
    EXPECT_TRUE(wait_for_count(spoiled.reason, 1)) << spoiled.reason << mapper.log();
  }
  EXPECT_EQ(sum_of(newest_values(diagnostics, "semantic_mapper"), "frames dropped"), std::size(kSpoiled));
  EXPECT_EQ(client.states.back().frames_dropped(), std::size(kSpoiled));
  EXPECT_TRUE(mapper.is_running()) << mapper.log();
  EXPECT_EQ(client.damaged, 0);
}

TEST_F(MapperFaults, GarbageLeavesTheMapAsItIs) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  const auto state = client.states.back();
  const mapping::VoxelMap map = *client.mirror.map();
  int index = 1;
  for (const Spoiled& spoiled : kSpoiled) send_spoiled(spoiled, index++);
  ASSERT_TRUE(wait_for_count("frames dropped", std::size(kSpoiled))) << mapper.log();
  ASSERT_NO_FATAL_FAILURE(expect_map(map, state));
  ASSERT_TRUE(map_frame(index)) << mapper.log();
  EXPECT_NE(client.states.back().checksum(), state.checksum()) << "a good frame does change the map";
}

TEST_F(MapperFaults, DepthWithoutMeasurementsAddsNothingAndHurtsNobody) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  const auto state = client.states.back();
  const mapping::VoxelMap map = *client.mirror.map();
  int index = 1;
  const auto send_depth = [&](sensor_msgs::msg::Image depth) {
    auto frame = feed.frame(index);
    frame.depth = std::move(depth);
    send(frame, index++);
  };
  for (const std::uint8_t fill : {std::uint8_t{0}, std::uint8_t{255}}) {
    auto depth = *feed.frame(index).depth;
    std::fill(depth.data().begin(), depth.data().end(), fill);
    send_depth(depth);
  }
  using Limits = std::numeric_limits<float>;
  for (const float metres :
       {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::denorm_min(), -1.0F}) {
    auto depth = feed.camera().depth_metres(CameraFeed::stamp(index), slow_motion(index));
    for (std::size_t at = 0; at < depth.data().size(); at += sizeof metres)
      std::memcpy(&depth.data()[at], &metres, sizeof metres);
    send_depth(depth);
  }
  const std::string frames = std::to_string(index);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "semantic_mapper")["frames"] == frames; }))
      << mapper.log();
  ASSERT_NO_FATAL_FAILURE(expect_map(map, state));
  ASSERT_TRUE(map_frame(index)) << mapper.log();
  EXPECT_NE(client.states.back().checksum(), state.checksum()) << "a frame with depth does change the map";
}

/// Views of the slow motion, by a clock that a test sets.
class MapperClock : public MapperFaults {
 protected:
  void SetUp() override {
    MapperFaults::SetUp();
    ASSERT_TRUE(probe.wait_until([&] {
      return !client.descriptions.empty() && client.descriptions.back().labels.size() > 0;
    })) << mapper.log();
  }
  void send_view(int view, std::int64_t session) {
    stamp_ = CameraFeed::stamp(sent_++) + clock_;
    auto pose = tracked(view, session);
    pose.header().stamp(messages::to_message(stamp_));
    feed.send(feed.frame(stamp_, slow_motion(view)));
    slam.publish(pose);
  }
  /// Waits until the map has all frames that were sent.
  bool has_all() {
    const auto sent = static_cast<std::uint64_t>(sent_);
    return probe.wait_until(
        [&] { return !client.states.empty() && client.states.back().frames_integrated() == sent && client.has_map(); });
  }
  bool has_grid_of_now() {
    return probe.wait_until([&] {
      const auto since = [&] { return stamp_ - messages::from_message(grids_.back().header().stamp()); };
      return !grids_.empty() && abs(since()) < time::Duration{70'000'000};  // two frames
    });
  }

  const std::vector<nav_msgs::msg::OccupancyGrid>& grids_ = probe.collect(topics::kObstacles);
  time::Duration clock_;
  time::Time stamp_;  // sent last
  int sent_ = 0;
};

TEST_F(MapperClock, ThatIsSetKeepsTheMap) {
  int view = 0;
  for (const std::int64_t set_to_ns : {0L, 3'600'000'000'000L, 3'595'000'000'000L, 0L}) {
    SCOPED_TRACE(set_to_ns);
    clock_ = {set_to_ns};
    const std::uint64_t version = client.states.empty() ? 0 : client.states.back().version();
    for (int i = 0; i < 2; ++i) send_view(view++, 1);
    ASSERT_TRUE(has_all()) << mapper.log();
    send_view(view++, 1);
    ASSERT_TRUE(has_all()) << mapper.log();
    EXPECT_GT(client.states.back().version(), version);
    EXPECT_EQ(client.states.back().session(), 1);
    EXPECT_EQ(client.states.back().epoch(), client.states.front().epoch());
    EXPECT_TRUE(has_grid_of_now()) << mapper.log();
  }
  EXPECT_TRUE(wait_for_count("slam frame: the clock of its source was set", 3)) << mapper.log();
  EXPECT_EQ(client.states.back().frames_dropped(), 0U);
  const mapping::VoxelMap map = *client.mirror.map();
  for (int i = 0; i < view; ++i) {  // the same views in another map, by a clock that nobody sets
    send_view(i, 2);
    ASSERT_TRUE(has_all()) << mapper.log();
  }
  EXPECT_EQ(client.states.back().session(), 2);
  EXPECT_EQ(*client.mirror.map(), map) << "nothing at the wrong place";
}

/// Saves into a folder that can be broken.
class MapperOnABadDisk : protected TemporaryFolder, public MapperFaults {
 protected:
  MapperOnABadDisk() : MapperFaults({"semantic_mapper.output_dir=" + path().string()}) {}
  fs::path file() const { return path() / "map.lapis"; }
  std::vector<std::uint8_t> bytes() const {
    std::string error;
    const auto content = files::read_file(file().string(), error);
    EXPECT_TRUE(content) << error;
    return content.value_or(std::vector<std::uint8_t>{});
  }
  /// Answer of the service.
  std_srvs::srv::Trigger_Response save() {
    std::optional<std_srvs::srv::Trigger_Response> reply;
    EXPECT_TRUE(probe.wait_until([&] { return saver_.is_ready(); }));
    const auto call = saver_.call({});
    EXPECT_TRUE(probe.wait_until([&] { return (reply = saver_.take_reply(*call)).has_value(); })) << mapper.log();
    return reply.value_or(std_srvs::srv::Trigger_Response{});
  }
  /// Saving fails for that reason between the two, mapping continues, and the old file is as it was.
  void expect_refusal(const char* reason, const std::function<void()>& fail, const std::function<void()>& repair) {
    SCOPED_TRACE(reason);
    ASSERT_TRUE(save().success());
    const auto before = bytes();
    fail();
    const auto refused = save();
    EXPECT_FALSE(refused.success());
    EXPECT_THAT(refused.message(), HasSubstr(file().string()));
    EXPECT_THAT(refused.message(), HasSubstr(reason));
    EXPECT_TRUE(map_frame(index_++)) << "mapping continues" << mapper.log();
    repair();
    EXPECT_EQ(bytes(), before);
    EXPECT_FALSE(fs::exists(file().string() + ".part"));
    EXPECT_TRUE(save().success());
    EXPECT_NE(bytes(), before);
  }

  int index_ = 1;

 private:
  dds::ServiceClient<std_srvs::srv::Trigger>& saver_ = probe.client(topics::kSaveMap);
};

TEST_F(MapperOnABadDisk, SavingThatFailsIsReportedAndTheOldFileStaysWhole) {
  ASSERT_TRUE(map_frame(0)) << mapper.log();
  rlimit unlimited{};
  ASSERT_EQ(prlimit(mapper.pid(), RLIMIT_FSIZE, nullptr, &unlimited), 0);
  const rlimit small{64, unlimited.rlim_max};
  expect_refusal(
      "File too large", [&] { prlimit(mapper.pid(), RLIMIT_FSIZE, &small, nullptr); },
      [&] { prlimit(mapper.pid(), RLIMIT_FSIZE, &unlimited, nullptr); });
  const fs::path elsewhere = path().string() + "_elsewhere";
  expect_refusal(
      "No such file or directory", [&] { fs::rename(path(), elsewhere); }, [&] { fs::rename(elsewhere, path()); });
  expect_refusal(
      "Is a directory",
      [&] {
        fs::rename(file(), path() / "kept");
        fs::create_directories(file() / "in_the_way");
      },
      [&] {
        fs::remove_all(file());
        fs::rename(path() / "kept", file());
      });
}

/// A map of 10^8 voxels of known space that was saved before.
struct SavedHugeMap {
  SavedHugeMap() {
    constexpr std::int32_t kEdge = 58;  // blocks
    mapping::VoxelBlock seen(20 * mapping::kOneVote), torn = seen;
    torn.add_miss(7, mapping::kOneVote);
    for (std::int32_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const mapping::BlockIndex index{100 + i % kEdge, i / kEdge % kEdge, i / kEdge / kEdge};
      saved.map.set_block(index, i % 8 == 0 ? torn : seen);
    }
    EXPECT_FALSE(mapping::save_map(file, saved));
  }

  TemporaryFolder folder;
  std::string file = (folder.path() / "map.lapis").string();
  mapping::MapFile saved{mapping::VoxelMap(0.05), {}, {}, {}};
};

class MapperWithHugeMap : protected SavedHugeMap, public MapperFaults {
 protected:
  MapperWithHugeMap() : MapperFaults({"semantic_mapper.resolution_m=0.05", "semantic_mapper.resume_from=" + file}) {}
};

TEST_F(MapperWithHugeMap, HundredMillionVoxelsReachAClientAndTheMemoryIsBounded) {
  feed.send(feed.frame(0));
  slam.publish(tracked(0));
  ASSERT_TRUE(probe.wait_until([&] { return client.has_map(); }, Seconds(60))) << mapper.log();
  EXPECT_GE(client.mirror.map()->block_count(), saved.map.block_count());
  EXPECT_EQ(client.mirror.map()->read({800, 0, 0}), saved.map.read({800, 0, 0}));
  EXPECT_LE(client.states.back().tiles(), 2000u);
  const long mb = peak_memory_mb(mapper.pid());
  std::cout << "figure: peak memory of the mapper: " << mb << " MB\n";
  EXPECT_LT(mb, 300);
  EXPECT_TRUE(map_frame(1)) << mapper.log();
}

}  // namespace
}  // namespace lapis::test
