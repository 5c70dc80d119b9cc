#include "evaluator/core/run/run_record.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lapis::evaluator {
namespace {

time::Time at(double seconds) { return {static_cast<std::int64_t>(seconds * 1e9)}; }

geometry::Pose pose_at(double x_m) { return geometry::Pose(Eigen::Translation3d(x_m, 0.0, 0.0)); }

constexpr int kSession = 7;

FrameRecord frame(double stamp_s, std::int64_t session, std::optional<geometry::Pose> T_map_camera,
                  std::optional<geometry::Pose> T_world_camera) {
  return {at(stamp_s), session, T_map_camera ? PoseTier::kVision : PoseTier::kNone, T_map_camera, T_world_camera, {}};
}

/// Where truth is; held by `tier`.
FrameRecord held_by(PoseTier tier, double stamp_s) {
  const auto T_map_camera = tier == PoseTier::kNone ? std::nullopt : std::optional(pose_at(0.0));
  return {at(stamp_s), kSession, tier, T_map_camera, pose_at(0.0), {}};
}

RunMetrics metrics_of(const RunRecord& record, std::int64_t frames_missed = 0) {
  RunMetrics metrics;
  record.write_to(metrics, {}, frames_missed, true);
  return metrics;
}

TEST(RunRecord, TheFirstFrameWithBothPosesJoinsMapAndWorld) {
  RunRecord record;
  record.add(frame(1.0, kSession, pose_at(0.0), std::nullopt));
  record.add(frame(1.1, kSession, pose_at(0.1), pose_at(5.0)));
  record.add(frame(1.2, kSession, pose_at(0.3), pose_at(5.1)));
  ASSERT_TRUE(record.T_map_world());
  EXPECT_NEAR(record.T_map_world()->translation().x(), -4.9, 1e-12);
  EXPECT_NEAR(record.position_error_m().value(), 0.1, 1e-12);
  EXPECT_NEAR(record.path_length_m().value(), 0.1, 1e-12);
  EXPECT_NEAR(record.time_s(), 0.2, 1e-9);
}

TEST(RunRecord, AFrameWithoutAPoseIsLostTime) {
  RunRecord record;
  record.add(frame(1.0, kSession, pose_at(0.0), pose_at(0.0)));
  record.add(frame(1.5, kSession, std::nullopt, pose_at(0.2)));
  EXPECT_FALSE(record.position_error_m());
  record.add(frame(2.0, kSession, pose_at(0.3), pose_at(0.3)));
  const RunMetrics metrics = metrics_of(record);
  EXPECT_EQ(metrics.frames_tracked, 2);
  EXPECT_NEAR(metrics.lost_time_s.value(), 0.5, 1e-9);
  EXPECT_EQ(metrics.exit_reason, "completed") << "it had a pose again";
}

TEST(RunRecord, LostIsWhoHasNoPoseToTheEnd) {
  RunRecord record;
  record.count_camera_frame(at(0.0));
  EXPECT_EQ(metrics_of(record).exit_reason, "lost") << "never had one";
  record.add(held_by(PoseTier::kVision, 0.0));
  record.add(held_by(PoseTier::kNone, 1.0));
  record.add(held_by(PoseTier::kNone, 5.0));
  EXPECT_EQ(metrics_of(record).exit_reason, "completed");
  record.add(held_by(PoseTier::kNone, 5.1));
  EXPECT_EQ(metrics_of(record).exit_reason, "lost");
  record.add(held_by(PoseTier::kOdometry, 6.0));
  EXPECT_EQ(metrics_of(record).exit_reason, "completed");
  record.count_camera_frame(at(11.1));
  EXPECT_EQ(metrics_of(record).exit_reason, "lost") << "slam answers no more";
}

TEST(RunRecord, FramesOfALaterSessionAreLost) {
  RunRecord record;
  EXPECT_TRUE(record.add(frame(1.0, kSession, pose_at(0.0), pose_at(0.0))));
  EXPECT_FALSE(record.add(frame(2.0, kSession + 1, pose_at(3.0), pose_at(0.0))));
  EXPECT_EQ(record.session(), kSession);
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

TEST(RunRecord, SharesOfTimeByTierWeighStampsNotFrames) {
  RunRecord record;
  for (const double stamp_s : {0.0, 1.0, 3.0, 3.5, 7.5, 10.0}) record.count_camera_frame(at(stamp_s));
  record.add(held_by(PoseTier::kVision, 0.0));
  record.add(held_by(PoseTier::kVision, 1.0));    // 1 s
  record.add(held_by(PoseTier::kSurfaces, 3.0));  // 2 s
  record.add(held_by(PoseTier::kNone, 3.5));      // 0.5 s
  record.add(held_by(PoseTier::kOdometry, 7.5));  // 4 s
  record.add(held_by(PoseTier::kVision, 10.0));   // 2.5 s
  const RunMetrics metrics = metrics_of(record);
  EXPECT_NEAR(metrics.tier_vision_share.value(), 0.35, 1e-12);
  EXPECT_NEAR(metrics.tier_surfaces_share.value(), 0.2, 1e-12);
  EXPECT_NEAR(metrics.tier_odometry_share.value(), 0.4, 1e-12);
  EXPECT_NEAR(metrics.lost_share.value(), 0.05, 1e-12);
  EXPECT_NEAR(metrics.lost_time_s.value(), 0.5, 1e-12);
  EXPECT_EQ(metrics.duration_s, 10.0);
  EXPECT_EQ(metrics.frames_tracked, 4) << "odometry alone does not track";
}

TEST(RunRecord, OdometryAloneIsNotLost) {
  RunRecord record;
  for (int i = 0; i < 10; ++i) record.add(held_by(PoseTier::kOdometry, i));
  EXPECT_EQ(metrics_of(record).exit_reason, "completed");
  EXPECT_EQ(metrics_of(record).lost_share, 0.0);
  EXPECT_EQ(metrics_of(record).frames_tracked, 0);
}

TEST(RunRecord, TimeBeforeSlamsFirstAnswerAndAfterItsLastIsLost) {
  RunRecord record;
  for (const double stamp_s : {0.0, 2.0, 3.0, 8.0}) record.count_camera_frame(at(stamp_s));
  record.add(held_by(PoseTier::kVision, 2.0));
  record.add(held_by(PoseTier::kVision, 3.0));
  const RunMetrics metrics = metrics_of(record);
  EXPECT_NEAR(metrics.lost_share.value(), 7.0 / 8.0, 1e-12);
  EXPECT_NEAR(metrics.tier_vision_share.value(), 1.0 / 8.0, 1e-12);
  EXPECT_EQ(record.frames().front().time_s, 2.0) << "since the camera's first frame";
}

TEST(RunRecord, ARunThatNeverBeginsIsLostAllTheTime) {
  RunRecord silent, waiting;
  for (const double stamp_s : {1.0, 2.0, 4.0}) {
    silent.count_camera_frame(at(stamp_s));
    waiting.count_camera_frame(at(stamp_s));
    waiting.add(held_by(PoseTier::kNone, stamp_s));
  }
  for (const RunRecord* record : {&silent, &waiting}) {
    const RunMetrics metrics = metrics_of(*record);
    EXPECT_EQ(metrics.lost_share, 1.0);
    EXPECT_EQ(metrics.lost_time_s, 3.0);
    EXPECT_EQ(metrics.tier_vision_share, 0.0);
  }
}

TEST(RunRecord, AMomentHasNoShares) {
  RunRecord record;
  record.add(held_by(PoseTier::kVision, 1.0));
  EXPECT_FALSE(metrics_of(record).lost_share);
  EXPECT_EQ(metrics_of(record).lost_time_s, 0.0);
}

TEST(RunRecord, EveryFrameHasARowAndARepeatedOneHasNone) {
  RunRecord record;
  record.add({at(5.0), kSession, PoseTier::kVision, pose_at(0.0), pose_at(2.0), 0.01});
  record.add({at(5.5), kSession, PoseTier::kOdometry, pose_at(1.25), pose_at(3.0), 0.04});
  record.add({at(5.5), kSession, PoseTier::kVision, pose_at(1.0), pose_at(3.0), 0.02});
  record.add({at(6.0), kSession, PoseTier::kNone, std::nullopt, pose_at(3.5), 0.05});
  record.add({at(6.5), kSession + 1, PoseTier::kVision, pose_at(0.0), pose_at(3.5), 0.06});
  EXPECT_EQ(to_csv(record.frames()),
            "time_s,tier,path_length_m,position_sigma_m,position_error_m\n"
            "0.000000,vision,0.000000,0.010000,0.000000\n"
            "0.500000,odometry,1.000000,0.040000,0.250000\n"
            "1.000000,none,1.500000,,\n"
            "1.500000,none,1.500000,,\n");
}

// The clock of the stamps is set ----------------------------------------------------------------------------------

constexpr time::Duration kAnHour{3'600'000'000'000};
constexpr time::Duration kBackBy5s{-5'000'000'000};

time::Time tenth(int frame) { return {100'000'000'000 + frame * 100'000'000}; }

/// A drive at 10 Hz, in which every fifth frame becomes a key-frame, by a clock that is set by `step` before frame 10
/// and found to have been set by `found`.
RunRecord drive(time::Duration step, time::Duration found) {
  RunRecord record;
  for (int i = 0; i < 20; ++i) {
    const time::Time stamp = i < 10 ? tenth(i) : tenth(i) + step;
    record.count_camera_frame(stamp);
    if (i == 10) {
      record.follow_camera_clock(found);
      record.follow_clock(found, stamp);
    }
    FrameRecord frame{stamp, kSession, PoseTier::kVision, pose_at(0.11 * i), pose_at(0.1 * i), 0.01};
    if (i % 5 == 0) frame.keyframe_id = static_cast<std::uint64_t>(i / 5);
    record.add(frame);
  }
  return record;
}

RunMetrics metrics_of_drive(const RunRecord& record, const KeyframePoses& keyframes) {
  RunMetrics metrics;
  record.write_to(metrics, keyframes, 0, true);
  return metrics;
}

const KeyframePoses kKeyframes{{0, pose_at(0.0)}, {1, pose_at(0.52)}, {2, pose_at(1.04)}, {3, pose_at(1.56)}};

TEST(RunRecord, AClockThatIsSetChangesNoFigure) {
  const RunRecord expected = drive({}, {});
  const RunMetrics figures = metrics_of_drive(expected, kKeyframes);
  EXPECT_NEAR(figures.duration_s.value(), 1.9, 1e-9);
  EXPECT_NEAR(figures.path_length_m.value(), 1.9, 1e-9);
  EXPECT_NEAR(figures.keyframes.ate_raw_rmse_m.value(), 0.02 * std::sqrt((1.0 + 4.0 + 9.0) / 4.0), 1e-9);
  for (const time::Duration step : {kAnHour, -kAnHour, kBackBy5s}) {
    const RunRecord record = drive(step, step);
    EXPECT_EQ(to_csv(record.frames()), to_csv(expected.frames()));
    EXPECT_EQ(to_json(metrics_of_drive(record, kKeyframes)), to_json(figures));
  }
}

TEST(RunRecord, AClockWhoseStepIsKnownToTheJitterLosesNoFrame) {
  for (const time::Duration step : {kAnHour, kBackBy5s}) {
    for (const std::int64_t error_ns : {-300'000'000, 300'000'000}) {
      const RunRecord record = drive(step, {step.nanoseconds + error_ns});
      EXPECT_EQ(record.frames().size(), 20U);
      const RunMetrics metrics = metrics_of_drive(record, kKeyframes);
      EXPECT_NEAR(metrics.duration_s.value(), 1.9, 0.31);
      EXPECT_NEAR(metrics.path_length_m.value(), 1.9, 1e-9);
      EXPECT_EQ(metrics.exit_reason, "completed");
    }
  }
}

TEST(RunRecord, AClockThatIsSetBeforeSlamsFirstFrameIsNoTime) {
  RunRecord record;
  for (const int i : {0, 1}) record.count_camera_frame(tenth(i));
  for (const int i : {2, 3}) record.count_camera_frame(tenth(i) + kAnHour);
  record.follow_camera_clock(kAnHour);
  record.follow_clock(kAnHour, tenth(3) + kAnHour);  // frames wait that were not recorded yet
  record.add({tenth(3) + kAnHour, kSession, PoseTier::kVision, pose_at(0.0), pose_at(0.0), {}});
  EXPECT_NEAR(metrics_of(record).duration_s.value(), 0.3, 1e-9);
  EXPECT_NEAR(metrics_of(record).lost_time_s.value(), 0.3, 1e-9);
}

TEST(RunRecord, KeyframesWhoseFramesDidNotComeAreNotJudged) {
  KeyframePoses keyframes = kKeyframes;
  keyframes.emplace(4, pose_at(100.0));  // of an earlier run, or missed
  const RunRecord record = drive({}, {});
  EXPECT_EQ(to_json(metrics_of_drive(record, keyframes)), to_json(metrics_of_drive(record, kKeyframes)));
  EXPECT_FALSE(metrics_of_drive(record, {{4, pose_at(100.0)}}).keyframes.ate_raw_rmse_m);
}

TEST(RunRecord, ACollisionIsTheBeginningOfAContact) {
  RunRecord record;
  EXPECT_FALSE(metrics_of(record).collisions);
  for (const bool is_in_contact : {false, true, true, false, true}) record.count_contact(is_in_contact);
  EXPECT_EQ(metrics_of(record).collisions, 2);
}

}  // namespace
}  // namespace lapis::evaluator
