#pragma once

#include <random>

#include "common/geometry/se3.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::planner::test {

inline std::uint32_t random_number(std::mt19937& random, int low, int high) {
  return static_cast<std::uint32_t>(std::uniform_int_distribution<int>(low, high)(random));
}

/// Misses, hits of labels 0 to class_count + 1, whole votes and parts of votes.
inline mapping::VoxelCounts random_counts(std::mt19937& random, int class_count, int most_misses) {
  mapping::VoxelCounts counts;
  counts.misses = random_number(random, 0, most_misses) * mapping::kOneVote;
  const std::uint32_t hits = random_number(random, 0, 3);
  for (std::uint32_t i = 0; i < hits; ++i) {
    const auto label = static_cast<std::uint16_t>(random_number(random, 0, class_count + 1));
    if (!counts.hits.empty() && counts.hits.back().label >= label) continue;
    counts.hits.push_back({label, random_number(random, 1, 4 * static_cast<int>(mapping::kOneVote))});
  }
  return counts;
}

/// Blocks around the origin, two along each axis: some unknown, some uniform, some with every kind of voxel, most of
/// them free.
inline mapping::VoxelMap random_map(std::mt19937& random, double resolution_m, int class_count) {
  mapping::VoxelMap map(resolution_m);
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t kind = random_number(random, 0, 4);
    if (kind == 0) continue;
    mapping::VoxelBlock block(random_number(random, 1, 12) * mapping::kOneVote);
    for (int offset = 0; kind > 1 && offset < mapping::kBlockVoxels; ++offset) {
      if (random_number(random, 0, 9) > 2) continue;
      const mapping::VoxelCounts counts = random_counts(random, class_count, 8);
      if (counts.misses > 0) block.add_miss(offset, counts.misses);
      for (const mapping::ClassCount& hit : counts.hits) block.add_hit(offset, hit.label, hit.count);
    }
    map.set_block({(i & 1) - 1, (i >> 1 & 1) - 1, (i >> 2) - 1}, std::move(block));
  }
  return map;
}

/// Within a cube of this half edge around the origin, any attitude.
inline geometry::Pose random_pose(std::mt19937& random, double half_edge_m) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto next = [&] { return u(random); };
  Eigen::Vector3d translation;
  Eigen::Quaterniond rotation;
  for (double& v : translation) v = half_edge_m * next();
  for (double& v : rotation.coeffs()) v = next();
  return geometry::make_pose(translation, rotation);
}

}  // namespace lapis::planner::test
