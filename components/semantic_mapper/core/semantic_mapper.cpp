#include "semantic_mapper/core/semantic_mapper.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;

/// Most frames that a voxel's 32-bit counts of 1/256 votes can hold.
constexpr std::size_t kMaxFrames = (std::size_t{1} << 24) - 1;
/// Keeps voxel indices far inside 32 bits at any resolution.
constexpr double kMaxDistance_m = 10'000.0;

bool is_near(const Pose& T_map_a) { return T_map_a.translation().norm() <= kMaxDistance_m; }

bool is_equal(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }

const MapperConfig& validated(const MapperConfig& config) {
  mapping::validate(config.integration);
  if (config.integration.max_range_m / config.resolution_m > mapping::kMaxRangeInVoxels)
    throw std::runtime_error("mapper: integration.max_range_m exceeds 500 voxels; lower it or raise resolution_m");
  if (!(config.re_anchor_threshold_voxels >= 0.0 && config.re_anchor_threshold_voxels <= 10.0))
    throw std::runtime_error("mapper: re_anchor_threshold_voxels must be in [0, 10]");
  if (!(config.tile_edge_m >= 0.1 && config.tile_edge_m <= 6.4))
    throw std::runtime_error("mapper: tile_edge_m must be in [0.1, 6.4]");
  return config;
}

}  // namespace

SemanticMapper::SemanticMapper(const MapperConfig& config)
    : config_(validated(config)),
      blocks_per_tile_edge_(mapping::blocks_per_tile_edge(config.resolution_m, config.tile_edge_m)),
      map_(config.resolution_m) {}

IntegrationReport SemanticMapper::integrate(AnchoredFrame input) {
  if (!geometry::is_valid(input.T_map_keyframe) || !geometry::is_valid(input.T_keyframe_camera))
    return {IntegrationStatus::kInvalidPose};
  if (!is_near(input.T_map_keyframe) || !is_near(input.T_keyframe_camera)) return {IntegrationStatus::kTooFarAway};
  if (frames_.size() >= kMaxFrames) return {IntegrationStatus::kMapIsFull};
  const bool is_newer = input.graph_version >= graph_version_;
  if (is_newer || !keyframe_poses_.contains(input.keyframe_id)) move_keyframe(input.keyframe_id, input.T_map_keyframe);

  StoredFrame stored{input.stamp,
                     input.keyframe_id,
                     input.T_keyframe_camera,
                     Pose::Identity(),
                     input.frame.median_depth_m(),
                     mapping::PackedFrame(input.frame)};
  stored.T_map_camera = wanted_pose(stored);
  const mapping::FrameVotes votes =
      mapping::compute_votes(input.frame, stored.T_map_camera, config_.integration, config_.resolution_m);
  map_.add(votes);
  mark_changed(votes);
  frame_bytes_ += stored.frame.bytes().size() + sizeof(StoredFrame);
  frames_of_keyframe_[stored.keyframe_id].push_back(frames_.size());
  frames_.push_back(std::move(stored));
  return {IntegrationStatus::kIntegrated, votes.hit_count(), votes.pass_count()};
}

void SemanticMapper::update_keyframe_poses(std::uint64_t graph_version, std::span<const KeyframePose> poses) {
  if (graph_version < graph_version_) return;
  graph_version_ = graph_version;
  for (const KeyframePose& pose : poses)
    if (geometry::is_valid(pose.T_map_keyframe) && is_near(pose.T_map_keyframe))
      move_keyframe(pose.id, pose.T_map_keyframe);
}

void SemanticMapper::move_keyframe(std::uint64_t id, const Pose& T_map_keyframe) {
  const auto [known, is_new] = keyframe_poses_.try_emplace(id, T_map_keyframe);
  if (is_new || is_equal(known->second, T_map_keyframe)) return;
  known->second = T_map_keyframe;
  const auto anchored = frames_of_keyframe_.find(id);
  if (anchored == frames_of_keyframe_.end()) return;
  for (const std::size_t index : anchored->second) {
    if (offset_voxels(frames_[index], wanted_pose(frames_[index])) > config_.re_anchor_threshold_voxels)
      off_.insert(index);
    else
      off_.erase(index);
  }
}

