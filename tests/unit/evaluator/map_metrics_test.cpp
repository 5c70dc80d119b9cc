#include "evaluator/core/map/map_metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "evaluator/core/map/coverage.hpp"
#include "evaluator/core/map/iou.hpp"
#include "evaluator/core/map/nearest_voxel.hpp"
#include "evaluator/core/statistics.hpp"

namespace lapis::evaluator {
namespace {

LabelledVoxels random_map(std::size_t count, int edge, unsigned seed, double resolution_m = 0.25) {
  std::mt19937 engine(seed);
  std::uniform_int_distribution<int> coordinate(-edge, edge);
  std::vector<LabelledVoxel> voxels;
  while (voxels.size() < count) {
    const VoxelIndex index(coordinate(engine), coordinate(engine), coordinate(engine));
    const bool is_new = std::none_of(voxels.begin(), voxels.end(), [&](const auto& v) { return v.index == index; });
    if (is_new) voxels.push_back({index, static_cast<std::uint16_t>(engine() % 5)});
  }
  return make_labelled_voxels(resolution_m, voxels);
}

std::vector<double> brute_force_distances(const LabelledVoxels& from, const LabelledVoxels& to) {
  std::vector<double> distances;
  for (const LabelledVoxel& a : from.voxels) {
    double best = 1e300;
    for (const LabelledVoxel& b : to.voxels) {
      best = std::min(best, (a.index - b.index).cast<double>().norm() * from.resolution_m);
    }
    distances.push_back(best);
  }
  return distances;
}

double share_below(const std::vector<double>& distances, double limit) {
  const auto hits = std::count_if(distances.begin(), distances.end(), [=](double d) { return d <= limit + 1e-9; });
  return static_cast<double>(hits) / static_cast<double>(distances.size());
}

TEST(Voxels, AreSortedAndCheckedOnce) {
  const auto map = make_labelled_voxels(0.1, {{{1, 0, 0}, 2}, {{0, 5, 0}, 1}, {{0, 2, 9}, 3}});
  EXPECT_EQ(map.voxels[0].label, 3);
  EXPECT_EQ(map.voxels[2].label, 2);
  EXPECT_THROW(make_labelled_voxels(0.1, {{{1, 0, 0}, 2}, {{1, 0, 0}, 1}}), std::invalid_argument);
  EXPECT_THROW(make_labelled_voxels(0.0, {}), std::invalid_argument);
  EXPECT_THROW(make_labelled_voxels(0.1, {{{1 << 20, 0, 0}, 2}}), std::invalid_argument);
  EXPECT_THROW(make_known_space(map, {{0, 5, 0}}), std::invalid_argument);
  EXPECT_THROW(map_error(map, make_labelled_voxels(0.2, {})), std::invalid_argument);
}

TEST(NearestVoxelTest, AgreesWithBruteForceInEveryShape) {
  std::mt19937 engine(3);
  for (const int spread : {1, 3, 20, 1000, kMaxVoxelIndex}) {
    for (const std::size_t count : {1u, 7u, 9u, 64u, 500u}) {
      std::uniform_int_distribution<int> coordinate(-spread, spread);
      const auto draw = [&] { return VoxelIndex(coordinate(engine), coordinate(engine), coordinate(engine)); };
      std::vector<VoxelIndex> voxels;
      for (std::size_t i = 0; i < count; ++i) voxels.push_back(draw());
      const NearestVoxel nearest(voxels);
      for (int i = 0; i < 50; ++i) {
        const VoxelIndex query = draw();
        std::int64_t best = std::numeric_limits<std::int64_t>::max();
        for (const VoxelIndex& v : voxels) best = std::min(best, (v - query).cast<std::int64_t>().squaredNorm());
        ASSERT_EQ(nearest.squared_distance(query), best);
      }
    }
  }
  EXPECT_THROW(NearestVoxel({}), std::invalid_argument);
}

TEST(MapErrorTest, AgreesWithBruteForce) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto reference = random_map(300, 6, seed);
    const auto estimate = random_map(250, 7, seed + 100);
    const auto accuracy = brute_force_distances(estimate, reference);
    const auto completeness = brute_force_distances(reference, estimate);
    const MapError error = map_error(reference, estimate);
    EXPECT_NEAR(*error.accuracy_mean_m, error_statistics(accuracy)->mean, 1e-9);
    EXPECT_NEAR(*error.accuracy_p95_m, *quantile(accuracy, 0.95), 1e-9);
    EXPECT_NEAR(*error.completeness_mean_m, error_statistics(completeness)->mean, 1e-9);
    ASSERT_EQ(error.overlaps.size(), 3u);
    for (const Overlap& overlap : error.overlaps) {
      const double limit = overlap.tolerance_m;
      const double precision = share_below(accuracy, limit);
      const double recall = share_below(completeness, limit);
      EXPECT_NEAR(*overlap.precision, precision, 1e-12);
      EXPECT_NEAR(*overlap.recall, recall, 1e-12);
      EXPECT_NEAR(*overlap.f1, 2 * precision * recall / (precision + recall), 1e-12);
    }
  }
}

