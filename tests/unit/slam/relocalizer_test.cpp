#include "slam/core/loops/relocalizer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "slam/core/frame/surface.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

// A map of one key-frame at the origin, and a camera that stood there at time 0.
class RelocalizerTest : public ::testing::Test {
 protected:
  RelocalizerTest() {
    map_.add_keyframe({});
    graph_.add_root();
    motion_.update(map_, stamp(0.0), {0, Pose::Identity(), geometry::Matrix6d::Zero()});
  }

  static time::Time stamp(double seconds) { return time::Time::from_seconds(100.0 + seconds); }

  // Found at x, and so sure of x.
  static TrackOutcome found(double x_m, double sigma_m = 0.01) {
    TrackOutcome outcome;
    outcome.is_tracked = true;
    outcome.alignment.T_reference_camera.translation().x() = x_m;
    outcome.alignment.information = geometry::Matrix6d::Identity() * 1e6;
    outcome.alignment.information(0, 0) = 1.0 / (sigma_m * sigma_m) / SlamConfig{}.pose_graph.information_share;
    return outcome;
  }
  Relocalizer::Verdict judge(double seconds, const TrackOutcome& outcome) {
    input_.stamp = stamp(seconds);
    return relocalizer_.judge({map_, graph_, motion_, places_, tracker_, frame_, 0, is_odometry_refuted_}, outcome);
  }
  bool believes(double seconds, const TrackOutcome& outcome) {
    return judge(seconds, outcome) == Relocalizer::Verdict::kBelieved;
  }
  int needed() const { return config_.relocalization.confirmations; }
  static SlamConfig features_alone() {
    SlamConfig config;
    config.surface.enabled = false;
    return config;
  }

  SlamConfig config_ = features_alone();
  RgbdFrame input_;
  Frame frame_{&input_, {}, {}, 0};
  Map map_;
  SlamGraph graph_;
  bool is_odometry_refuted_ = false;
  MotionModel motion_{config_, Pose::Identity()};
  LoopDetector places_{config_};
  Tracker tracker_{config_};
  Relocalizer relocalizer_{config_};
};

TEST_F(RelocalizerTest, WhereMotionLeadsAPoseIsBelieved) {
  EXPECT_TRUE(believes(0.1, found(0.2)));
  EXPECT_FALSE(believes(0.1, found(3.0)));
}

// Two poses soon after one another give a velocity; its first one is unknown.
TEST_F(RelocalizerTest, AKnownVelocityLeadsMoreNarrowly) {
  EXPECT_TRUE(believes(0.1, found(0.3)));
  motion_.update(map_, stamp(0.1), {0, Pose(Eigen::Translation3d(0.1, 0.0, 0.0)), geometry::Matrix6d::Zero()});
  EXPECT_TRUE(believes(0.2, found(0.2)));
  EXPECT_TRUE(believes(0.2, found(0.3)));
  EXPECT_FALSE(believes(0.2, found(0.4)));
}

TEST_F(RelocalizerTest, SoonAfterwardsACertainPlaceWithinReachIsBelievedAtOnce) {
  EXPECT_TRUE(believes(1.5, found(1.5)));
  EXPECT_FALSE(believes(1.5, found(1.5, 0.1))) << "uncertain by 10 cm";
}

// Until the camera can have been carried to a copy, 3 m away, the place nearest to the last pose is the right one.
TEST_F(RelocalizerTest, LaterACertainPlaceNearTheLastPoseHasToBeFoundAgain) {
  for (int i = 0; i < needed(); ++i) EXPECT_EQ(judge(2.5, found(1.4)), Relocalizer::Verdict::kAwaitsMore);
  EXPECT_TRUE(believes(2.5, found(1.4)));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(judge(2.5, found(1.6)), Relocalizer::Verdict::kNotHere);
}

TEST_F(RelocalizerTest, LongAfterTheLastPoseOnlyACameraThatHasNotMovedIsFound) {
  for (int i = 0; i < needed(); ++i) EXPECT_EQ(judge(60.0 + 0.1 * i, found(0.6)), Relocalizer::Verdict::kAwaitsMore);
  EXPECT_TRUE(believes(60.0 + 0.1 * needed(), found(0.6)));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(judge(61.0 + 0.1 * i, found(0.7)), Relocalizer::Verdict::kNotHere);
}

