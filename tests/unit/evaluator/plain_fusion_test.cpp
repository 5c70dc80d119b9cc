#include "evaluator/core/map/plain_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace lapis::evaluator {
namespace {

struct Frame {
  geometry::DepthImage depth;
  geometry::LabelImage labels;
  geometry::Pose T_map_camera;
};

const geometry::PinholeCamera kCamera{64, 36, 32.0, 32.0, 31.5, 17.5};

Frame random_frame(unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Frame frame{geometry::DepthImage(64, 36), geometry::LabelImage(64, 36), geometry::Pose::Identity()};
  for (float& z : frame.depth.pixels) z = static_cast<float>(std::max(0.0, 3.0 + 4.0 * uniform(engine)));
  for (std::uint16_t& label : frame.labels.pixels) label = static_cast<std::uint16_t>(engine() % 3);
  geometry::Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = uniform(engine);
  frame.T_map_camera = geometry::se3_exp(xi);
  return frame;
}

// The definition, pixel by pixel.
std::vector<LabelledVoxel> brute_force(const std::vector<Frame>& frames, const PlainFusionConfig& config) {
  const auto before = [](const VoxelIndex& a, const VoxelIndex& b) { return is_before(a, b); };
  std::map<VoxelIndex, std::map<std::uint16_t, int>, decltype(before)> counts(before);
  for (const Frame& frame : frames) {
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const Eigen::Vector3d p_camera = kCamera.unproject(u, v, frame.depth(u, v));
        const double range = p_camera.norm();
        if (range == 0.0 || range < config.min_range_m || range > config.max_range_m) continue;
        const Eigen::Vector3d p = frame.T_map_camera * p_camera / config.resolution_m;
        const VoxelIndex index = p.array().floor().cast<int>();
        ++counts[index][frame.labels(u, v)];
      }
    }
  }
  std::vector<LabelledVoxel> voxels;
  for (const auto& [index, labels] : counts) {
    std::uint16_t best = 0;
    int most = 0;
    for (std::uint16_t label = 1; label < 3; ++label) {
      if (labels.contains(label) && labels.at(label) > most) {
        best = label;
        most = labels.at(label);
      }
    }
    if (labels.contains(0) && labels.at(0) > most) best = 0;
    voxels.push_back({index, best});
  }
  return voxels;
}

TEST(PlainFusionTest, AgreesWithThePixelByPixelDefinition) {
  const PlainFusionConfig config{0.25, 0.5, 5.0};
  PlainFusion fusion(config);
  std::vector<Frame> frames;
  for (unsigned seed = 0; seed < 5; ++seed) {
    frames.push_back(random_frame(seed));
    fusion.add(kCamera, frames.back().depth, frames.back().labels, frames.back().T_map_camera);
    EXPECT_EQ(fusion.voxels().voxels, brute_force(frames, config));
  }
}

TEST(PlainFusionTest, DoesNotDependOnTheOrderOfFrames) {
  PlainFusion forward({}), backward({});
  for (unsigned i = 0; i < 4; ++i) {
    const Frame a = random_frame(i);
    const Frame b = random_frame(3 - i);
    forward.add(kCamera, a.depth, a.labels, a.T_map_camera);
    backward.add(kCamera, b.depth, b.labels, b.T_map_camera);
  }
  EXPECT_EQ(forward.voxels().voxels, backward.voxels().voxels);
}

TEST(PlainFusionTest, NothingIsCarvedAndNoDepthIsNothing) {
  PlainFusion fusion({});
  const geometry::DepthImage none(64, 36), near(64, 36, 1.0f), far(64, 36, 3.0f), beyond(64, 36, 60.0f);
  fusion.add(kCamera, none, {}, geometry::Pose::Identity());
  fusion.add(kCamera, beyond, {}, geometry::Pose::Identity());
  EXPECT_TRUE(fusion.voxels().voxels.empty());
  fusion.add(kCamera, near, {}, geometry::Pose::Identity());
  const auto before = fusion.voxels().voxels.size();
  fusion.add(kCamera, far, {}, geometry::Pose::Identity());
  EXPECT_GT(fusion.voxels().voxels.size(), before);
  EXPECT_EQ(fusion.voxels().voxels.front().label, 0);
}

TEST(PlainFusionTest, RefusesImagesThatDoNotFit) {
  PlainFusion fusion({});
  const geometry::Pose far_away = geometry::make_pose({1e9, 0, 0}, Eigen::Quaterniond::Identity());
  EXPECT_THROW(fusion.add(kCamera, geometry::DepthImage(63, 36), {}, geometry::Pose::Identity()),
               std::invalid_argument);
  EXPECT_THROW(
      fusion.add(kCamera, geometry::DepthImage(64, 36), geometry::LabelImage(64, 35), geometry::Pose::Identity()),
      std::invalid_argument);
  EXPECT_THROW(fusion.add(kCamera, geometry::DepthImage(64, 36), {}, far_away), std::invalid_argument);
  EXPECT_THROW(PlainFusion({.resolution_m = 0.0}), std::invalid_argument);
  EXPECT_THROW(PlainFusion({.resolution_m = 0.1, .min_range_m = 2.0, .max_range_m = 1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace lapis::evaluator
