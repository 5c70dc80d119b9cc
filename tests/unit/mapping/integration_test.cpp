#include "common/mapping/votes/integration.hpp"
#include "common/mapping/votes/cell_hits.hpp"

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "common/mapping/model/voxel_map.hpp"
#include "tests/support/synthetic_flat.hpp"
#include "tests/unit/mapping/plain_votes.hpp"

namespace lapis::mapping {
namespace {

using geometry::Pose;

using test::PlainVotes;

PlainVotes plain(const FrameVotes& votes) {
  PlainVotes p;
  for (const BlockVotes& block : votes.blocks) {
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const bool is_miss = block.misses[static_cast<std::size_t>(offset / 64)] >> (offset % 64) & 1u;
      if (is_miss) p.misses.insert(voxel_at(block.block, offset));
    }
    for (const HitVote& hit : votes.hits_of(block))
      EXPECT_TRUE(p.hits[voxel_at(block.block, hit.offset)].emplace(hit.label, hit.weight).second);
  }
  for (const auto& [voxel, ballot] : p.hits) EXPECT_FALSE(p.misses.contains(voxel));
  return p;
}

CompactFrame frame_of(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                      const geometry::LabelImage* labels = nullptr, int stride = 1,
                      const geometry::ConfidenceImage* confidence = nullptr) {
  std::string error;
  return CompactFrame::make(camera, depth, labels, {stride, 65535}, error, confidence).value();
}

IntegrationConfig exact_config() {
  IntegrationConfig config;
  config.depth_noise_per_m = 0.0;
  return config;
}

/// Exit of the segment a + t d from a voxel as t; negative when it does not cross the voxel's inside.
double exit_of(const VoxelIndex& v, double r, const Eigen::Vector3d& a, const Eigen::Vector3d& d) {
  double enter = 0.0, leave = 1e9;
  const double low[] = {v.x * r, v.y * r, v.z * r};
  for (int axis = 0; axis < 3; ++axis) {
    const double t0 = (low[axis] - a[axis]) / d[axis], t1 = (low[axis] + r - a[axis]) / d[axis];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter < leave ? leave : -1.0;
}

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto next = [&] { return u(random); };
  geometry::Vector6d xi;
  xi << 3 * next(), 3 * next(), 3 * next(), 2 * next(), 2 * next(), 2 * next();
  return geometry::se3_exp(xi);
}

TEST(ComputeVotes, EqualsSlabTestOfEveryVoxelAndRay) {
  // Pixels so far apart that each sees its own voxel: every ray is followed.
  const geometry::PinholeCamera camera{7, 5, 4, 4, 3, 2};
  std::mt19937 random(11);
  std::uniform_real_distribution<float> depth_m(1.5f, 8.0f);
  const double r = 0.25;
  const VoxelMap grid(r);
  IntegrationConfig config = exact_config();
  for (int trial = 0; trial < 20; ++trial) {
    config.end_margin_voxels = 0.5 * (trial % 3);
    geometry::DepthImage depth(camera.width, camera.height);
    for (float& d : depth.pixels) d = depth_m(random);
    const Pose T = random_pose(random);
    const PlainVotes got = plain(compute_votes(frame_of(camera, depth), T, config, r));

    PlainVotes expected;
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const double depth_rounded = std::round(depth(column, row) * 1000.0f) * 1e-3;
        Eigen::Vector3d ray = T.linear() * camera.unproject(column, row, depth_rounded);
        const double range = ray.norm();
        double t_end = 1.0 - config.end_margin_voxels * r / range;
        if (range > config.max_range_m) {
          ray *= config.max_range_m / range;
          t_end = 1.0;
        } else {
          expected.hits[grid.index_of(T.translation() + ray)] = test::whole_vote(0);
        }
        const VoxelIndex center = grid.index_of(T.translation());
        const int reach = static_cast<int>(config.max_range_m / r) + 2;
        for (int z = -reach; z <= reach; ++z)
          for (int y = -reach; y <= reach; ++y)
            for (int x = -reach; x <= reach; ++x) {
              const VoxelIndex v{center.x + x, center.y + y, center.z + z};
              const double leave = exit_of(v, r, T.translation(), ray);
              if (leave >= 0.0 && leave <= t_end) expected.misses.insert(v);
            }
      }
    for (const auto& [voxel, label] : expected.hits) expected.misses.erase(voxel);
    EXPECT_EQ(got.misses, expected.misses) << "trial " << trial;
    EXPECT_EQ(got.hits, expected.hits) << "trial " << trial;
  }
}