// As in a map that was resumed: nothing is known but the key-frame beside which the camera was.
TEST_F(RelocalizerTest, WithoutALastPoseTheCameraIsFoundBesideItsKeyframe) {
  motion_.forget();
  for (int i = 0; i < needed(); ++i) EXPECT_EQ(judge(0.1 * i, found(0.6)), Relocalizer::Verdict::kAwaitsMore);
  EXPECT_TRUE(believes(0.1 * needed(), found(0.6)));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(judge(1.0 + 0.1 * i, found(4.0)), Relocalizer::Verdict::kNotHere);
}

TEST_F(RelocalizerTest, WithoutSubMapsAPlaceAnywhereHasToBeFoundAgain) {
  config_.sub_map.after_frames = 0;
  relocalizer_ = Relocalizer(config_);
  for (int i = 0; i < needed(); ++i) EXPECT_FALSE(believes(5.0 + 0.1 * i, found(4.0)));
  EXPECT_TRUE(believes(5.0 + 0.1 * needed(), found(4.0)));
}

// Without odometry nothing else says that it is the place, and not one with the same poster.
TEST_F(RelocalizerTest, APlaceWhoseSurfacesDifferIsNeverBelieved) {
  config_.surface.enabled = true;
  const geometry::PinholeCamera camera = test::small_camera();
  const Pose corner = geometry::se3_exp((geometry::Vector6d() << 0.5, 0.4, 0.3, 0.3, 0.6, 0.0).finished());
  const RgbdFrame there = test::render_room(camera, corner, {});
  RgbdFrame elsewhere = there;
  for (float& z_m : elsewhere.depth.pixels) z_m *= 1.5F;
  Keyframe keyframe;
  keyframe.camera = camera;
  keyframe.surface = sample_surface(config_.surface, config_.noise, camera, there.depth);
  Map map;
  map.add_keyframe(std::move(keyframe));
  for (const bool is_there : {true, false}) {
    Relocalizer relocalizer(config_);
    bool is_believed = false;
    for (int i = 0; i < 10; ++i) {
      RgbdFrame input = is_there ? there : elsewhere;
      input.stamp = stamp(5.0 + 0.1 * i);
      const Frame frame{&input, {}, {}, 0};
      is_believed |= relocalizer.judge({map, graph_, motion_, places_, tracker_, frame}, found(0.0)) ==
                     Relocalizer::Verdict::kBelieved;
    }
    EXPECT_EQ(is_believed, is_there);
  }
}

TEST_F(RelocalizerTest, APlaceThatIsNotCertainIsNeverBelieved) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(believes(5.0 + 0.1 * i, found(4.0, 0.1)));
}

TEST_F(RelocalizerTest, OdometryThatLeadsElsewhereMakesAPlaceAwaitConfirmation) {
  for (int i = 0; i <= 20; ++i) ASSERT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose::Identity()));
  EXPECT_FALSE(believes(1.5, found(1.5)));
  EXPECT_TRUE(believes(1.6, found(0.1)));
}

// As when camera and wheels were cut off from slam for 10 s.
TEST_F(RelocalizerTest, OdometryThatBeganAnewContradictsNothing) {
  for (int i = 0; i <= 10; ++i) ASSERT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose::Identity()));
  for (int i = 110; i <= 140; ++i) ASSERT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose::Identity()));
  for (int i = 0; i < needed(); ++i) ASSERT_FALSE(believes(12.0 + 0.1 * i, found(0.3)));
  EXPECT_TRUE(believes(12.0 + 0.1 * needed(), found(0.3)));
}

// The robot drives 8 m in 8 s by odometry alone; vision finds it 5 m beside, again and again.
class ContradictedPlaceTest : public RelocalizerTest {
 protected:
  ContradictedPlaceTest() {
    for (int i = 0; i <= 80; ++i) {
      EXPECT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose(Eigen::Translation3d(0.1 * i, 0.0, 0.0))));
    }
  }
  // After so much of the path, with landmarks of its own or the same ones as ever.
  TrackOutcome beside(double path_m, bool is_own_view) const {
    TrackOutcome outcome = found(path_m);
    outcome.alignment.T_reference_camera.translation().y() = 5.0;
    const auto first = static_cast<LandmarkId>(is_own_view ? 100 * std::lround(10.0 * path_m) : 0);
    for (int i = 0; i < 90; ++i) outcome.inliers.push_back({i, first + static_cast<LandmarkId>(i)});
    return outcome;
  }
};

