// lapis_slam saves its map and resumes it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/slam/slam_contract.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr auto kTracking = lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING;
constexpr auto kLost = lapis_msgs::msg::TrackedFrame_Constants::STATE_LOST;
constexpr int kSavedFrames = 24;  // of the first run

/// slam with a camera, and somebody who listens. Key-frames are near each other, so that short runs have several.
class Slam {
 public:
  explicit Slam(const fs::path& folder, std::vector<std::string> more = {}) : slam_(kSlam, arguments(folder, more)) {}

  bool is_ready() {
    return wait_until_ready(slam_) && probe_.wait_until([&] { return feed_.is_matched_by_slam(); }) &&
           probe_.wait_until_known_by("slam");
  }
  /// Sends a frame and waits for what slam says of it.
  bool answers(const CameraFrame& frame, int index) {
    feed_.send(frame);
    return probe_.wait_until([&] {
      return !frames.empty() && messages::from_message(frames.back().header().stamp()) == CameraFeed::stamp(index);
    });
  }
  bool is_tracked(int index) { return answers(feed_.frame(index), index) && frames.back().state() == kTracking; }
  /// Two frames say where the camera could be in the saved map, the third confirms it.
  bool finds_its_place(int from) {
    for (int i = from; i < from + 2; ++i) {
      if (is_tracked(i) || frames.back().reason().find("awaits confirmation") == std::string::npos) return false;
    }
    return is_tracked(from + 2);
  }
  bool are_tracked(int from, int to) {
    for (int i = from; i < to; ++i) {
      if (!is_tracked(i)) return false;
    }
    return true;
  }
  CameraFrame frame(int index) const { return feed_.frame(index); }
  CameraFrame frame(int index, const geometry::Pose& pose) const { return feed_.frame(CameraFeed::stamp(index), pose); }
  void send(const CameraFrame& frame) { feed_.send(frame); }
  bool wait_until(const std::function<bool()>& condition) { return probe_.wait_until(condition); }
  double count(const std::string& what) const { return sum_of(newest_values(diagnostics_, "slam"), what); }
  ChildProcess& slam() { return slam_; }
  std::string log() { return slam_.log(); }

 private:
  static std::vector<std::string> arguments(const fs::path& folder, const std::vector<std::string>& more) {
    std::vector<std::string> all{"--set", "slam.keyframe.max_translation_m=0.04", "--set",
                                 "slam.output_dir=" + folder.string()};
    for (const std::string& setting : more) all.insert(all.end(), {"--set", setting});
    return all;
  }

  TopicProbe probe_;
  CameraFeed feed_{probe_};

 public:
  const std::vector<lapis_msgs::msg::TrackedFrame>& frames = probe_.collect(topics::kTrackedFrame);
  const std::vector<lapis_msgs::msg::PoseGraph>& graphs = probe_.collect(topics::kPoseGraph);
  const std::vector<nav_msgs::msg::Odometry>& odometry = probe_.collect(topics::kSlamOdometry);
  const std::vector<lapis_msgs::msg::LandmarkState>& landmark_states = probe_.collect(topics::kLandmarkState);

 private:
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics_ = probe_.collect(topics::kDiagnostics);
  ChildProcess slam_;
};