TEST(ComputeVotes, EqualsItsPlainestFormToTheLastVote) {
  const geometry::PinholeCamera camera{160, 91, 80, 80, 79.5, 44.5};
  const auto flat = lapis::test::furnished_flat();
  std::mt19937 random(5);
  for (const Pose& T : lapis::test::walk_through_flat(2)) {
    auto image = lapis::test::render(flat, camera, T);
    lapis::test::add_noise(image, random);
    for (std::size_t i = 0; i < image.depth.pixels.size(); i += 17) image.depth.pixels[i] = 0.0f;
    geometry::ConfidenceImage confidence(camera.width, camera.height);
    for (std::uint8_t& value : confidence.pixels) value = static_cast<std::uint8_t>(random());
    for (const double r : {0.5, 0.25, 0.1, 0.05, 0.02}) {
      IntegrationConfig config;
      config.max_range_m = r < 0.1 ? 3.0 : 5.0;
      config.min_range_m = r < 0.2 ? 0.0 : 0.3;
      config.end_margin_voxels = r > 0.2 ? 0.5 : 0.0;
      config.kernel_length_voxels = r < 0.5 ? 0.0 : 2.2;
      const auto* certainty = r == 0.25 || r == 0.05 ? nullptr : &confidence;
      const CompactFrame frame = frame_of(camera, image.depth, &image.labels, r < 0.1 ? 3 : 1, certainty);
      const PlainVotes expected = test::PlainIntegration(frame, T, config, r).votes();
      ASSERT_EQ(plain(compute_votes(frame, T, config, r)), expected) << r;
      ASSERT_GT(expected.misses.size(), 100u);
    }
  }
}

TEST(ComputeVotes, HitsAreExactlyTheVoxelsOfTheSampledPoints) {
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  const auto room = lapis::test::furnished_room();
  for (const double r : {0.02, 0.05, 0.1, 0.25, 0.5}) {
    const VoxelMap grid(r);
    const Pose T = lapis::test::look({-1.0, 0.3, 1.1}, 0.7, 0.2);
    const auto image = lapis::test::render(room, camera, T);
    const PlainVotes got = plain(compute_votes(frame_of(camera, image.depth, &image.labels), T, exact_config(), r));
    std::map<VoxelIndex, std::map<int, int>> tally;
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const Eigen::Vector3d p = camera.unproject(column, row, std::round(image.depth(column, row) * 1000.0f) * 1e-3);
        if (p.norm() <= 5.0) ++tally[grid.index_of(T * p)][image.labels(column, row)];
      }
    // Points on a voxel boundary may fall to either side by rounding.
    std::size_t different = 0;
    for (const auto& [voxel, classes] : tally) {
      int best = 0, most = 0;
      for (const auto& [label, n] : classes)
        if (n > most) best = label, most = n;
      const auto it = got.hits.find(voxel);
      if (it == got.hits.end() || it->second != test::whole_vote(best)) ++different;
    }
    EXPECT_LE(different, tally.size() / 200) << r;
    EXPECT_NEAR(static_cast<double>(got.hits.size()), static_cast<double>(tally.size()),
                1.0 + 0.005 * static_cast<double>(tally.size()));
  }
}

/// A camera that looks along +x at a wall; two columns of pixels.
struct TwoPixels {
  geometry::PinholeCamera camera{9, 1, 1000, 1000, 4, 0};
  Pose T = lapis::test::look({0.1, 0.1, 0.1}, 0.0);
  geometry::DepthImage depth{9, 1, 2.0f};
  geometry::LabelImage labels{9, 1};
};

