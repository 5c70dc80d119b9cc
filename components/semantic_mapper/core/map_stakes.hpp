#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::semantic_mapper {

/// Width of a bin of ranges, within which an error of heading moves surfaces about equally [m].
inline constexpr double kStakeBin_m = 0.5;
/// One voxel in fixed point, so that sums are exact in any order.
inline constexpr std::int64_t kOneVoxel = std::int64_t{1} << 24U;

/// Occupied voxels that depend on a key-frame, by their distance from it: bin i holds those from i to i + 1 times
/// kStakeBin_m [1/kOneVoxel voxels].
using Stake = std::vector<std::int64_t>;

/// How much of a map depends on which key-frame. Every occupied voxel counts one, split over the key-frames whose
/// frames hit it in proportion to the weights of their votes. When the pose graph moves a key-frame, this much of the
/// map moves with it; when the key-frame is wrong, this much is wrong. Free space does not count. Multiplied by what a
/// first look at a surface tells, this is what the map knows by that key-frame. What an earlier run left in a map that
/// is resumed depends on no key-frame.
class MapStakes {
 public:
  /// Throws std::runtime_error that names the parameter of the sensor model that is out of range.
  MapStakes(const mapping::SensorModel& model, double resolution_m) : reader_(model), resolution_m_(resolution_m) {}

  /// Adds votes that a frame of a key-frame at this position has put into the map.
  void add(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes);
  /// Removes votes that were taken out of the map; the position is the one with which they were added.
  void subtract(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes);
  /// Brings the stakes up to date with the map, into which the same votes were put and taken out. Call it now and then:
  /// until then every vote is remembered.
  void update(const mapping::VoxelMap& map);

  /// By key-frame, valid right after update(); none of them is all zero.
  const std::map<std::uint64_t, Stake>& stakes() const { return stakes_; }

 private:
  struct Part {
    std::uint64_t keyframe;
    std::uint32_t bin;
    std::uint32_t weight;  ///< sum over its votes [1/256 vote], > 0
  };
  struct Surface {
    std::vector<Part> parts;  ///< by key-frame, then bin
    bool is_counted = false;  ///< its parts are in the stakes
  };

  template <class Change>
  void change(const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes, const Change& change_part);
  void touch_missed(const mapping::BlockVotes& votes);
  /// Adds a voxel to the stakes, or removes it.
  void count(Surface& surface, bool is_counted);

  mapping::BeliefReader reader_;
  double resolution_m_;
  std::unordered_map<mapping::VoxelIndex, Surface, mapping::GridIndexHash> surfaces_;
  std::unordered_map<mapping::BlockIndex, mapping::BlockMask, mapping::GridIndexHash> known_;  ///< voxels with hits
  std::vector<mapping::VoxelIndex> touched_;  ///< voxels with votes since the last update
  std::map<std::uint64_t, Stake> stakes_;
};

}  // namespace lapis::semantic_mapper
