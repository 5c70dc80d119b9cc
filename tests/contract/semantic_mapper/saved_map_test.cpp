// lapis_semantic_mapper resumes the map of an earlier run, or rebuilds that of a killed process from its frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "semantic_mapper/core/map_merge.hpp"
#include "tests/contract/semantic_mapper/mapper_contract.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class SavedSemanticMap : public ::testing::Test {
 protected:
  std::string file() const { return (folder_.path() / "map.lapis").string(); }
  std::string resume() const { return "semantic_mapper.resume_from=" + file(); }
  std::string output() const { return "semantic_mapper.output_dir=" + folder_.path().string(); }
  mapping::MapFile load(const std::string& path) const {
    std::string error;
    auto map = mapping::load_map(path, error);
    EXPECT_TRUE(map) << error;
    return map.value();
  }
  /// A whole run that maps these frames and leaves its map.
  void save_a_map(const std::vector<std::string>& settings, int from, int to, std::int64_t session) {
    MapperRun run(settings);
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    for (int i = from; i < to; ++i) ASSERT_TRUE(run.map_frame(i, session)) << run.mapper.log();
    mirrored_ = *run.client.mirror.map();
    ASSERT_EQ(run.mapper.stop(SIGTERM), 0) << run.mapper.log();
  }
  std::string refusal(const std::string& path) const {
    ChildProcess mapper(kMapper, {"--set", "semantic_mapper.resume_from=" + path});
    EXPECT_EQ(mapper.wait(), 2) << mapper.log();
    return mapper.log();
  }

  TemporaryFolder folder_;
  mapping::VoxelMap mirrored_{0.25};
};

TEST_F(SavedSemanticMap, IsResumedAsIfItHadNeverEnded) {
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 4, 1));
  const mapping::MapFile base = load(file());
  EXPECT_EQ(base.map, mirrored_);
  const TemporaryFolder other;
  ASSERT_NO_FATAL_FAILURE(save_a_map({"semantic_mapper.output_dir=" + other.path().string()}, 4, 7, 2));
  mapping::MapFile expected = base;
  semantic_mapper::merge_into(expected, load((other.path() / "map.lapis").string()), geometry::Pose::Identity());

  ASSERT_NO_FATAL_FAILURE(save_a_map({output(), resume()}, 4, 7, 2));
  const mapping::MapFile resumed = load(file());
  EXPECT_EQ(mirrored_, expected.map) << "the whole map is published, and the new frames are added to it";
  EXPECT_EQ(resumed.map, expected.map);
  EXPECT_EQ(mapping::LabelList::united(base.labels, resumed.labels), resumed.labels) << "no name is lost";
  EXPECT_EQ(resumed.provenance.at("frames"), "7");
  EXPECT_FALSE(fs::exists(folder_.path() / "map.1.lapis")) << "the new file holds all of the old one";
}

TEST_F(SavedSemanticMap, OfAKilledProcessIsTheOneThatItSavedByItself) {
  int index = 0;
  {
    MapperRun run({output(), "semantic_mapper.save_period_s=1"});
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    ASSERT_TRUE(run.probe.wait_until([&] { return run.map_frame(index++) && fs::exists(file()); })) << run.mapper.log();
    run.mapper.signal(SIGKILL);
    EXPECT_EQ(run.mapper.wait(), -SIGKILL);
  }
  const mapping::MapFile base = load(file());
  ASSERT_NO_FATAL_FAILURE(save_a_map({output(), resume()}, index, index + 1, 1));
  EXPECT_GE(mirrored_.block_count(), base.map.block_count());
  EXPECT_EQ(std::stoi(load(file()).provenance.at("frames")), std::stoi(base.provenance.at("frames")) + 1);
}

TEST_F(SavedSemanticMap, IsSetAsideByANewMap) {
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 2, 1));
  std::string error;
  const auto before = files::read_file(file(), error);
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 2, 4, 2));
  EXPECT_EQ(files::read_file((folder_.path() / "map.1.lapis").string(), error), before) << error;
}

