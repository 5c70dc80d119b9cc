#include "slam/core/map/map.hpp"

#include <gtest/gtest.h>

#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/keyframe_rule.hpp"

namespace lapis::slam {
namespace {

Map three_keyframes() {
  Map map;
  for (int i = 0; i < 3; ++i) {
    Keyframe keyframe;
    keyframe.features = std::vector<Feature>(10);
    EXPECT_EQ(map.add_keyframe(keyframe), static_cast<KeyframeId>(i));
  }
  // Landmark k: key-frames 0 and 1 share four of them, 1 and 2 share two.
  for (int k = 0; k < 6; ++k) {
    const LandmarkId id = map.add_landmark(Eigen::Vector3d::Zero(), 1.0);
    EXPECT_TRUE(map.add_observation(id, {1, k}));
    EXPECT_TRUE(map.add_observation(id, {k < 4 ? KeyframeId{0} : KeyframeId{2}, k}));
  }
  return map;
}

TEST(Map, KnowsWhoSharesLandmarks) {
  const Map map = three_keyframes();
  EXPECT_EQ(map.covisible(1, 10), (std::vector<KeyframeId>{0, 2}));
  EXPECT_EQ(map.covisible(1, 1), (std::vector<KeyframeId>{0}));
  EXPECT_EQ(map.covisible(0, 10), (std::vector<KeyframeId>{1}));
  EXPECT_EQ(map.landmarks_of({0, 2}), (std::vector<LandmarkId>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(map.landmark_count(), 6U);
}

TEST(Map, AFeatureShowsOneLandmarkAndAKeyframeShowsALandmarkOnce) {
  Map map = three_keyframes();
  const LandmarkId fresh = map.add_landmark(Eigen::Vector3d::Zero(), 1.0);
  EXPECT_FALSE(map.add_observation(fresh, {0, 0}));  // the feature is taken
  EXPECT_FALSE(map.add_observation(0, {0, 9}));      // the landmark is shown already
  EXPECT_TRUE(map.add_observation(fresh, {0, 9}));
}

TEST(Map, ALandmarkDiesWithItsLastObservation) {
  Map map = three_keyframes();
  map.remove_observation(0, {0, 0});
  EXPECT_EQ(map.landmark_count(), 6U);
  EXPECT_EQ(map.keyframe(0).landmarks[0], kNoLandmark);
  map.remove_observation(0, {1, 0});
  map.remove_observation(0, {1, 0});  // unknown by now
  EXPECT_EQ(map.landmark_count(), 5U);
}

TEST(KeyframeRule, HasThreeReasonsAndASpacing) {
  const KeyframeConfig config;
  KeyframeEvidence quiet{config.min_frames, 100, 90, geometry::Pose::Identity()};
  EXPECT_FALSE(needs_keyframe(config, quiet));

  KeyframeEvidence few = quiet;
  few.tracked_landmarks = static_cast<int>(100 * config.min_tracked_share) - 1;
  EXPECT_TRUE(needs_keyframe(config, few));

  KeyframeEvidence moved = quiet;
  moved.T_reference_camera.translation().x() = config.max_translation_m + 0.01;
  EXPECT_TRUE(needs_keyframe(config, moved));

  KeyframeEvidence turned = quiet;
  turned.T_reference_camera.linear() = geometry::so3_exp({0.0, config.max_rotation_rad + 0.01, 0.0});
  EXPECT_TRUE(needs_keyframe(config, turned));

  turned.frames_since_keyframe = config.min_frames - 1;
  EXPECT_FALSE(needs_keyframe(config, turned));
}

class MotionModelTest : public ::testing::Test {
 protected:
  static geometry::Pose at(double t_s) {
    return geometry::se3_exp(t_s * (geometry::Vector6d() << 0.5, 0.0, 1.0, 0.0, 0.7, 0.1).finished());
  }
  static time::Time stamp(double t_s) { return time::Time::from_seconds(10.0 + t_s); }

  Map map_ = three_keyframes();
  MotionModel motion_{SlamConfig{}, geometry::Pose::Identity()};
};

TEST_F(MotionModelTest, ContinuesASteadyMotionOverUnevenStamps) {
  EXPECT_FALSE(motion_.predict(map_, stamp(0.0)));
  motion_.update(map_, stamp(0.0), {0, at(0.0)});
  motion_.update(map_, stamp(0.1), {0, at(0.1)});
  EXPECT_TRUE(motion_.predict(map_, stamp(0.25))->isApprox(at(0.25), 1e-9));
}

TEST_F(MotionModelTest, FollowsItsKeyframeAndForgets) {
  motion_.update(map_, stamp(0.0), {0, at(0.0)});
  motion_.update(map_, stamp(0.1), {0, at(0.1)});
  map_.set_pose(0, at(3.0));
  EXPECT_TRUE(motion_.predict(map_, stamp(0.2))->isApprox(at(3.0) * at(0.2), 1e-9));
  EXPECT_FALSE(motion_.predict(map_, stamp(0.7)));
  EXPECT_FALSE(motion_.predict(map_, stamp(0.05)));
}

}  // namespace
}  // namespace lapis::slam