class SavedMap : public ::testing::Test {
 protected:
  std::string file() const { return (folder_.path() / "slam.lapis").string(); }
  std::string resume() const { return "slam.resume_from=" + file(); }
  /// A whole run that leaves its map.
  void save_a_map() {
    Slam run(folder_.path(), {"slam.autosave_period_s=0"});
    ASSERT_TRUE(run.is_ready()) << run.log();
    ASSERT_TRUE(run.are_tracked(0, kSavedFrames)) << run.log();
    EXPECT_FALSE(fs::exists(file())) << "autosave is off";
    ASSERT_TRUE(run.wait_until([&] { return run.odometry.size() == kSavedFrames; })) << run.log();
    last_pose_ = *messages::from_message(run.odometry.back().pose().pose());
    session_ = run.frames.back().session();
    ASSERT_EQ(run.slam().stop(SIGTERM), 0) << run.log();
    ASSERT_TRUE(run.wait_until([&] {
      return !run.graphs.empty() && run.graphs.back().version() == run.frames.back().graph_version();
    })) << run.log();
    graph_ = run.graphs.back();
    ASSERT_GE(graph_.nodes().size(), 3U);
    ASSERT_TRUE(fs::exists(file()));
  }
  /// What slam says of a file that it refuses.
  std::string refusal(const std::string& path, const std::string& setting = "slam.output_dir=") const {
    ChildProcess slam(kSlam, {"--set", "slam.resume_from=" + path, "--set", setting});
    EXPECT_EQ(slam.wait(), 2) << slam.log();
    return slam.log();
  }

  TemporaryFolder folder_;
  geometry::Pose last_pose_;
  std::int64_t session_ = 0;
  lapis_msgs::msg::PoseGraph graph_;
};

TEST_F(SavedMap, IsResumedInANewSessionOfTheSameFrame) {
  ASSERT_NO_FATAL_FAILURE(save_a_map());
  Slam run(folder_.path(), {resume()});
  ASSERT_TRUE(run.is_ready()) << run.log();
  auto dark = run.frame(kSavedFrames);
  std::fill(dark.color->data().begin(), dark.color->data().end(), std::uint8_t{0});
  ASSERT_TRUE(run.answers(dark, kSavedFrames)) << run.log();
  EXPECT_EQ(run.frames.back().state(), kLost);
  EXPECT_THAT(run.frames.back().reason(), HasSubstr("looking for a place in the saved map"));
  EXPECT_GT(run.frames.back().session(), session_);

  ASSERT_TRUE(run.wait_until([&] { return !run.graphs.empty(); })) << "the saved graph is published at once";
  const auto& saved = run.graphs.front();
  ASSERT_EQ(saved.nodes().size(), graph_.nodes().size());
  EXPECT_EQ(saved.edges().size(), graph_.edges().size());
  EXPECT_EQ(saved.version(), graph_.version());
  for (std::size_t i = 0; i < saved.nodes().size(); ++i) {
    EXPECT_EQ(saved.nodes()[i].id(), graph_.nodes()[i].id());
    EXPECT_EQ(saved.nodes()[i].pose(), graph_.nodes()[i].pose());
  }

  ASSERT_TRUE(run.finds_its_place(kSavedFrames + 1)) << run.frames.back().reason() << run.log();
  ASSERT_TRUE(run.are_tracked(kSavedFrames + 4, kSavedFrames + 15)) << run.frames.back().reason() << run.log();
  EXPECT_GE(run.frames.back().keyframe_id(), saved.nodes().size());
  ASSERT_TRUE(run.wait_until([&] { return run.odometry.size() == 12; })) << run.log();
  const auto T_camera = slow_motion(kSavedFrames - 1).inverse() * slow_motion(kSavedFrames + 14);
  const auto T_expected = T_base_camera() * T_camera * T_base_camera().inverse();
  const auto T_base = last_pose_.inverse() * *messages::from_message(run.odometry.back().pose().pose());
  EXPECT_LT((T_base.translation() - T_expected.translation()).norm(), 0.02) << "the frame is not the same";
  ASSERT_EQ(run.slam().stop(SIGTERM), 0) << run.log();
  EXPECT_FALSE(fs::exists(folder_.path() / "slam.1.lapis")) << "the new file holds all of the old one";
  EXPECT_FALSE(fs::exists(folder_.path() / "pose_graph.1.g2o"));
}

