#include <algorithm>
#include <ctime>
#include <iostream>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "slam/core/rgbd_slam.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/slam/tum_sequence.hpp"

namespace lapis::slam {
namespace {

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Tracks a shared recording, prints one line of figures, checks the online trajectory.
void expect_tracked(const std::string& name, double max_ate_m) {
  const auto sequence = test::find_sequence(name);
  if (!sequence) GTEST_SKIP() << lapis::test::missing_test_data("rgbd/" + name);
  cv::setNumThreads(1);
  RgbdSlam slam({}, geometry::Pose::Identity());
  std::vector<geometry::Pose> truth, estimate;
  std::vector<double> times_ms;
  for (std::size_t i = 0; i < sequence->entries.size(); ++i) {
    const RgbdFrame frame = sequence->load(i);
    const double start_ms = cpu_ms();
    const TrackingResult result = slam.process(frame);
    times_ms.push_back(cpu_ms() - start_ms);
    ASSERT_EQ(result.state, TrackingState::kTracking) << "frame " << i << ": " << result.reason;
    truth.push_back(sequence->entries[i].T_world_camera);
    estimate.push_back(result.T_map_keyframe * result.T_keyframe_camera);
  }
  std::sort(times_ms.begin(), times_ms.end());
  double sum_ms = 0.0;
  for (const double t : times_ms) sum_ms += t;
  const auto count = times_ms.size();
  std::cout << name << ": " << count << " of " << count << " tracked, ATE " << 100.0 * test::ate_se3(truth, estimate)
            << " cm (SE(3)), " << 100.0 * test::ate_origin(truth, estimate) << " cm (origin), "
            << slam.pose_graph().nodes.size() << " key-frames, CPU " << sum_ms / static_cast<double>(count)
            << " ms mean, " << times_ms[count * 95 / 100] << " ms p95\n";
  EXPECT_LE(test::ate_se3(truth, estimate), max_ate_m);
}

TEST(Sequence, RedwoodLivingroom) { expect_tracked("redwood_livingroom1", 0.008); }
TEST(Sequence, AwsSmallHouse) { expect_tracked("aws_small_house_loop", 0.05); }

}  // namespace
}  // namespace lapis::slam