TEST_F(SavedSemanticMap, IsResumedBySupervisedRestartsOnlyInTheSameSessionOfSlam) {
  const std::string same_session = "semantic_mapper.resume_any_session=false";
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 2, 7));
  ASSERT_NO_FATAL_FAILURE(save_a_map({output(), resume(), same_session}, 2, 4, 7));
  EXPECT_EQ(load(file()).provenance.at("frames"), "4");
  EXPECT_FALSE(fs::exists(folder_.path() / "map.1.lapis"));
  for (const int session : {8, 6}) {
    std::string error;
    const auto before = files::read_file(file(), error);
    ASSERT_NO_FATAL_FAILURE(save_a_map({output(), resume(), same_session}, 4, 6, session));
    EXPECT_EQ(load(file()).provenance.at("frames"), "2") << "a new map";
    const std::string aside = session == 8 ? "map.1.lapis" : "map.2.lapis";
    EXPECT_EQ(files::read_file((folder_.path() / aside).string(), error), before) << error;
  }
}

TEST_F(SavedSemanticMap, IsNotMixedWithTheNextMapOfSlam) {
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 2, 1));
  mapping::VoxelMap last(0.25);
  {
    MapperRun run({resume()});
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    ASSERT_TRUE(run.map_frame(2, 2)) << run.mapper.log();
    ASSERT_TRUE(run.map_frame(3, 3)) << run.mapper.log();
    last = *run.client.mirror.map();
  }
  ASSERT_NO_FATAL_FAILURE(save_a_map({}, 3, 4, 1));
  EXPECT_EQ(last, mirrored_);
}

TEST_F(SavedSemanticMap, ThatCannotBeResumedIsRefusedInOneLine) {
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 2, 7));
  EXPECT_THAT(refusal("/no/such.lapis"), HasSubstr("semantic_mapper.resume_from: /no/such.lapis: cannot be opened"));
  ChildProcess coarse(kMapper, {"--set", resume(), "--set", "semantic_mapper.resolution_m=0.5"});
  EXPECT_EQ(coarse.wait(), 2) << coarse.log();
  EXPECT_THAT(coarse.log(), HasSubstr(file() + ": semantic_mapper.resolution_m was 0.25"));
  ChildProcess spread(kMapper, {"--set", resume(), "--set", "semantic_mapper.sensor_model.fusion=bki"});
  EXPECT_EQ(spread.wait(), 2) << spread.log();
  EXPECT_THAT(spread.log(), HasSubstr(file() + ": semantic_mapper.sensor_model.fusion was log_odds"));
  {
    MapperRun run({resume()});
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    run.send(run.feed.frame(2), 2, 6);
    EXPECT_EQ(run.mapper.wait(), 2) << run.mapper.log();
    EXPECT_THAT(run.mapper.log(), HasSubstr("belongs to a later session of slam; give slam.resume_from"));
  }
  mapping::MapFile other = load(file());
  other.labels = mapping::LabelList::from_names({{1, "unicorn"}});
  ASSERT_EQ(mapping::save_map(file(), other), std::nullopt);
  {
    MapperRun run({resume()});
    EXPECT_EQ(run.mapper.wait(), 2) << run.mapper.log();
    EXPECT_THAT(run.mapper.log(), HasSubstr("/camera/semantic/label_info: class 1 is '"));
  }
  std::string error;
  auto bytes = *files::read_file(file(), error);
  bytes[bytes.size() / 2] ^= 4U;
  ASSERT_FALSE(files::replace_file(file(), bytes));
  EXPECT_THAT(refusal(file()), HasSubstr("semantic_mapper.resume_from: " + file() + ": is damaged"));
}

/// Keeps frames in frames.lapis, is killed, and starts again with that file.
class KeptFrames : public SavedSemanticMap {
 protected:
  std::string journal() const { return (folder_.path() / "frames.lapis").string(); }
  std::vector<std::string> keeping() const { return {output(), "semantic_mapper.keep_frames=true"}; }
  std::vector<std::string> rebuilding() const {
    return {output(), "semantic_mapper.keep_frames=true", "semantic_mapper.resume_from=" + journal()};
  }
  static void kill(MapperRun& run) {
    run.mapper.signal(SIGKILL);
    EXPECT_EQ(run.mapper.wait(), -SIGKILL);
  }
  /// A process that maps these frames and is killed.
  void map_and_die(const std::vector<std::string>& settings, int from, int to) {
    MapperRun run(settings);
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    for (int i = from; i < to; ++i) ASSERT_TRUE(run.map_frame(i)) << run.mapper.log();
    kill(run);
  }
  static geometry::Pose corrected_keyframe() {
    geometry::Pose T = T_base_camera();
    T.translation() += Eigen::Vector3d(0.7, -0.4, 0.0);
    return T;
  }
  /// The map of all frames before `end`, by a process that never died, when the key-frame is there.
  static mapping::VoxelMap map_of(int end, const geometry::Pose& T_map_keyframe) {
    MapperRun run;
    EXPECT_TRUE(run.is_ready()) << run.mapper.log();
    for (int i = 0; i < end; ++i) {
      auto pose = run.tracked(i);
      pose.keyframe_pose(messages::to_message(T_map_keyframe));
      run.feed.send(run.feed.frame(i));
      run.slam.publish(pose);
      EXPECT_TRUE(run.probe.wait_until([&] {
        return !run.client.states.empty() && run.client.has_map() &&
               run.client.states.back().frames_integrated() == static_cast<std::uint64_t>(i) + 1;
      })) << run.mapper.log();
    }
    return run.client.has_map() ? *run.client.mirror.map() : mapping::VoxelMap(0.25);
  }
};