TEST(ComputeVotes, ClassIsTheMajorityAndTiesGoToTheSmallerId) {
  TwoPixels s;
  const auto label = [&s] {
    const PlainVotes got = plain(compute_votes(frame_of(s.camera, s.depth, &s.labels), s.T, exact_config(), 0.5));
    EXPECT_EQ(got.hits.size(), 1u);
    return got.hits.begin()->second;
  };
  s.labels.pixels = {7, 7, 3, 3, 3, 9, 9, 9, 9};
  EXPECT_EQ(label(), test::whole_vote(9));
  s.labels.pixels = {7, 7, 7, 3, 3, 3, 0, 0, 0};
  EXPECT_EQ(label(), test::whole_vote(3));
  s.labels.pixels = {0, 0, 0, 0, 0, 0, 0, 0, 5};  // any label beats none
  EXPECT_EQ(label(), test::whole_vote(5));
  s.labels.pixels.assign(9, 0);
  EXPECT_EQ(label(), test::whole_vote(0));
}

TEST(ComputeVotes, PixelsWeighAsMuchAsTheirLabelsAreCertain) {
  TwoPixels s;
  geometry::ConfidenceImage confidence(9, 1);
  const auto vote = [&] {
    const CompactFrame frame = frame_of(s.camera, s.depth, &s.labels, 1, &confidence);
    return plain(compute_votes(frame, s.T, exact_config(), 0.5)).hits.begin()->second;
  };
  s.labels.pixels = {7, 7, 7, 7, 7, 9, 9, 0, 0};
  confidence.pixels = {51, 51, 51, 51, 51, 255, 204, 255, 255};
  EXPECT_EQ(vote(), (test::Ballot{{0, 26}, {9, 230}})) << "two sure pixels against five unsure ones; 0.9 of a vote";
  confidence.pixels.assign(9, 0);
  EXPECT_EQ(vote(), test::whole_vote(0)) << "a surface is there, of whatever class";
}

TEST(ComputeVotes, HitsWeighLessWhereNoiseIsNotSmallAgainstAVoxel) {
  TwoPixels s;
  s.labels.pixels.assign(9, 7);
  IntegrationConfig config = exact_config();
  const auto vote = [&](double resolution_m) {
    return plain(compute_votes(frame_of(s.camera, s.depth, &s.labels), s.T, config, resolution_m)).hits.begin()->second;
  };
  config.depth_noise_per_m = 0.05 / 4.0;  // 5 cm at 2 m
  EXPECT_EQ(vote(0.5), test::whole_vote(7)) << "five standard deviations to either side";
  EXPECT_EQ(vote(0.1), (test::Ballot{{7, 175}})) << "one: 68.27 %";
  config.depth_noise_per_m = 0.05;
  EXPECT_EQ(vote(0.02), (test::Ballot{{7, 10}})) << "a twentieth: 3.99 %";
}

TEST(ComputeVotes, AKernelLetsNeighboursOutvoteALoneLabelAndAddsNoVoxels) {
  // A wall of 9 x 3 voxels of half a metre, a pixel in each.
  const geometry::PinholeCamera camera{9, 3, 4, 4, 4, 1};
  const Pose T = lapis::test::look({0.1, 0.2, 0.2}, 0.0);
  const geometry::DepthImage depth(9, 3, 2.0f);
  geometry::LabelImage labels(9, 3, 4);
  labels(4, 1) = 7;
  IntegrationConfig config = exact_config();
  const PlainVotes sharp = plain(compute_votes(frame_of(camera, depth, &labels), T, config, 0.5));
  config.kernel_length_voxels = 3.0;
  const PlainVotes smooth = plain(compute_votes(frame_of(camera, depth, &labels), T, config, 0.5));
  ASSERT_EQ(sharp.hits.size(), 27u);
  EXPECT_EQ(sharp.hits.at({4, 0, 0}), test::whole_vote(7));
  EXPECT_EQ(smooth.hits.at({4, 0, 0}), test::whole_vote(4));
  EXPECT_EQ(smooth.hits.size(), sharp.hits.size());
  EXPECT_EQ(smooth.misses, sharp.misses);
}