TEST(MapErrorTest, EqualMapsHaveNoError) {
  const auto map = random_map(100, 5, 1);
  const MapError error = map_error(map, map);
  EXPECT_EQ(*error.accuracy_mean_m, 0.0);
  EXPECT_EQ(*error.completeness_mean_m, 0.0);
  EXPECT_EQ(*error.overlaps[0].f1, 1.0);
}

TEST(MapErrorTest, ASheetMovedByOneVoxelIsOneVoxelOff) {
  std::vector<LabelledVoxel> sheet, moved;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      sheet.push_back({{x, y, 0}, 1});
      moved.push_back({{x, y, 1}, 1});
    }
  }
  const MapError error = map_error(make_labelled_voxels(0.25, sheet), make_labelled_voxels(0.25, moved));
  EXPECT_NEAR(*error.accuracy_mean_m, 0.25, 1e-12);
  EXPECT_EQ(*error.overlaps[0].f1, 0.0);
  EXPECT_EQ(*error.overlaps[1].f1, 1.0);
}

TEST(MapErrorTest, AnEmptyMapScoresNothing) {
  const auto map = random_map(50, 5, 1);
  const auto empty = make_labelled_voxels(0.25, {});
  const MapError error = map_error(map, empty);
  EXPECT_FALSE(error.accuracy_mean_m);
  EXPECT_FALSE(error.completeness_mean_m);
  EXPECT_FALSE(error.overlaps[1].precision);
  EXPECT_EQ(*error.overlaps[1].recall, 0.0);
  EXPECT_EQ(*error.overlaps[1].f1, 0.0);
  EXPECT_FALSE(map_error(empty, map).accuracy_mean_m);
  EXPECT_FALSE(map_error(empty, empty).overlaps[0].f1);
  EXPECT_EQ(*semantic_iou(map, empty).mean, 0.0);
  EXPECT_FALSE(semantic_iou(empty, map).mean);
  EXPECT_FALSE(semantic_iou(empty, empty).top_mean);
}

// Reference: class 1 at x = 0..3, class 2 at x = 4, 5, unlabelled at 6.
// Estimate: class 1 at 0, 1; class 2 at 2 and 4; class 3 at 6; unlabelled at 5; nothing at 3; class 1 at 10.
// At 0.1 m, voxels two and five steps away lie within 0.25 and 0.5 m.
TEST(MapErrorTest, TolerancesAreMetres) {
  const auto reference = make_labelled_voxels(0.1, {{{0, 0, 0}, 1}});
  const auto estimate = make_labelled_voxels(0.1, {{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{0, 5, 0}, 1}, {{0, 0, 6}, 1}});
  const MapError error = map_error(reference, estimate);
  const std::vector<double> precision = {*error.overlaps[0].precision, *error.overlaps[1].precision,
                                         *error.overlaps[2].precision};
  EXPECT_EQ(precision, (std::vector<double>{0.25, 0.5, 0.75}));
}