// Tracked, covered, and elsewhere until mapping goes on there.
TEST_F(SavedMap, WithASubMapIsTheSameInTwoRuns) {
  constexpr int kMapped = 90, kCovered = 10, kElsewhere = 30;
  constexpr auto kUnconnected = lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED;
  const auto turned = geometry::make_pose(
      Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitY())));
  std::vector<std::vector<std::uint8_t>> saved;
  for (int i = 0; i < 2; ++i) {
    const TemporaryFolder folder;
    Slam run(folder.path(), {"slam.autosave_period_s=0", "slam.sub_map.after_frames=8", "slam.sub_map.evidence_m=0.5"});
    ASSERT_TRUE(run.is_ready()) << run.log();
    ASSERT_TRUE(run.are_tracked(0, kMapped)) << run.log();
    int index = kMapped;
    for (; index < kMapped + kCovered; ++index) {
      auto covered = run.frame(index);
      std::fill(covered.color->data().begin(), covered.color->data().end(), std::uint8_t{0});
      ASSERT_TRUE(run.answers(covered, index)) << run.log();
    }
    for (; index < kMapped + kCovered + kElsewhere; ++index) {
      ASSERT_TRUE(run.answers(run.frame(index, slow_motion(index) * turned), index)) << run.log();
    }
    EXPECT_EQ(run.frames.back().state(), kUnconnected) << run.frames.back().reason();
    ASSERT_EQ(run.slam().stop(SIGTERM), 0) << run.log();
    std::string error;
    const auto bytes = files::read_file((folder.path() / "slam.lapis").string(), error);
    ASSERT_TRUE(bytes) << error;
    saved.push_back(*bytes);
  }
  EXPECT_TRUE(saved[0] == saved[1]);
}

TEST_F(SavedMap, IsSetAsideByANewMap) {
  ASSERT_NO_FATAL_FAILURE(save_a_map());
  std::string error;
  const auto before = files::read_file(file(), error);
  Slam run(folder_.path());
  ASSERT_TRUE(run.is_ready()) << run.log();
  ASSERT_TRUE(run.is_tracked(0)) << run.log();
  ASSERT_EQ(run.slam().stop(SIGTERM), 0) << run.log();
  EXPECT_EQ(files::read_file((folder_.path() / "slam.1.lapis").string(), error), before) << error;
  EXPECT_NE(files::read_file(file(), error), before) << error;
}

TEST_F(SavedMap, OfAKilledProcessIsTheOneThatItSavedByItself) {
  int index = 0;
  {
    Slam run(folder_.path(), {"slam.autosave_period_s=0.3"});
    ASSERT_TRUE(run.is_ready()) << run.log();
    ASSERT_TRUE(run.wait_until([&] { return run.is_tracked(index++) && fs::exists(file()); })) << run.log();
    run.slam().signal(SIGKILL);
    EXPECT_EQ(run.slam().wait(), -SIGKILL);
  }
  Slam run(folder_.path(), {resume()});
  ASSERT_TRUE(run.is_ready()) << run.log();
  ASSERT_TRUE(run.finds_its_place(index)) << run.frames.back().reason() << run.log();
}

// It dies three times; the second time before it has saved anything by itself.
TEST_F(SavedMap, ContinuesInItsSessionAndNoIdMeansTwoThings) {
  std::set<std::int64_t> sessions, epochs;
  std::set<std::uint64_t> ids;
  std::uint64_t last_version = 0;
  int index = 0;
  const std::string continues = "slam.resume_session=true", never = "slam.autosave_period_s=0";
  for (const auto& settings : std::vector<std::vector<std::string>>{
           {"slam.autosave_period_s=0.3"}, {resume(), continues, never}, {resume(), continues, never}}) {
    Slam run(folder_.path(), settings);
    ASSERT_TRUE(run.is_ready()) << run.log();
    const std::size_t known = ids.size();
    ASSERT_TRUE(run.wait_until([&] {
      if (!run.answers(run.frame(index), index)) return false;
      ++index;
      const auto& frame = run.frames.back();
      sessions.insert(frame.session());
      const bool is_new = !frame.is_keyframe() || ids.insert(frame.keyframe_id()).second;
      EXPECT_TRUE(is_new) << frame.keyframe_id();
      EXPECT_GE(frame.graph_version(), last_version);
      return ids.size() >= known + 2 && !run.landmark_states.empty() && fs::exists(file());
    })) << run.log();
    ASSERT_TRUE(run.wait_until([&] { return !run.graphs.empty(); }));
    EXPECT_GT(run.graphs.back().version(), std::exchange(last_version, run.frames.back().graph_version()));
    EXPECT_TRUE(epochs.insert(run.landmark_states.back().epoch()).second);
    EXPECT_EQ(run.landmark_states.back().epoch(), *epochs.rbegin()) << "epochs grow";
    run.slam().signal(SIGKILL);
    EXPECT_EQ(run.slam().wait(), -SIGKILL);
  }
  EXPECT_EQ(sessions.size(), 1U);
  EXPECT_GT(*ids.rbegin(), 2'000'000U) << "each restart skips a million";
}

