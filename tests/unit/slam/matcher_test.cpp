#include "slam/core/tracking/matcher.hpp"

#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

class MatcherTest : public ::testing::Test {
 protected:
  // A map with the landmarks of the room's first view, and a later view.
  MatcherTest() {
    const Frame first = make_frame(first_input_, extractor_, config_.noise);
    Keyframe keyframe;
    keyframe.camera = camera_;
    keyframe.T_map_camera = test::room_path(0);
    keyframe.features = first.features;
    map_.add_keyframe(keyframe);
    for (std::size_t i = 0; i < first.features.size(); ++i) {
      const Feature& feature = first.features[i];
      if (feature.depth_m <= 0.0) continue;
      const Eigen::Vector3d p = camera_.unproject(feature.pixel.x(), feature.pixel.y(), feature.depth_m);
      const LandmarkId id =
          map_.add_landmark(test::room_path(0) * p, finest_distance(config_.features, p.norm(), feature.octave));
      map_.add_observation(id, {0, static_cast<int>(i)});
      all_.push_back(id);
    }
  }

  // Share of matches whose landmark really lies at the feature.
  double precision(const std::vector<Match>& matches, const Frame& frame, const geometry::Pose& T_map_camera) const {
    int right = 0;
    for (const Match& match : matches) {
      const Eigen::Vector2d expected = camera_.project(T_map_camera.inverse() * map_.landmark(match.landmark).p_map);
      if ((expected - frame.features[static_cast<std::size_t>(match.feature)].pixel).norm() < 4.0) ++right;
    }
    return matches.empty() ? 0.0 : right / static_cast<double>(matches.size());
  }

  SlamConfig config_;
  geometry::PinholeCamera camera_ = test::small_camera();
  FeatureExtractor extractor_{config_.features};
  RgbdFrame first_input_ = test::render_room(camera_, test::room_path(0), {});
  RgbdFrame later_input_ = test::render_room(camera_, test::room_path(3), {});
  Map map_;
  std::vector<LandmarkId> all_;
};

TEST_F(MatcherTest, ProjectionFindsTheLandmarks) {
  const Frame later = make_frame(later_input_, extractor_, config_.noise);
  const auto matches = match_by_projection(config_, map_, all_, later, test::room_path(3), 6.0);
  EXPECT_GT(matches.size(), 100U);
  EXPECT_GT(precision(matches, later, test::room_path(3)), 0.9);
}

TEST_F(MatcherTest, ProjectionUsesEachFeatureAndLandmarkOnce) {
  const Frame later = make_frame(later_input_, extractor_, config_.noise);
  const auto matches = match_by_projection(config_, map_, all_, later, test::room_path(3), 30.0);
  std::vector<bool> feature_used(later.features.size(), false);
  std::vector<bool> landmark_used(all_.size(), false);
  for (const Match& match : matches) {
    EXPECT_FALSE(feature_used[static_cast<std::size_t>(match.feature)]);
    EXPECT_FALSE(landmark_used[match.landmark]);
    feature_used[static_cast<std::size_t>(match.feature)] = landmark_used[match.landmark] = true;
  }
}

TEST_F(MatcherTest, BruteForceNeedsNoPose) {
  const Frame later = make_frame(later_input_, extractor_, config_.noise);
  const auto matches = match_brute_force(config_.matcher, map_.keyframe(0), later);
  EXPECT_GT(matches.size(), 60U);
  EXPECT_GT(precision(matches, later, test::room_path(3)), 0.8);
}

TEST_F(MatcherTest, NothingMatchesAnEmptyFrame) {
  const RgbdFrame black{{}, camera_, geometry::GrayImage(320, 240), geometry::DepthImage(320, 240, 2.0F)};
  const Frame frame = make_frame(black, extractor_, config_.noise);
  EXPECT_TRUE(match_by_projection(config_, map_, all_, frame, test::room_path(0), 20.0).empty());
  EXPECT_TRUE(match_brute_force(config_.matcher, map_.keyframe(0), frame).empty());
}

TEST(HammingDistance, CountsDifferingBits) {
  std::mt19937_64 random(9);
  for (int trial = 0; trial < 20; ++trial) {
    Descriptor a, b;
    int expected = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      a[i] = random();
      b[i] = random();
      for (int bit = 0; bit < 64; ++bit) expected += ((a[i] >> bit) & 1U) != ((b[i] >> bit) & 1U) ? 1 : 0;
    }
    EXPECT_EQ(hamming_distance(a, b), expected);
    EXPECT_EQ(hamming_distance(a, a), 0);
  }
}

}  // namespace
}  // namespace lapis::slam
