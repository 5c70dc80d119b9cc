#include "evaluator/core/run_record.hpp"

#include <gtest/gtest.h>

namespace lapis::evaluator {
namespace {

time::Time at(double seconds) { return {static_cast<std::int64_t>(seconds * 1e9)}; }

geometry::Pose pose_at(double x_m) { return geometry::Pose(Eigen::Translation3d(x_m, 0.0, 0.0)); }

RunMetrics metrics_of(const RunRecord& record, std::int64_t frames_missed = 0) {
  RunMetrics metrics;
  record.write_to(metrics, {}, frames_missed, true);
  return metrics;
}

TEST(RunRecord, TheFirstFrameWithBothPosesJoinsMapAndWorld) {
  RunRecord record;
  record.add({at(1.0), 7, pose_at(0.0), std::nullopt});
  record.add({at(1.1), 7, pose_at(0.1), pose_at(5.0)});
  record.add({at(1.2), 7, pose_at(0.3), pose_at(5.1)});
  ASSERT_TRUE(record.T_map_world());
  EXPECT_NEAR(record.T_map_world()->translation().x(), -4.9, 1e-12);
  EXPECT_NEAR(record.position_error_m().value(), 0.1, 1e-12);
  EXPECT_NEAR(record.path_length_m().value(), 0.1, 1e-12);
  EXPECT_NEAR(record.time_s(), 0.2, 1e-9);
}

TEST(RunRecord, AFrameWithoutAPoseIsLostTime) {
  RunRecord record;
  record.add({at(1.0), 7, pose_at(0.0), pose_at(0.0)});
  record.add({at(1.5), 7, std::nullopt, pose_at(0.2)});
  EXPECT_FALSE(record.position_error_m());
  record.add({at(2.0), 7, pose_at(0.3), pose_at(0.3)});
  const RunMetrics metrics = metrics_of(record);
  EXPECT_EQ(metrics.frames_tracked, 2);
  EXPECT_NEAR(metrics.lost_time_s.value(), 0.5, 1e-9);
  EXPECT_EQ(metrics.exit_reason, "lost");
}

TEST(RunRecord, FramesOfALaterSessionAreLost) {
  RunRecord record;
  EXPECT_TRUE(record.add({at(1.0), 7, pose_at(0.0), pose_at(0.0)}));
  EXPECT_FALSE(record.add({at(2.0), 8, pose_at(3.0), pose_at(0.0)}));
  EXPECT_EQ(record.session(), 7);
  EXPECT_EQ(record.estimate().size(), 1u);
  EXPECT_NEAR(metrics_of(record).lost_time_s.value(), 1.0, 1e-9);
}

TEST(RunRecord, RepeatedCameraFramesCountOnceAndMissedOnesToo) {
  RunRecord record;
  EXPECT_TRUE(record.is_empty());
  for (const double stamp_s : {5.0, 5.1, 5.1, 5.0, 5.2}) record.count_camera_frame(at(stamp_s));
  EXPECT_EQ(metrics_of(record).frames_total, 3);
  record.count_camera_frame(at(1.0));  // the source began anew
  EXPECT_EQ(metrics_of(record).frames_total, 4);
  EXPECT_EQ(metrics_of(record, 2).frames_total, 6);
  EXPECT_FALSE(record.is_empty());
}

TEST(RunRecord, ACollisionIsTheBeginningOfAContact) {
  RunRecord record;
  EXPECT_FALSE(metrics_of(record).collisions);
  for (const bool is_in_contact : {false, true, true, false, true}) record.count_contact(is_in_contact);
  EXPECT_EQ(metrics_of(record).collisions, 2);
}

}  // namespace
}  // namespace lapis::evaluator