TEST_F(KeptFrames, AreThoseOfAMapThatGoesOnAndFollowsTheGraph) {
  const mapping::VoxelMap expected = map_of(5, T_base_camera()), corrected = map_of(5, corrected_keyframe());
  ASSERT_NO_FATAL_FAILURE(map_and_die(keeping(), 0, 3));
  ASSERT_NO_FATAL_FAILURE(map_and_die(rebuilding(), 3, 4));
  {
    MapperRun run(rebuilding());
    auto& graph = run.probe.advertise(topics::kPoseGraph);
    ASSERT_TRUE(run.is_ready() && run.probe.wait_until([&] { return graph.matched() > 0; })) << run.mapper.log();
    ASSERT_TRUE(run.map_frame(4)) << run.mapper.log();
    EXPECT_EQ(run.client.states.back().frames_integrated(), 5U);
    EXPECT_EQ(*run.client.mirror.map(), expected);

    lapis_msgs::msg::PoseGraph message;
    message.session(1);
    message.version(2);
    lapis_msgs::msg::PoseGraphNode node;
    node.pose(messages::to_message(corrected_keyframe()));
    message.nodes({node});
    graph.publish(message);
    ASSERT_TRUE(run.probe.wait_until([&] {
      return run.client.states.back().graph_version() == 2 && run.client.states.back().frames_off() == 0 &&
             run.client.has_map();
    })) << run.mapper.log();
    EXPECT_EQ(*run.client.mirror.map(), corrected);
    EXPECT_EQ(run.mapper.stop(SIGTERM), 0) << run.mapper.log();
    EXPECT_THAT(run.mapper.log(), HasSubstr("rebuilt 4 frames from " + journal()));
  }
  EXPECT_EQ(load(file()).map, corrected);
  EXPECT_EQ(load(file()).provenance.at("frames"), "5");
  EXPECT_FALSE(fs::exists(folder_.path() / "map.1.lapis")) << "it is one map";
  EXPECT_FALSE(fs::exists(folder_.path() / "frames.1.lapis"));
  EXPECT_FALSE(fs::exists(journal())) << "the map is whole, so nobody needs its frames";
}

TEST_F(KeptFrames, ThatComeAgainAfterTheRestartAreNotIntegratedTwice) {
  const mapping::VoxelMap expected = map_of(3, T_base_camera());
  ASSERT_NO_FATAL_FAILURE(map_and_die(keeping(), 0, 3));
  MapperRun run(rebuilding());
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  ASSERT_TRUE(run.map_frame(2)) << run.mapper.log();
  EXPECT_EQ(run.client.states.back().frames_integrated(), 3U);
  EXPECT_EQ(messages::from_message(run.client.states.back().header().stamp()), CameraFeed::stamp(2));
  EXPECT_EQ(*run.client.mirror.map(), expected);
}

TEST_F(KeptFrames, OfATornFileAreThoseBeforeTheTear) {
  ASSERT_NO_FATAL_FAILURE(map_and_die(keeping(), 0, 3));
  fs::resize_file(journal(), fs::file_size(journal()) - 1);
  MapperRun run(rebuilding());
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  ASSERT_TRUE(run.map_frame(3)) << run.mapper.log();
  EXPECT_EQ(run.client.states.back().frames_integrated(), 3U);
  kill(run);
  EXPECT_THAT(run.mapper.log(), HasSubstr("rebuilt 2 frames from "));
  EXPECT_THAT(run.mapper.log(), HasSubstr("bytes after the last whole frame are not used"));
}