TEST(SparseKernel, FallsFromOneToZero) {
  EXPECT_DOUBLE_EQ(sparse_kernel(0.0), 1.0);
  EXPECT_NEAR(sparse_kernel(0.5), 1.0 / 6.0, 1e-12);
  EXPECT_EQ(sparse_kernel(1.0), 0.0);
  EXPECT_EQ(sparse_kernel(7.0), 0.0);
  for (double share = 0.01; share < 1.0; share += 0.01) EXPECT_LT(sparse_kernel(share), sparse_kernel(share - 0.01));
}

TEST(ComputeVotes, FarReturnsCarveWithoutHitAndMissingDepthSaysNothing) {
  TwoPixels s;
  s.depth = geometry::DepthImage(9, 1, 40.0f);
  const PlainVotes far = plain(compute_votes(frame_of(s.camera, s.depth), s.T, exact_config(), 0.5));
  EXPECT_TRUE(far.hits.empty());
  EXPECT_EQ(far.misses.size(), 10u);  // 5 m from x = 0.1 leaves cells 0..9
  s.depth = geometry::DepthImage(9, 1, 0.0f);
  EXPECT_TRUE(compute_votes(frame_of(s.camera, s.depth), s.T, exact_config(), 0.5).blocks.empty());
  s.depth = geometry::DepthImage(9, 1, 0.1f);  // below min_range_m
  EXPECT_TRUE(compute_votes(frame_of(s.camera, s.depth), s.T, exact_config(), 0.5).blocks.empty());
}

/// A camera that looks along +x at a wall, and a drift that reaches half a voxel of 0.1 m at 2 m.
struct DriftingFrame {
  explicit DriftingFrame(double wall_m) : depth(camera.width, camera.height, static_cast<float>(wall_m)) {}

  PlainVotes votes(const Drift& with) const {
    return plain(compute_votes(frame_of(camera, depth), T, exact_config(), 0.1, with));
  }
  /// How far the voxels in front of the camera are free: x of the last one that gets a miss, all before get one, too.
  static int last_free(const PlainVotes& votes) {
    int x = kCameraVoxel;
    while (votes.misses.contains({x + 1, 1, 1})) ++x;
    for (int behind = x + 1; behind < 60; ++behind) EXPECT_FALSE(votes.misses.contains({behind, 1, 1})) << behind;
    return x;
  }

  static constexpr int kCameraVoxel = 1;
  static constexpr double kReach_m = 2.0;
  geometry::PinholeCamera camera{161, 91, 80, 80, 80, 45};
  Pose T = lapis::test::look({0.13, 0.15, 0.15}, 0.0);
  geometry::DepthImage depth;
  Drift drift{0.01, 0.02};
};

TEST(ComputeVotesWithDrift, HitsOnlyWhereTheDisplacementIsBelowHalfAVoxel) {
  const DriftingFrame s(1.93);  // the wall is at x = 2.06, in voxel 20
  const PlainVotes all = s.votes({}), near = s.votes(s.drift);
  const double radius_m = std::sqrt(s.kReach_m * s.kReach_m - 1.93 * 1.93);
  constexpr double kVoxelDiagonal_m = 0.1415;
  std::size_t inside = 0;
  for (const auto& [voxel, ballot] : all.hits) {
    const double off_axis_m = std::hypot(0.1 * voxel.y + 0.05 - 0.15, 0.1 * voxel.z + 0.05 - 0.15);
    if (off_axis_m < radius_m - kVoxelDiagonal_m / 2) {
      EXPECT_TRUE(near.hits.contains(voxel) && near.hits.at(voxel) == ballot);
      ++inside;
    }
    if (off_axis_m > radius_m + kVoxelDiagonal_m / 2) {
      EXPECT_FALSE(near.hits.contains(voxel));
    }
  }
  EXPECT_GT(inside, 50u);
  EXPECT_LT(near.hits.size(), all.hits.size() / 4);
}

