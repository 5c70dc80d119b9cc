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

/// Of ranges, within which a heading's error moves surfaces alike [m].
inline constexpr double kStakeBin_m = 0.5;
/// A voxel in fixed point, so that sums are exact in any order.
inline constexpr std::int64_t kOneVoxel = std::int64_t{1} << 24U;

/// Occupied voxels that hang on a key-frame, by their distance from it: bin i holds those from i to i + 1 times
/// kStakeBin_m [1/kOneVoxel voxels].
using Stake = std::vector<std::int64_t>;

/// How much of a map hangs on which key-frame: every occupied voxel counts one, split over the key-frames whose frames
/// hit it by share of the weight of their votes. When the pose graph moves a key-frame, so much of the map moves with
/// it; when it has the key-frame wrong, so much is wrong. Free space counts nothing. Times what a first look at a
/// surface tells, this is what the map knows by that key-frame. What an earlier run left in a map that is
/// resumed hangs on no key-frame.
class MapStakes {
 public:
  /// Throws std::runtime_error naming the parameter of the sensor model that is out of range.
  MapStakes(const mapping::SensorModel& model, double resolution_m) : reader_(model), resolution_m_(resolution_m) {}

  /// Votes that have come into the map by a frame of a key-frame at this position.
  void add(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes);
  /// Votes that have gone; the position is the one with which they came.
  void subtract(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes);
  /// Brings the stakes up to date with the map, into and out of which the same votes have come and gone. To be called
  /// now and then: until then every vote is remembered.
  void update(const mapping::VoxelMap& map);

  /// By key-frame, right after update(); none of them is zero altogether.
  const std::map<std::uint64_t, Stake>& stakes() const { return stakes_; }

 private:
  struct Part {
    std::uint64_t keyframe;
    std::uint32_t bin;
    std::uint32_t weight;  ///< of votes [1/256 vote], > 0
  };
  struct Surface {
    std::vector<Part> parts;  ///< by key-frame, then bin
    bool is_counted = false;  ///< its parts are in the stakes
  };

  template <class Change>
  void change(const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes, const Change& change_part);
  void touch_missed(const mapping::BlockVotes& votes);
  /// Puts a voxel into the stakes, or takes it out.
  void count(Surface& surface, bool is_counted);

  mapping::BeliefReader reader_;
  double resolution_m_;
  std::unordered_map<mapping::VoxelIndex, Surface, mapping::GridIndexHash> surfaces_;
  std::unordered_map<mapping::BlockIndex, mapping::BlockMask, mapping::GridIndexHash> known_;  ///< that have been hit
  std::vector<mapping::VoxelIndex> touched_;  ///< since the last update
  std::map<std::uint64_t, Stake> stakes_;
};

}  // namespace lapis::semantic_mapper
