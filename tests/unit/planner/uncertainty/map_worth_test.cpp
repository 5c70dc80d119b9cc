#include "planner/core/uncertainty/map_worth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "planner/core/uncertainty/surviving_share.hpp"

namespace lapis::planner {
namespace {

using geometry::Pose;

/// A camera that looks along the robot's heading.
Pose looking(double x, double y, double heading_rad) {
  Eigen::Matrix3d R_base_camera;
  R_base_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return geometry::make_pose(
      {x, y, 1.0},
      Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * R_base_camera));
}

Information information_of(double sigma_m, double sigma_rad) {
  Information information = Information::Zero(6, 6);
  information.diagonal() << Eigen::Vector3d::Constant(std::pow(sigma_m, -2)),
      Eigen::Vector3d::Constant(std::pow(sigma_rad, -2));
  return information;
}

struct Drive {
  std::vector<Keyframe> keyframes;
  std::vector<KeyframeEdge> edges;
  SurfaceStakes stakes;

  MapWorth worth(const MapWorthConfig& config = {}) const {
    auto made = MapWorth::make(keyframes, edges, stakes, config);
    if (const auto* error = std::get_if<GraphError>(&made)) throw std::runtime_error(error->message);
    return std::get<MapWorth>(std::move(made));
  }
};

/// Round a square of 8 m, and almost back to the start; a blind stretch in the middle of the first side turns the rest.
Drive around_the_square(double blind_rad = 0.0) {
  Drive drive;
  for (int i = 0; i < 32; ++i) {
    const int side = i / 8;
    const double s = i % 8;
    const double x = side == 0 ? s : side == 1 ? 8.0 : side == 2 ? 8.0 - s : 0.0;
    const double y = side == 0 ? 0.0 : side == 1 ? s : side == 2 ? 8.0 : 8.0 - s;
    drive.keyframes.push_back({static_cast<std::uint64_t>(i), looking(x, y, side * std::numbers::pi / 2)});
    drive.stakes.voxels[static_cast<std::uint64_t>(i)] = {0.0, 10.0, 20.0, 20.0, 10.0};
    if (i == 0) continue;
    const double sigma_rad = i == 4 ? std::max(blind_rad, 0.002) : 0.002;
    drive.edges.push_back(
        {static_cast<std::uint64_t>(i - 1), static_cast<std::uint64_t>(i), information_of(0.005, sigma_rad), false});
  }
  return drive;
}

TEST(MapWorth, IsTheSumOfWhatSurvives) {
  const Drive drive = around_the_square();
  MapWorthConfig config;
  config.voxel_nats = 0.7;
  const MapWorth worth = drive.worth(config);
  const auto marginals = worth.graph().marginals();
  double sum = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < marginals.size(); ++i) {
    const auto& voxels = drive.stakes.voxels.at(i);
    for (std::size_t bin = 0; bin < voxels.size(); ++bin) {
      const double range_m = (static_cast<double>(bin) + 0.5) * 0.5;
      const double sigma_m = surface_sigma_m(marginals[i], drive.keyframes[i].T_map_camera.linear().col(2), range_m);
      sum += 0.7 * voxels[bin] * surviving_share(sigma_m, 0.25);
      whole += 0.7 * voxels[bin];
    }
  }
  EXPECT_NEAR(worth.nats(), sum, 1e-9 * sum);
  EXPECT_LT(worth.nats(), whole);
}

TEST(MapWorth, ExactPosesSecureNothing) {
  MapWorthConfig config;
  config.sigma_factor = 0.0;
  const MapWorth worth = around_the_square().worth(config);
  EXPECT_EQ(worth.secured_nats({{0, {0.0, 0.5}, 1.0, 0.9}}), 0.0);
  EXPECT_EQ(worth.share_of_view({0.0, 0.5}, {1, 0, 0}, 5.0), 1.0);
}

// The graph with the path's node and the loop's edge, factorised again, has the same worth.
TEST(MapWorth, SecuresWhatAClosedLoopWould) {
  Drive drive = around_the_square();
  const Information loop = information_of(0.01, 0.003);
  drive.edges.push_back({2, 20, information_of(0.01, 0.003), true});  // what noise loops have
  const MapWorth before = drive.worth();
  // Without a path the node is the newest key-frame itself.
  const Eigen::Vector2d here = drive.keyframes.back().T_map_camera.translation().head<2>();
  const double secured = before.secured_nats({{0, here, 0.0, 1.0}});
  Drive after = drive;
  after.edges.push_back({0, 31, loop, true});
  EXPECT_GT(secured, 0.0);
  EXPECT_NEAR(secured, after.worth().nats() - before.nats(), 1e-9 * before.nats());
}

TEST(MapWorth, ExpectationIsOverTheSetsThatClose) {
  const MapWorth worth = around_the_square(0.02).worth();
  const PossibleLoop first{0, {0.0, 0.4}, 0.6, 1.0}, second{8, {0.0, 0.4}, 0.6, 1.0};
  const auto with = [](PossibleLoop loop, double probability) {
    loop.probability = probability;
    return loop;
  };
  const double a = worth.secured_nats({first}), b = worth.secured_nats({second}),
               both = worth.secured_nats({first, second});
  EXPECT_GT(both, std::max(a, b));
  EXPECT_NEAR(worth.secured_nats({with(first, 0.3), with(second, 0.6)}),
              0.3 * 0.4 * a + 0.7 * 0.6 * b + 0.3 * 0.6 * both, 1e-9 * worth.nats());
}

// A key-frame from before the blind stretch is the one that is needed; one from after it at the same distance is not.
TEST(MapWorth, LoopAcrossTheErrorIsWorthMore) {
  const MapWorth worth = around_the_square(0.05).worth();
  const Eigen::Vector2d here(0.0, 0.4);
  EXPECT_GT(worth.secured_nats({{2, here, 2.0, 1.0}}), 5.0 * worth.secured_nats({{6, here, 2.0, 1.0}}));
}

// A loop with a key-frame from after the blind stretch, at the same spot, does not mend what arose before it: the one
// from before it is worth as much as ever, and the one from after it nothing more.
TEST(MapWorth, LoopAfterTheErrorDoesNotSpoilTheOneAcrossIt) {
  Drive drive = around_the_square(0.05);
  const Eigen::Vector2d here(0.0, 0.4);
  const PossibleLoop across{2, here, 2.0, 1.0}, after{6, here, 2.0, 1.0};
  const double before_nats = drive.worth().secured_nats({across});
  drive.edges.push_back({6, 31, information_of(0.01, 0.003), true});
  const MapWorth closed = drive.worth();
  EXPECT_GT(closed.secured_nats({across}), 0.8 * before_nats);
  EXPECT_GT(closed.secured_nats({across}), 20.0 * closed.secured_nats({after}));
}

TEST(MapWorth, ViewsFarAwayAndAfterALongPathSurviveLess) {
  const MapWorth worth = around_the_square(0.05).worth();
  const Eigen::Vector3d ahead(1, 0, 0);
  EXPECT_GT(worth.share_of_view({0.0, 0.4}, ahead, 1.0), worth.share_of_view({0.0, 0.4}, ahead, 50.0));
  EXPECT_LT(worth.share_of_view({20.0, 20.0}, ahead, 1.0), worth.share_of_view({0.0, 0.4}, ahead, 1.0));
}

TEST(MapWorth, GraphThatCannotBeAnalysedSaysWhy) {
  const auto made = MapWorth::make({}, {}, {}, {});
  EXPECT_TRUE(std::holds_alternative<GraphError>(made));
}

}  // namespace
}  // namespace lapis::planner