TEST(ComputeVotesWithDrift, MissesEndThreeDisplacementsBeforeTheSurface) {
  const DriftingFrame s(1.93);
  EXPECT_EQ(s.last_free(s.votes({})), 19);
  // 0.1458 m before x = 2.06 begins voxel 19; between it and the wall's voxel 20 lies less than that, and so it does
  // between voxels 18 and 20.
  EXPECT_EQ(s.last_free(s.votes(s.drift)), 17);
  // A third of it is less than a voxel: 18 is further than that from 20.
  EXPECT_EQ(s.last_free(s.votes({0.01 / 3, 0.02 / 3})), 18);
}

TEST(ComputeVotesWithDrift, MissesNeverReachBeyondTheRangeAndKeepAwayFromSurfacesBehindIt) {
  const DriftingFrame far(3.0);
  const PlainVotes votes = far.votes(far.drift);
  EXPECT_TRUE(votes.hits.empty());
  EXPECT_EQ(far.last_free(votes), 20) << "x = 2.13 is the end";
  for (const VoxelIndex& voxel : votes.misses) {
    const Eigen::Vector3d center(0.1 * voxel.x + 0.05, 0.1 * voxel.y + 0.05, 0.1 * voxel.z + 0.05);
    EXPECT_LT((center - far.T.translation()).norm(), far.kReach_m + 0.0866);
  }
  const DriftingFrame just_behind(2.1);  // x = 2.23; 0.156 m less is 2.074, but voxels 20 and 21 are too near to 22
  EXPECT_TRUE(just_behind.votes(just_behind.drift).hits.empty());
  EXPECT_EQ(just_behind.last_free(just_behind.votes(just_behind.drift)), 19);
}

TEST(ComputeVotesWithDrift, ReturnsBeyondTheSensorsRangeKeepTheMarginToo) {
  const DriftingFrame s(5.05);
  const Drift drift{0.049, 0.0};  // allowed everywhere
  EXPECT_EQ(s.last_free(s.votes({})), 50) << "up to 5 m";
  EXPECT_EQ(s.last_free(s.votes(drift)), 49) << "up to 5.05 m less 0.147 m";
}

TEST(ComputeVotesWithDrift, NothingIsSaidWhenThePositionAloneIsOffByHalfAVoxel) {
  const DriftingFrame s(1.0);
  EXPECT_TRUE(s.votes({0.051, 0.0}) == PlainVotes{});
  EXPECT_TRUE(s.votes({0.0, 0.3}) == PlainVotes{}) << "0.17 m are nearer than the sensor sees";
  EXPECT_EQ(s.votes({0.049, 0.0}).hits, s.votes({}).hits);
}

// The frame is off by three sigmas in any direction: it takes away no surface that it sees.
TEST(ComputeVotesWithDrift, NoVoxelWithASeenSurfaceGetsAMissWithinThreeSigmas) {
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  const auto room = lapis::test::furnished_room();
  std::mt19937 random(3);
  const auto direction = [&random] {
    std::normal_distribution<double> n;
    return Eigen::Vector3d(n(random), n(random), n(random)).normalized();
  };
  std::size_t without = 0, seen = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double r = trial % 2 == 0 ? 0.25 : 0.1, size = r * (0.05 + 0.1 * (trial % 5));
    const Drift drift{size * (trial % 3) / 2.0, size / 2.0};
    const Pose T = lapis::test::look({-1.0 + 0.02 * trial, 0.3, 1.1}, 0.1 * trial, 0.2);
    const auto image = lapis::test::render(room, camera, T);
    Pose claimed = T;
    claimed.translation() += 3.0 * drift.position_m * direction();
    claimed.linear() = Eigen::AngleAxisd(3.0 * drift.rotation_rad, direction()) * T.linear();
    const CompactFrame frame = frame_of(camera, image.depth, &image.labels);
    const PlainVotes held = plain(compute_votes(frame, claimed, {}, r));
    const PlainVotes drifting = plain(compute_votes(frame, claimed, {}, r, drift));
    const VoxelMap grid(r);
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const Eigen::Vector3d p = camera.unproject(column, row, image.depth(column, row));
        if (p.norm() > 5.0) continue;
        const VoxelIndex voxel = grid.index_of(T * p);
        ++seen;
        without += held.misses.contains(voxel);
        ASSERT_FALSE(drifting.misses.contains(voxel)) << trial << ", " << p.norm() << " m away";
      }
  }
  EXPECT_GT(without, seen / 10);
}