TEST_F(SavedMap, ThatCannotBeWrittenIsCountedAndTrackingContinues) {
  const fs::path folder = folder_.path() / "gone";
  Slam run(folder, {"slam.autosave_period_s=0.2"});
  ASSERT_TRUE(run.is_ready()) << run.log();
  fs::remove_all(folder);
  int index = 0;
  ASSERT_TRUE(run.wait_until([&] { return run.is_tracked(index++) && run.count("map not saved") > 0; })) << run.log();
  EXPECT_THAT(run.log(), HasSubstr((folder / "slam.lapis").string()));
  fs::create_directories(folder);
  ASSERT_TRUE(run.wait_until([&] { return run.is_tracked(index++) && fs::exists(folder / "slam.lapis"); }))
      << run.log();
  EXPECT_EQ(run.slam().stop(SIGTERM), 0) << run.log();
}

TEST_F(SavedMap, ThatIsNoneOrDamagedIsRefusedAtTheStart) {
  ASSERT_NO_FATAL_FAILURE(save_a_map());
  const auto with_file = [&](const std::string& reason) { return HasSubstr("slam.resume_from: " + reason); };
  EXPECT_THAT(refusal("/no/such.lapis"), with_file("/no/such.lapis: cannot be opened"));
  EXPECT_THAT(refusal(folder_.path().string()), with_file(folder_.path().string() + ": is not a file"));
  EXPECT_THAT(refusal((folder_.path() / "pose_graph.g2o").string()),
              with_file((folder_.path() / "pose_graph.g2o").string() + ": is not a map saved by lapis_slam"));
  EXPECT_THAT(refusal(file(), "slam.features.scale_factor=1.2"),
              with_file(file() + ": slam.features.scale_factor was"));
  std::string error;
  const auto good = *files::read_file(file(), error);
  const auto spoil = [&](auto change) {
    auto bytes = good;
    change(bytes);
    EXPECT_FALSE(files::replace_file(file(), bytes));
    return refusal(file());
  };
  EXPECT_THAT(spoil([](auto& bytes) { bytes.resize(bytes.size() / 2); }), with_file(file() + ": is damaged"));
  EXPECT_THAT(spoil([](auto& bytes) { bytes[bytes.size() / 2] ^= 4U; }), HasSubstr("another checksum"));
  EXPECT_THAT(spoil([](auto& bytes) { bytes[8] = 9; }), HasSubstr("format version 9"));
}

TEST_F(SavedMap, OfAnotherCameraIsRefusedWithTheFirstFrame) {
  ASSERT_NO_FATAL_FAILURE(save_a_map());
  std::string error;
  const auto before = files::read_file(file(), error);
  Slam run(folder_.path(), {resume()});
  ASSERT_TRUE(run.is_ready()) << run.log();
  auto frame = run.frame(kSavedFrames);
  frame.info->k()[0] *= 1.5;
  run.send(frame);
  EXPECT_EQ(run.slam().wait(), 2) << run.log();
  EXPECT_THAT(run.log(), HasSubstr("slam.resume_from: " + file() + ": was made with another camera"));
  EXPECT_EQ(files::read_file(file(), error), before) << error;
}

}  // namespace
}  // namespace lapis::test
