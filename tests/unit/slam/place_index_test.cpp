#include "slam/core/loops/place_index.hpp"

#include <random>

#include <gtest/gtest.h>

namespace lapis::slam {
namespace {

bool any(KeyframeId /*id*/) { return true; }

class PlaceIndexTest : public ::testing::Test {
 protected:
  std::vector<Feature> random_place(std::size_t count = 200) {
    std::vector<Feature> features(count);
    for (Feature& feature : features) {
      feature.depth_m = 2.0;
      for (auto& word : feature.descriptor) word = engine_();
    }
    return features;
  }
  // The same place from elsewhere: a share of the features is gone, the others have `flips` bits of 256 changed.
  std::vector<Feature> seen_again(const std::vector<Feature>& features, double kept, int flips) {
    std::vector<Feature> again = random_place(features.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(kept * static_cast<double>(features.size())); ++i) {
      again[i] = features[i];
      for (int k = 0; k < flips; ++k) {
        const auto bit = engine_() % 256;
        again[i].descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
      }
    }
    return again;
  }
  std::mt19937_64 engine_{5};
  PlaceIndex index_;
};

TEST_F(PlaceIndexTest, FindsAPlaceOfWhichAThirdIsLeftAndBitsHaveChanged) {
  std::vector<std::vector<Feature>> places;
  for (KeyframeId id = 0; id < 300; ++id) {
    places.push_back(random_place());
    index_.add(id, places.back());
  }
  EXPECT_EQ(index_.size(), 300U);
  int found = 0;
  for (KeyframeId id = 0; id < 300; id += 3) {
    const auto candidates = index_.query(seen_again(places[id], 0.33, 30), 3, any);
    ASSERT_LE(candidates.size(), 3U);
    if (!candidates.empty() && candidates[0].keyframe == id) ++found;
  }
  EXPECT_GE(found, 98);
}

TEST_F(PlaceIndexTest, KeepsToWantedKeyframesAndNamesOnlyTheBestOfNeighbours) {
  const auto place = random_place();
  for (KeyframeId id = 0; id < 20; ++id) index_.add(id, id % 10 < 3 ? seen_again(place, 0.5, 10) : random_place());
  const auto candidates = index_.query(place, 5, [](KeyframeId id) { return id < 12; });
  ASSERT_GE(candidates.size(), 2U);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_LT(candidates[i].keyframe, 12U);
    EXPECT_LE(candidates[i].score, candidates[i > 0 ? i - 1 : 0].score);
    for (std::size_t j = 0; j < i; ++j) {
      const auto a = static_cast<int>(candidates[i].keyframe), b = static_cast<int>(candidates[j].keyframe);
      EXPECT_GT(std::abs(a - b), 2);
    }
  }
  EXPECT_LT(candidates[0].keyframe, 3U);
  EXPECT_GE(candidates[1].keyframe, 10U);
}

TEST_F(PlaceIndexTest, FeaturesWithoutDepthShowNoLandmark) {
  auto place = random_place();
  for (Feature& feature : place) feature.depth_m = 0.0;
  index_.add(0, place);
  EXPECT_TRUE(index_.query(place, 3, any).empty());
}

TEST_F(PlaceIndexTest, AnEmptyIndexKnowsNothing) { EXPECT_TRUE(index_.query(random_place(), 3, any).empty()); }

}  // namespace
}  // namespace lapis::slam