TEST_F(KeptFrames, OfAnotherSessionAreSetAside) {
  ASSERT_NO_FATAL_FAILURE(map_and_die(keeping(), 0, 3));
  std::string error;
  const auto before = files::read_file(journal(), error);
  {
    MapperRun run(rebuilding());
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    ASSERT_TRUE(run.map_frame(3, 2)) << run.mapper.log();
    EXPECT_EQ(run.client.states.back().frames_integrated(), 1U);
    ASSERT_TRUE(run.map_frame(4, 3)) << run.mapper.log();
    kill(run);
    EXPECT_THAT(run.mapper.log(), HasSubstr(journal() + " is of another session of slam; a new map begins"));
  }
  EXPECT_EQ(files::read_file((folder_.path() / "frames.1.lapis").string(), error), before) << error;
  EXPECT_TRUE(fs::exists(folder_.path() / "frames.2.lapis")) << "each session has a journal of its own";
}

// Its new frames alone would not be the map: a mapper that dies resumes the counts, old and new.
TEST_F(KeptFrames, AreNoneOfAMapThatIsResumedFromCounts) {
  ASSERT_NO_FATAL_FAILURE(save_a_map({output()}, 0, 2, 1));
  std::ofstream(journal()) << "of an earlier run";
  std::vector<std::string> settings = keeping();
  settings.push_back(resume());
  MapperRun run(settings);
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  ASSERT_TRUE(run.map_frame(2)) << run.mapper.log();
  EXPECT_FALSE(fs::exists(journal()));
  EXPECT_TRUE(fs::exists(folder_.path() / "frames.1.lapis"));
  EXPECT_TRUE(run.mapper.wait_for_line(file() + " holds counts without frames, so no frames are kept"))
      << run.mapper.log();
}

TEST_F(KeptFrames, ThatTheDiskDoesNotTakeAreCountedAndMappingContinues) {
  {
    MapperRun run(keeping());
    ASSERT_TRUE(run.is_ready()) << run.mapper.log();
    ASSERT_TRUE(run.map_frame(0)) << run.mapper.log();
    rlimit unlimited{};
    ASSERT_EQ(prlimit(run.mapper.pid(), RLIMIT_FSIZE, nullptr, &unlimited), 0);
    const rlimit small{64, unlimited.rlim_max};
    ASSERT_EQ(prlimit(run.mapper.pid(), RLIMIT_FSIZE, &small, nullptr), 0);
    ASSERT_TRUE(run.map_frame(1)) << run.mapper.log();
    EXPECT_TRUE(run.wait_for_count("frames not kept: disk", 1)) << run.mapper.log();
    ASSERT_EQ(prlimit(run.mapper.pid(), RLIMIT_FSIZE, &unlimited, nullptr), 0);
    ASSERT_TRUE(run.map_frame(2)) << run.mapper.log();
    kill(run);
    EXPECT_THAT(run.mapper.log(), HasSubstr("frame not kept: " + journal() + ": cannot be written: File too large"));
  }
  MapperRun run(rebuilding());
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  ASSERT_TRUE(run.map_frame(3)) << run.mapper.log();
  EXPECT_EQ(run.client.states.back().frames_integrated(), 3U) << "all but the one in the middle";
}

TEST_F(KeptFrames, OfAFrozenMapStayWhereTheyAre) {
  const mapping::VoxelMap expected = map_of(4, T_base_camera());
  const auto with_frozen = [](std::vector<std::string> settings) {
    settings.push_back("semantic_mapper.re_anchor=false");
    return settings;
  };
  ASSERT_NO_FATAL_FAILURE(map_and_die(with_frozen(keeping()), 0, 3));
  MapperRun run(with_frozen(rebuilding()));
  ASSERT_TRUE(run.is_ready()) << run.mapper.log();
  ASSERT_TRUE(run.map_frame(3)) << run.mapper.log();
  EXPECT_EQ(run.client.states.back().frames_integrated(), 4U);
  EXPECT_EQ(*run.client.mirror.map(), expected);
}

TEST_F(KeptFrames, NeedAFolder) {
  const std::string keep = "semantic_mapper.keep_frames=true";
  ChildProcess homeless(kMapper, {"--set", keep});
  EXPECT_EQ(homeless.wait(), 2) << homeless.log();
  EXPECT_THAT(homeless.log(), HasSubstr("semantic_mapper.keep_frames (true) needs semantic_mapper.output_dir"));
}

}  // namespace
}  // namespace lapis::test
