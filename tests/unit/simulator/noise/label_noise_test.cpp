#include "simulator/core/noise/label_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "statistics.hpp"

namespace lapis::simulator {
namespace {

using geometry::DepthImage;
using geometry::LabelImage;
using geometry::Pose;
using Instances = geometry::Image<std::uint16_t>;

enum Id : std::uint16_t {
  kWall = 1,
  kFloor,
  kChair,
  kSofa,
  kTable,
  kObjects,
  kMirror,
  kPlant,
  kUnlabeled,
  kRobot,
  kLift
};

const mapping::LabelList& list() {
  static const auto labels = mapping::LabelList::from_names({{kWall, "wall"},
                                                             {kFloor, "floor"},
                                                             {kChair, "chair"},
                                                             {kSofa, "sofa"},
                                                             {kTable, "table"},
                                                             {kObjects, "objects"},
                                                             {kMirror, "mirror"},
                                                             {kPlant, "plant"},
                                                             {kUnlabeled, "unlabeled"},
                                                             {kRobot, "robot"},
                                                             {kLift, "lift"}});
  return labels;
}

constexpr int kTile = 16, kAcross = 20, kDown = 15, kTiles = kAcross * kDown;

/// A picture of 300 square instances of one class and range.
struct Picture {
  LabelImage labels;
  Instances instances;
  DepthImage depth;
};

Picture tiles(std::uint16_t class_id, double range_m) {
  const int width = kTile * kAcross, height = kTile * kDown;
  Picture picture{{width, height, class_id}, {width, height}, {width, height, static_cast<float>(range_m)}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      picture.instances(column, row) = static_cast<std::uint16_t>(1 + column / kTile + kAcross * (row / kTile));
  return picture;
}

/// Camera optical frame that looks horizontally.
Pose looking(double x, double y, double yaw_rad) {
  Pose T = Pose::Identity();
  T.linear().col(2) = Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  T.linear().col(1) = -Eigen::Vector3d::UnitZ();
  T.linear().col(0) = T.linear().col(1).cross(T.linear().col(2));
  T.translation() = Eigen::Vector3d(x, y, 1.0);
  return T;
}
const Pose kHere = looking(3.5, -2.5, 0.3);

LabelNoiseConfig still() {  // neither flips nor moving boundaries
  LabelNoiseConfig config;
  config.flip = config.warp_px = 0.0;
  return config;
}

/// Class that each of the instances is taken for.
std::vector<std::uint16_t> recognised(const LabelNoise& noise, const Picture& picture,
                                      const Pose& T_world_camera = kHere, std::uint64_t tick = 1) {
  const LabelImage out = noise.apply(picture.labels, picture.instances, picture.depth, T_world_camera, tick);
  std::vector<std::uint16_t> classes;
  for (int row = kTile / 2; row < out.height; row += kTile)
    for (int column = kTile / 2; column < out.width; column += kTile) classes.push_back(out(column, row));
  return classes;
}

double share_of_difference(const std::vector<std::uint16_t>& a, const std::vector<std::uint16_t>& b) {
  double count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
  return count / static_cast<double>(a.size());
}

TEST(LabelNoise, NoneIsTheIdentity) {
  LabelNoiseConfig config;
  config.model = LabelModel::kNone;
  const Picture picture = tiles(kChair, 5.0);
  const auto out = LabelNoise(config, list(), 3).apply(picture.labels, picture.instances, picture.depth, kHere, 1);
  EXPECT_EQ(out.pixels, picture.labels.pixels);
}

TEST(LabelNoise, AccuracyFollowsClassRangeAndSize) {
  const LabelNoise noise({}, list(), 3);
  EXPECT_NEAR(noise.accuracy(kChair, 1.0, 1000), 0.75, 1e-12);
  EXPECT_NEAR(noise.accuracy(kChair, 3.5, 1000), 0.75 - 0.05 * 2, 1e-12);
  EXPECT_NEAR(noise.accuracy(kChair, 1.0, 159), 0.50, 1e-12);
  EXPECT_NEAR(noise.accuracy(kWall, 1.0, 1000), 0.85, 1e-12);
  EXPECT_NEAR(noise.accuracy(kMirror, 1.5, 160), 0.55, 1e-12);
  EXPECT_NEAR(noise.accuracy(kRobot, 1.0, 1000), 0.75, 1e-12);
  EXPECT_GT(noise.accuracy(kMirror, 100.0, 1), 0.0);
  EXPECT_EQ(noise.accuracy(kUnlabeled, 5.0, 1000), 1.0);
  EXPECT_EQ(noise.accuracy(77, 5.0, 1000), 1.0);
  EXPECT_EQ(noise.accuracy(0, 5.0, 1000), 1.0);
}

TEST(LabelNoise, ConfusionPrefersTheSameKind) {
  const LabelNoise noise({}, list(), 3);
  for (const mapping::Label& truth : list().labels()) {
    double sum = 0.0;
    for (const mapping::Label& other : list().labels()) sum += noise.confusion(truth.id, other.id);
    EXPECT_NEAR(sum, truth.id == kUnlabeled ? 0.0 : 1.0, 1e-12) << truth.name;
    EXPECT_EQ(noise.confusion(truth.id, truth.id), 0.0);
    EXPECT_EQ(noise.confusion(truth.id, kUnlabeled), 0.0);
  }
  EXPECT_NEAR(noise.confusion(kChair, kSofa) / noise.confusion(kChair, kTable), 4.15 / 0.15, 1e-9);
  EXPECT_NEAR(noise.confusion(kChair, kWall) / noise.confusion(kChair, kTable), 2.0 / 0.15, 1e-9);
  EXPECT_NEAR(noise.confusion(kTable, kWall) / noise.confusion(kTable, kPlant), 6.0 / 0.15, 1e-9);
  for (const std::uint16_t other : {kWall, kChair, kObjects, kLift})  // all but itself and "unlabeled"
    EXPECT_NEAR(noise.confusion(kRobot, other), 1.0 / 9, 1e-12);
}

TEST(LabelNoise, InstancesAreRightAsOftenAsTheirAccuracySays) {
  const LabelNoise noise(still(), list(), 3);
  constexpr int kCells = 60;
  constexpr std::size_t n = std::size_t{kCells} * kTiles;
  for (const std::uint16_t class_id : {kWall, kChair, kMirror, kRobot}) {
    for (const double range_m : {1.0, 4.0}) {
      const Picture picture = tiles(class_id, range_m);
      std::map<std::uint16_t, double> shares;
      for (int cell = 0; cell < kCells; ++cell)
        for (const std::uint16_t taken : recognised(noise, picture, looking(cell + 0.5, 0.5, 0.1)))
          shares[taken] += 1.0 / static_cast<double>(n);
      const double right = noise.accuracy(class_id, range_m, kTile * kTile);
      EXPECT_NEAR(shares[class_id], right, share_bound(right, n)) << class_id << " at " << range_m;
      for (const mapping::Label& other : list().labels()) {
        const double wrong = (1 - right) * noise.confusion(class_id, other.id);
        if (other.id == class_id) continue;
        EXPECT_NEAR(shares[other.id], wrong, share_bound(wrong, n)) << other.name;
      }
    }
  }
}

TEST(LabelNoise, SmallInstancesAreTakenForOthersMoreOften) {
  LabelNoiseConfig config = still();
  config.accuracy = 1.0;
  config.small_px = kTile * kTile + 1;
  const auto classes = recognised(LabelNoise(config, list(), 3), tiles(kChair, 1.0));
  EXPECT_NEAR(static_cast<double>(std::count(classes.begin(), classes.end(), kChair)) / kTiles, 0.75,
              share_bound(0.75, kTiles));
  config.small_px = kTile * kTile;
  EXPECT_THAT(recognised(LabelNoise(config, list(), 3), tiles(kChair, 1.0)), testing::Each(kChair));
}

TEST(LabelNoise, RangeIsTheMeanDepthOfWhatWasMeasured) {
  LabelNoiseConfig config = still();
  config.accuracy = 1.0;
  config.range_loss_per_m = 0.3;
  Picture picture = tiles(kChair, 3.5);
  for (std::size_t i = 0; i < picture.depth.pixels.size(); i += 2) picture.depth.pixels[i] = 0.0F;
  for (std::size_t i = 1; i < picture.depth.pixels.size(); i += 4) picture.depth.pixels[i] = 2.5F;  // half of the rest
  const auto mixed = recognised(LabelNoise(config, list(), 3), picture);
  EXPECT_EQ(mixed, recognised(LabelNoise(config, list(), 3), tiles(kChair, 3.0)));
  EXPECT_NE(mixed, recognised(LabelNoise(config, list(), 3), tiles(kChair, 2.5)));
}

TEST(LabelNoise, ConfusionPersistsInACell) {
  const LabelNoise noise(still(), list(), 3);
  const Picture picture = tiles(kChair, 2.0);
  const auto here = recognised(noise, picture, looking(3.1, -2.9, 0.1), 1);
  EXPECT_GT(share_of_difference(here, std::vector<std::uint16_t>(kTiles, kChair)), 0.1);
  for (std::uint64_t tick = 2; tick < 20; ++tick) {
    const double part = 0.04 * static_cast<double>(tick);
    ASSERT_EQ(recognised(noise, picture, looking(3.1 + part, -2.9 + part, 0.02 + 0.9 * part), tick), here) << tick;
  }
  const double independent = 0.3;  // at least so many differ when drawn anew
  for (const Pose& elsewhere : {looking(4.1, -2.9, 0.1), looking(3.1, -1.9, 0.1), looking(3.1, -3.9, 0.1),
                                looking(3.1, -2.9, -0.1), looking(3.1, -2.9, 0.9), looking(3.1, -2.9, 3.0)}) {
    EXPECT_GT(share_of_difference(recognised(noise, picture, elsewhere), here), independent);
  }
  EXPECT_GT(share_of_difference(recognised(LabelNoise(still(), list(), 4), picture), recognised(noise, picture)),
            independent);
}

TEST(LabelNoise, ApproachInACellOnlyCorrects) {
  const LabelNoise noise(still(), list(), 3);
  const auto far = recognised(noise, tiles(kChair, 4.5)), near = recognised(noise, tiles(kChair, 2.0));
  int corrected = 0;
  for (std::size_t i = 0; i < far.size(); ++i) {
    if (far[i] == near[i]) continue;
    ++corrected;
    EXPECT_EQ(near[i], kChair);
  }
  EXPECT_NEAR(corrected / static_cast<double>(kTiles), 0.05 * 2.5, share_bound(0.125, kTiles));
}

TEST(LabelNoise, FlipsAreOfOneFrame) {
  LabelNoiseConfig config = still();
  config.accuracy = 1.0;
  config.flip = 0.1;
  const LabelNoise noise(config, list(), 3);
  const Picture picture = tiles(kChair, 1.0);
  constexpr int kFrames = 100;
  std::vector<double> now, before;
  std::vector<std::uint16_t> last;
  for (std::uint64_t tick = 0; tick < kFrames; ++tick) {
    const auto classes = recognised(noise, picture, kHere, tick);
    for (std::size_t i = 0; i < last.size(); ++i) {
      before.push_back(last[i] != kChair ? 1 : 0);
      now.push_back(classes[i] != kChair ? 1 : 0);
    }
    last = classes;
  }
  EXPECT_NEAR(mean_of(now), 0.1, share_bound(0.1, now.size()));
  EXPECT_LT(std::abs(correlation_of(now, before)), kSigmas / std::sqrt(static_cast<double>(now.size())));
}

/// Two instances side by side.
Picture halves(int width, int height, int boundary) {
  Picture picture{{width, height, kWall}, {width, height, 1}, {width, height, 1.0F}};
  for (int row = 0; row < height; ++row) {
    for (int column = boundary; column < width; ++column) {
      picture.labels(column, row) = kChair;
      picture.instances(column, row) = 2;
    }
  }
  return picture;
}

LabelNoiseConfig wobble_only(double warp_px) {
  LabelNoiseConfig config;
  config.accuracy = 1.0;
  config.flip = 0.0;
  config.warp_px = warp_px;
  return config;
}

TEST(LabelNoise, BoundariesAreDisplacedBySigmaEverywhere) {
  constexpr int kWidth = 229, kHeight = 100, kFrames = 600;
  for (const double sigma : {2.0, 4.0}) {
    const LabelNoise noise(wobble_only(sigma), list(), 3);
    for (const int boundary : {96, 102, 108}) {  // nodes are 12 px apart, at 96 and 108
      const Picture picture = halves(kWidth, kHeight, boundary);
      std::map<int, double> right_of;  // by column: share that shows what is right of the boundary
      for (std::uint64_t tick = 0; tick < kFrames; ++tick) {
        const LabelImage out = noise.apply(picture.labels, picture.instances, picture.depth, kHere, tick);
        for (int d = -6; d < 6; ++d)
          right_of[d] += out(boundary + d, 45 + 5 * static_cast<int>(tick % 2)) == kChair ? 1.0 / kFrames : 0;
      }
      for (const auto& [d, share] : right_of) {
        const double expected = normal_cdf((d + 0.5) / sigma);  // moved by more than half a pixel short of it
        EXPECT_NEAR(share, expected, share_bound(expected, kFrames)) << sigma << " px, " << boundary << " + " << d;
      }
    }
  }
}

TEST(LabelNoise, BoundariesStayWholeAndWobbleFromFrameToFrame) {
  const Picture picture = halves(229, 100, 110);
  const LabelNoise noise(wobble_only(4.0), list(), 3);
  int rows_cut_once = 0;
  std::vector<LabelImage> frames;
  for (std::uint64_t tick = 0; tick < 20; ++tick) {
    frames.push_back(noise.apply(picture.labels, picture.instances, picture.depth, kHere, tick));
    for (int row = 0; row < 100; ++row) {
      int changes = 0;
      for (int column = 1; column < 229; ++column)
        changes += frames.back()(column, row) != frames.back()(column - 1, row) ? 1 : 0;
      rows_cut_once += changes == 1 ? 1 : 0;
    }
  }
  EXPECT_GT(rows_cut_once, 1800);  // of 2000; folds are rare
  EXPECT_NE(frames[0].pixels, frames[1].pixels);
}

TEST(LabelNoise, StreamsDoNotShiftEachOther) {
  const Picture picture = tiles(kChair, 2.0);
  LabelNoiseConfig config;
  config.flip = 0.0;
  config.warp_px = 0.5;  // does not reach the tiles' centres
  EXPECT_EQ(recognised(LabelNoise(config, list(), 3), picture), recognised(LabelNoise(still(), list(), 3), picture));
}

TEST(LabelNoise, DependsOnSeedTickAndViewAlone) {
  const Picture picture = tiles(kChair, 2.0);
  const LabelNoise noise({}, list(), 3);
  const auto apply = [&](std::uint64_t tick) {
    return noise.apply(picture.labels, picture.instances, picture.depth, kHere, tick).pixels;
  };
  const auto first = apply(5);
  EXPECT_NE(apply(6), first);
  EXPECT_EQ(apply(5), first);
}

TEST(LabelNoise, WhatIsNothingStaysNothing) {
  Picture picture = tiles(kChair, 2.0);
  for (int row = 0; row < picture.labels.height; ++row)
    for (int column = 100; column < 140; ++column) picture.instances(column, row) = picture.labels(column, row) = 0;
  const auto out = LabelNoise({}, list(), 3).apply(picture.labels, picture.instances, picture.depth, kHere, 1);
  for (int row = 0; row < out.height; ++row)
    for (int column = 100; column < 140; ++column) ASSERT_EQ(out(column, row), 0);
  EXPECT_THAT(out.pixels, testing::Each(testing::AnyOf(0, testing::Not(kUnlabeled))));
}

TEST(LabelNoise, LeavesClassesThatNobodyKnows) {
  const Picture unlisted = tiles(77, 2.0);
  EXPECT_THAT(recognised(LabelNoise({}, list(), 3), unlisted), testing::Each(77));
  EXPECT_THAT(recognised(LabelNoise({}, {}, 3), unlisted), testing::Each(77));
  const auto alone = mapping::LabelList::from_names({{kChair, "chair"}});
  EXPECT_THAT(recognised(LabelNoise({}, alone, 3), tiles(kChair, 2.0)), testing::Each(kChair));
}

TEST(LabelNoise, SurvivesBadData) {
  const LabelNoise noise({}, list(), 3);
  Picture picture = tiles(kChair, std::numeric_limits<double>::quiet_NaN());
  Pose lost = Pose::Identity();
  lost.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  picture.instances.pixels.back() = 65535;
  EXPECT_THAT(recognised(noise, picture, lost), testing::Each(testing::Gt(0)));
  EXPECT_TRUE(noise.apply({}, {}, {}, kHere, 1).empty());
  EXPECT_THROW(noise.apply(picture.labels, Instances(3, 3), picture.depth, kHere, 1), std::invalid_argument);
  EXPECT_THROW(noise.apply(picture.labels, picture.instances, DepthImage(3, 3), kHere, 1), std::invalid_argument);
}

}  // namespace
}  // namespace lapis::simulator