TEST(SemanticIouTest, HandExample) {
  const auto reference = make_labelled_voxels(
      0.25,
      {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 1}, {{3, 0, 0}, 1}, {{4, 0, 0}, 2}, {{5, 0, 0}, 2}, {{6, 0, 0}, 0}});
  const auto estimate = make_labelled_voxels(0.25, {{{0, 0, 0}, 1},
                                                    {{1, 0, 0}, 1},
                                                    {{2, 0, 0}, 2},
                                                    {{4, 0, 0}, 2},
                                                    {{6, 0, 0}, 3},
                                                    {{5, 0, 0}, 0},
                                                    {{10, 0, 0}, 1}});
  const SemanticIou result = semantic_iou(reference, estimate);
  ASSERT_EQ(result.classes.size(), 3u);
  EXPECT_EQ(result.classes[0].label, 1);
  EXPECT_EQ(result.classes[0].reference_voxels, 4u);
  EXPECT_EQ(result.classes[0].estimate_voxels, 3u);
  EXPECT_EQ(result.classes[0].common_voxels, 2u);
  EXPECT_NEAR(result.classes[0].iou, 2.0 / 5.0, 1e-12);
  // With one step allowed: estimate's 0 and 1 count, 10 does not; of the reference only 3 is missed.
  EXPECT_NEAR(result.classes[0].tolerant_iou, 2.0 / (3.0 + 1.0), 1e-12);
  EXPECT_EQ(result.classes[1].label, 2);
  EXPECT_NEAR(result.classes[1].iou, 1.0 / 3.0, 1e-12);
  EXPECT_EQ(result.classes[2].label, 3);
  EXPECT_EQ(result.classes[2].iou, 0.0);
  EXPECT_FALSE(result.classes[2].is_top);
  EXPECT_NEAR(*result.top_mean, (2.0 / 5.0 + 1.0 / 3.0) / 2.0, 1e-12);
  EXPECT_NEAR(*result.mean, (2.0 / 5.0 + 1.0 / 3.0) / 3.0, 1e-12);
}

TEST(SemanticIouTest, TopClassesAreTheEightMostFrequentOrTheSceneList) {
  std::vector<LabelledVoxel> voxels;
  for (int label = 0; label <= 10; ++label) {
    for (int i = 0; i < 3 + label / 2; ++i) voxels.push_back({{label, i, 0}, static_cast<std::uint16_t>(label)});
  }
  const auto map = make_labelled_voxels(0.25, voxels);
  const SemanticIou result = semantic_iou(map, map);
  std::vector<int> top;
  for (const ClassIou& c : result.classes) {
    if (c.is_top) top.push_back(c.label);
  }
  EXPECT_EQ(top, (std::vector<int>{10, 8, 9, 6, 7, 4, 5, 2}));
  EXPECT_EQ(*result.top_mean, 1.0);
  EXPECT_EQ(result.classes.size(), 10u);
  const SemanticIou listed = semantic_iou(map, map, {1, 3});
  EXPECT_EQ(std::count_if(listed.classes.begin(), listed.classes.end(), [](const auto& c) { return c.is_top; }), 2);
}