TEST(ComputeVotes, NothingOutsideTheHeightLimits) {
  const geometry::PinholeCamera camera{64, 36, 32, 32, 31.5, 17.5};
  const Pose T = lapis::test::look({-1.0, 0.3, 1.1}, 0.7, 0.2);
  const auto image = lapis::test::render(lapis::test::furnished_room(), camera, T);
  IntegrationConfig config = exact_config();
  const CompactFrame frame = frame_of(camera, image.depth, &image.labels);
  const PlainVotes all = plain(compute_votes(frame, T, config, 0.1));
  config.min_height_m = 0.5;
  config.max_height_m = 1.5;
  const PlainVotes cut = plain(compute_votes(frame, T, config, 0.1));
  PlainVotes expected;
  const auto is_inside = [](const VoxelIndex& v) { return v.z >= 5 && v.z < 15; };
  for (const VoxelIndex& v : all.misses)
    if (is_inside(v)) expected.misses.insert(v);
  for (const auto& [v, label] : all.hits)
    if (is_inside(v)) expected.hits[v] = label;
  EXPECT_EQ(cut.misses, expected.misses);
  EXPECT_EQ(cut.hits, expected.hits);
  EXPECT_LT(cut.hits.size(), all.hits.size());
}

TEST(ComputeVotes, FreeSpaceIsFreeAndSurfacesNeverGetAMiss) {
  // Nothing may get a miss that lies behind the first surface of every pixel.
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  const Pose T = lapis::test::look({-1.0, 0.3, 1.1}, 0.7, 0.2);
  const auto room = lapis::test::furnished_room();
  const auto image = lapis::test::render(room, camera, T);
  const VoxelMap grid(0.1);
  const PlainVotes got = plain(compute_votes(frame_of(camera, image.depth, &image.labels), T, exact_config(), 0.1));
  for (const VoxelIndex& voxel : got.misses) {
    const Eigen::Vector3d center = grid.center_of(voxel);
    for (const lapis::test::Box& box : room) {
      const Eigen::Vector3d inside = (center - box.low).cwiseMin(box.high - center);
      EXPECT_LT(inside.minCoeff(), 0.1) << "a voxel deep inside a box got a miss";
    }
  }
  EXPECT_GT(got.misses.size(), 5000u);
}

TEST(ComputeVotes, IsDeterministic) {
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  const Pose T = lapis::test::look({-1.0, 0.3, 1.1}, 0.7, 0.2);
  const auto image = lapis::test::render(lapis::test::furnished_room(), camera, T);
  const CompactFrame frame = frame_of(camera, image.depth, &image.labels, 2);
  EXPECT_EQ(compute_votes(frame, T, {}, 0.05), compute_votes(frame, T, {}, 0.05));
}

TEST(ComputeVotes, RefusesRangeOfTooManyVoxels) {
  TwoPixels s;
  IntegrationConfig config;
  config.max_range_m = 11.0;
  EXPECT_THROW(compute_votes(frame_of(s.camera, s.depth), s.T, config, 0.02), std::runtime_error);
}

TEST(ValidateIntegrationConfig, NamesTheValue) {
  IntegrationConfig config;
  config.max_range_m = 100.0;
  try {
    validate(config);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("max_range_m"), std::string::npos);
  }
}

}  // namespace
}  // namespace lapis::mapping