Pose SemanticMapper::wanted_pose(const StoredFrame& frame) const {
  return keyframe_poses_.at(frame.keyframe_id) * frame.T_keyframe_camera;
}

double SemanticMapper::offset_voxels(const StoredFrame& frame, const Pose& T_map_camera) const {
  // Upper bound of how far any point at the median depth has moved.
  const Pose moved = frame.T_map_camera.inverse() * T_map_camera;
  const double turn_m = geometry::rotation_angle(moved.linear()) * frame.median_depth_m;
  return (moved.translation().norm() + turn_m) / config_.resolution_m;
}

void SemanticMapper::move_frame(std::size_t index, const Pose& T_map_camera) {
  StoredFrame& frame = frames_[index];
  const mapping::CompactFrame samples = frame.frame.unpack();
  const auto votes_at = [&](const Pose& pose) {
    return mapping::compute_votes(samples, pose, config_.integration, config_.resolution_m);
  };
  const mapping::FrameVotes old_votes = votes_at(frame.T_map_camera), new_votes = votes_at(T_map_camera);
  map_.subtract(old_votes);
  map_.add(new_votes);
  mark_changed(old_votes);
  mark_changed(new_votes);
  frame.T_map_camera = T_map_camera;
}

std::size_t SemanticMapper::re_anchor(std::size_t max_frames) {
  if (!config_.re_anchor) return 0;
  std::size_t moved = 0;
  for (; moved < max_frames && !off_.empty(); ++moved) {
    const std::size_t index = *off_.begin();
    move_frame(index, wanted_pose(frames_[index]));
    off_.erase(off_.begin());
  }
  return moved;
}

std::size_t SemanticMapper::flush() {
  if (!config_.re_anchor) return 0;
  std::size_t moved = 0;
  for (std::size_t index = 0; index < frames_.size(); ++index) {
    const Pose wanted = wanted_pose(frames_[index]);
    if (is_equal(wanted, frames_[index].T_map_camera)) continue;
    move_frame(index, wanted);
    ++moved;
  }
  off_.clear();
  return moved;
}

void SemanticMapper::mark_changed(const mapping::FrameVotes& votes) {
  for (const mapping::BlockVotes& block : votes.blocks)
    changed_tiles_.insert(mapping::tile_of(block.block, blocks_per_tile_edge_));
}

std::vector<TileUpdate> SemanticMapper::take_changed_tiles() {
  std::vector<TileUpdate> updates;
  if (changed_tiles_.empty()) return updates;
  ++version_;
  std::vector<mapping::TileIndex> indices(changed_tiles_.begin(), changed_tiles_.end());
  changed_tiles_.clear();
  std::sort(indices.begin(), indices.end());
  for (const mapping::TileIndex& index : indices) {
    auto bytes = mapping::encode_tile(map_, index, blocks_per_tile_edge_);
    if (!bytes) {
      ++tiles_too_large_;
      continue;
    }
    const auto [known, is_new] = tile_versions_.try_emplace(index, version_);
    if (!is_new) checksum_ -= mapping::tile_hash(index, known->second);
    known->second = version_;
    checksum_ += mapping::tile_hash(index, version_);
    updates.push_back({index, version_, std::move(*bytes)});
  }
  return updates;
}

std::vector<TileUpdate> SemanticMapper::all_tiles() const {
  std::vector<std::pair<mapping::TileIndex, std::uint64_t>> tiles(tile_versions_.begin(), tile_versions_.end());
  std::sort(tiles.begin(), tiles.end());
  std::vector<TileUpdate> updates;
  for (const auto& [index, version] : tiles)
    if (auto bytes = mapping::encode_tile(map_, index, blocks_per_tile_edge_))
      updates.push_back({index, version, std::move(*bytes)});
  return updates;
}

mapping::MapState SemanticMapper::state() const {
  return {0, version_, static_cast<std::uint32_t>(tile_versions_.size()), checksum_, config_.resolution_m};
}

}  // namespace lapis::semantic_mapper