// Reference: wall at 0 and 1, door at 2, free at 3. Estimate: wall at 0, free at 1, unknown at 2, wall at 3 and 4.
TEST(SemanticIouTest, OnlyWhatBothHaveObservedIsCommon) {
  const auto reference = make_known_space(make_labelled_voxels(0.25, {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 2}}),
                                          {VoxelIndex(3, 0, 0)});
  const auto estimate = make_known_space(make_labelled_voxels(0.25, {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}, {{4, 0, 0}, 1}}),
                                         {VoxelIndex(1, 0, 0)});
  const CommonSpace common = restrict_to_common(reference, estimate);
  EXPECT_NEAR(*common.share, 3.0 / 5.0, 1e-12);  // 0, 1, 3 of 0 to 4
  EXPECT_EQ(common.reference.voxels.size(), 2u);
  EXPECT_EQ(common.estimate.voxels.size(), 2u);
  const SemanticIou all = semantic_iou(reference.occupied, estimate.occupied);
  EXPECT_EQ(top_classes(all), (std::vector<std::uint16_t>{1, 2}));
  EXPECT_NEAR(all.classes[0].iou, 1.0 / 4.0, 1e-12);
  const SemanticIou observed = semantic_iou(common.reference, common.estimate, top_classes(all));
  ASSERT_EQ(observed.classes.size(), 1u);
  EXPECT_NEAR(observed.classes[0].iou, 1.0 / 3.0, 1e-12);
  EXPECT_FALSE(restrict_to_common({{0.25, {}}, {}}, {{0.25, {}}, {}}).share);
  EXPECT_THROW(restrict_to_common(reference, {{0.1, {}}, {}}), std::invalid_argument);
}

TEST(SemanticIouTest, IsSymmetricAndToleranceOnlyHelps) {
  const auto a = random_map(400, 5, 21);
  const auto b = random_map(400, 5, 22);
  const SemanticIou forward = semantic_iou(a, b);
  const SemanticIou backward = semantic_iou(b, a);
  for (const ClassIou& c : forward.classes) {
    const auto other = std::find_if(backward.classes.begin(), backward.classes.end(),
                                    [&](const ClassIou& d) { return d.label == c.label; });
    ASSERT_NE(other, backward.classes.end());
    EXPECT_EQ(c.iou, other->iou);
    EXPECT_GE(c.tolerant_iou, c.iou);
  }
}

TEST(CoverageTest, CountsKnownVolumeAndShare) {
  const auto occupied = make_labelled_voxels(0.5, {{{0, 0, 0}, 1}, {{9, 0, 0}, 1}});
  const KnownSpace map = make_known_space(occupied, {{1, 0, 0}, {2, 0, 0}});
  const Coverage alone = coverage(map);
  EXPECT_NEAR(alone.explored_volume_m3, 4 * 0.125, 1e-12);
  EXPECT_NEAR(alone.free_volume_m3, 0.25, 1e-12);
  EXPECT_NEAR(alone.occupied_volume_m3, 0.25, 1e-12);
  EXPECT_FALSE(alone.explored_share);
  const KnownSpace reference =
      make_known_space(make_labelled_voxels(0.5, {{{1, 0, 0}, 1}}), {{0, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  EXPECT_NEAR(*coverage(reference, map).explored_share, 0.75, 1e-12);
  EXPECT_NEAR(*coverage(reference, reference).explored_share, 1.0, 1e-12);
  EXPECT_FALSE(coverage(make_known_space(make_labelled_voxels(0.5, {}), {}), map).explored_share);
}

TEST(CoverageTest, HistoryGivesTheShareOfEveryMap) {
  const KnownSpace reference = make_known_space(random_map(200, 4, 1), {});
  KnownHistory history;
  std::vector<double> expected;
  for (const std::size_t count : {0U, 50U, 300U, 20U, 600U}) {  // what is known may become unknown again
    const KnownSpace map = make_known_space(random_map(count, 4, 7), {});
    history.add(map);
    expected.push_back(coverage(reference, map).explored_share.value());
  }
  EXPECT_EQ(history.shares(reference), expected);
  EXPECT_GT(expected.back(), 0.5);
  EXPECT_TRUE(history.shares(make_known_space(make_labelled_voxels(0.25, {}), {})).empty());
}

}  // namespace
}  // namespace lapis::evaluator
