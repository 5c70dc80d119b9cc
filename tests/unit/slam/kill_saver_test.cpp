// A process that saves all the time is killed at random instants: slam.lapis is always one of the maps that it saved,
// and can be resumed. LAPIS_KILLS says how often, instead of 10 times; more when none of them hit a half-written
// file.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "common/files/atomic_file.hpp"
#include "slam/core/files/slam_file.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/support/endless_process.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

constexpr int kKillFrames = 40;

RgbdFrame kill_frame(int index) {
  return test::render_room(test::small_camera(), test::room_path(index), time::Time::from_seconds(1.0 + index / 30.0));
}

// The same run, saved early and late.
struct SavedRun {
  SavedRun() {
    RgbdSlam slam({}, test::room_path(0));
    for (int i = 0; i < kKillFrames; ++i) {
      slam.process(kill_frame(i));
      if (i == kKillFrames / 2) early = {1, 1, {}, slam.state()};
    }
    late = {1, 1, {}, slam.state()};
  }
  SlamFile early, late;
};

TEST(KillSaver, TheFileIsAlwaysWholeAndCanBeResumed) {
  const char* const wanted = std::getenv("LAPIS_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 10;
  const lapis::test::TemporaryFolder folder;
  const std::string path = (folder.path() / "slam.lapis").string();
  const SavedRun run;
  const auto early = encode_slam_file(run.early), late = encode_slam_file(run.late);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(write_slam_file(path, run.early), std::nullopt);
  const std::chrono::duration<double> one_save = std::chrono::steady_clock::now() - begin;

  std::mt19937 random(11);
  std::uniform_real_distribution<double> instant(0.0, 6.0);  // in times of one save
  int i = 0, in_the_middle = 0, with_late = 0;
  for (; i < kills || (in_the_middle == 0 && i < kills + 100); ++i) {
    lapis::test::EndlessProcess saver(
        [&] { return !write_slam_file(path, run.late) && !write_slam_file(path, run.early); });
    std::this_thread::sleep_for(instant(random) * one_save);
    ASSERT_TRUE(saver.kill());
    in_the_middle += std::filesystem::exists(path + ".part") ? 1 : 0;
    std::string error;
    const auto bytes = files::read_file(path, error);
    ASSERT_TRUE(bytes) << error;
    ASSERT_TRUE(*bytes == early || *bytes == late) << "kill " << i << ": a file that nobody has written";
    with_late += *bytes == late ? 1 : 0;
    auto file = read_slam_file(path, error);
    ASSERT_TRUE(file) << error;
    const int last = *bytes == late ? kKillFrames : kKillFrames / 2;
    RgbdSlam slam({}, Pose::Identity(), std::move(file->state));
    TrackingResult result;
    for (int k = 0; k <= SlamConfig{}.relocalization.confirmations; ++k) result = slam.process(kill_frame(last + k));
    ASSERT_EQ(result.state, TrackingState::kTracking) << "kill " << i << ": " << result.reason;
  }
  std::cout << "figure: " << i << " kills, " << in_the_middle
            << " while a file was being written; the later map was left " << with_late << " times; a save takes "
            << 1e3 * one_save.count() << " ms, " << late.size() << " bytes\n";
  EXPECT_GT(in_the_middle, 0);
}

}  // namespace
}  // namespace lapis::slam