TEST_F(ContradictedPlaceTest, IsNotBelievedBeforeViewsAgreeAlongMetres) {
  for (int i = 10; i < 50; ++i) ASSERT_FALSE(believes(0.1 * i, beside(0.1 * i, true))) << 0.1 * i << " m";
  EXPECT_TRUE(believes(5.05, beside(5.05, true)));
  EXPECT_EQ(relocalizer_.doubted(), 1U) << "it is one place";
}

TEST_F(ContradictedPlaceTest, IsNeverBelievedForOneViewSeenAgain) {
  for (int i = 10; i < 80; ++i) ASSERT_FALSE(believes(0.1 * i, beside(0.1 * i, false)));
}

TEST_F(ContradictedPlaceTest, LosesAgainstOdometryThatIsConfirmed) {
  for (int i = 10; i < 45; ++i) ASSERT_FALSE(believes(0.1 * i, beside(0.1 * i, true)));
  EXPECT_TRUE(believes(4.5, found(4.5, 46))) << "where odometry leads";
  for (int i = 46; i < 80; ++i) ASSERT_FALSE(believes(0.1 * i, beside(0.1 * i, true))) << "evidence begins anew";
}

TEST_F(ContradictedPlaceTest, PlacesThatDoNotAgreeAreNoEvidence) {
  for (int i = 10; i < 80; ++i) {
    TrackOutcome outcome = beside(0.1 * i, true);
    outcome.alignment.T_reference_camera.translation().y() += i % 4;
    ASSERT_FALSE(believes(0.1 * i, outcome));
  }
}

TEST_F(ContradictedPlaceTest, WhatSlipExplainsOnlyHasToBeFoundAgain) {
  for (int i = 0; i < needed(); ++i) ASSERT_FALSE(believes(6.0 + 0.1 * i, found(4.9 + 0.1 * i)));
  EXPECT_TRUE(believes(6.0 + 0.1 * needed(), found(4.9 + 0.1 * needed())));
}

TEST_F(ContradictedPlaceTest, SlipDoesNotExplainTheNextRoom) {
  for (int i = 0; i < 5; ++i) ASSERT_FALSE(believes(7.0 + 0.1 * i, found(4.6 + 0.1 * i)));
}

// On the spot, all around; the camera does not see what it should.
TEST_F(RelocalizerTest, WhereOdometryIsRefutedATurnIsEvidenceEnough) {
  for (int i = 0; i <= 80; ++i) {
    ASSERT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose(Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d::UnitY()))));
  }
  for (const bool is_refuted : {false, true}) {
    is_odometry_refuted_ = is_refuted;
    int believed_at = 0;
    for (int i = 10; i < 80 && believed_at == 0; ++i) {
      TrackOutcome outcome = found(5.0);
      outcome.alignment.T_reference_camera.linear() =
          Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
      for (int k = 0; k < 90; ++k) outcome.inliers.push_back({k, static_cast<LandmarkId>(100 * (i / 10) + k)});
      if (believes(0.1 * i, outcome)) believed_at = i;
    }
    EXPECT_NEAR(believed_at, is_refuted ? 50 : 0, is_refuted ? 1 : 0) << "2 rad after 0.5 rad";
  }
}

TEST_F(RelocalizerTest, APoseThatIsUnsureOfItsPlaceIsNotUnsureOfItsDirection) {
  geometry::Matrix6d covariance = 1e-6 * geometry::Matrix6d::Identity();
  covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity();
  motion_.update(map_, stamp(0.0), {0, Pose::Identity(), covariance});
  for (int i = 0; i <= 20; ++i) ASSERT_TRUE(motion_.add_odometry(stamp(0.1 * i), Pose::Identity()));
  TrackOutcome turned = found(1.0);
  turned.alignment.T_reference_camera.linear() = Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_FALSE(believes(0.1, turned));
  EXPECT_TRUE(believes(0.2, found(1.0, 46)));
}

}  // namespace
}  // namespace lapis::slam
