#include "semantic_mapper/core/semantic_mapper.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;

/// Largest number of frames for which a voxel's 32-bit counts of 1/256 votes cannot overflow.
constexpr std::size_t kMaxFrames = (std::size_t{1} << 24) - 1;
/// Keeps voxel indices far inside 32 bits at any resolution.
constexpr double kMaxDistance_m = 10'000.0;
/// With an edge of 0.8 m (voxels of 0.1 m) these cover 1,000 m3, with 2 m (0.25 m) 16,000 m3.
constexpr std::size_t kMaxTiles = 2000;
/// 512 blocks, for each of which mapping::kMaxTileBytes leaves 2 kB; a block full of surfaces takes 1.5 kB.
constexpr int kMaxBlocksPerEnlargedEdge = 8;

bool is_near(const Pose& T_map_a) { return T_map_a.translation().norm() <= kMaxDistance_m; }

/// Position of the key-frame in the map at which the frame's votes were put into it.
Eigen::Vector3d position_of_keyframe(const StoredFrame& frame) {
  return frame.T_map_camera * frame.T_keyframe_camera.inverse().translation();
}

bool is_equal(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }

const MapperConfig& validated(const MapperConfig& config) {
  mapping::validate(config.integration);
  if (config.integration.max_range_m / config.resolution_m > mapping::kMaxRangeInVoxels)
    throw std::runtime_error("mapper: integration.max_range_m exceeds 500 voxels; lower it or raise resolution_m");
  if (!(config.re_anchor_threshold_voxels >= 0.0 && config.re_anchor_threshold_voxels <= 10.0))
    throw std::runtime_error("mapper: re_anchor_threshold_voxels must be in [0, 10]");
  if (!(config.tile_edge_m >= 0.1 && config.tile_edge_m <= 6.4))
    throw std::runtime_error("mapper: tile_edge_m must be in [0.1, 6.4]");
  if (config.stored_frames.memory_mb < 0) throw std::runtime_error("mapper: stored_frames.memory_mb must be positive");
  return config;
}

/// Largest count of one kind in any voxel, in whole votes, rounded up.
std::size_t most_votes(const mapping::VoxelMap& map) {
  std::uint32_t most = 0;
  map.for_each_observed([&most](const mapping::VoxelIndex&, const mapping::VoxelCounts& counts) {
    most = std::max(most, counts.misses);
    for (const mapping::ClassCount& hit : counts.hits) most = std::max(most, hit.count);
  });
  return (most + mapping::kOneVote - 1) / mapping::kOneVote;
}

}  // namespace

SemanticMapper::SemanticMapper(const MapperConfig& config)
    : SemanticMapper(config, mapping::VoxelMap(config.resolution_m)) {}

SemanticMapper::SemanticMapper(const MapperConfig& config, mapping::VoxelMap base)
    : config_(validated(config)),
      blocks_per_tile_edge_(mapping::blocks_per_tile_edge(config.resolution_m, config.tile_edge_m)),
      map_(std::move(base)), frames_before_(most_votes(map_)), store_(config.stored_frames),
      provisional_(config.band, config.resolution_m) {
  if (map_.resolution_m() != config.resolution_m)
    throw std::runtime_error("mapper: the map to resume has voxels of another size");
  if (config.stakes_model) stakes_.emplace(*config.stakes_model, config.resolution_m);
  mark_all_changed();
}

const MapStakes* SemanticMapper::stakes() {
  if (!stakes_) return nullptr;
  stakes_->update(map_);
  return &*stakes_;
}

IntegrationStatus SemanticMapper::status_of(const AnchoredFrame& frame) const {
  if (!geometry::is_valid(frame.T_map_keyframe) || !geometry::is_valid(frame.T_keyframe_camera))
    return IntegrationStatus::kInvalidPose;
  if (!is_near(frame.T_map_keyframe) || !is_near(frame.T_keyframe_camera)) return IntegrationStatus::kTooFarAway;
  const bool is_full = frames_before_ + frames_integrated_ >= kMaxFrames;
  return is_full ? IntegrationStatus::kMapIsFull : IntegrationStatus::kIntegrated;
}

bool SemanticMapper::brings_newer_keyframe(const AnchoredFrame& frame) const {
  return frame.graph_version >= graph_version_ || !keyframe_poses_.contains(frame.keyframe_id);
}

IntegrationReport SemanticMapper::look(const AnchoredFrame& input) const {
  const auto status = status_of(input);
  if (status != IntegrationStatus::kIntegrated) return {status, {}};
  const Pose& T_map_keyframe =
      brings_newer_keyframe(input) ? input.T_map_keyframe : keyframe_poses_.at(input.keyframe_id);
  return {status, votes_of(input.frame, T_map_keyframe * input.T_keyframe_camera)};
}

IntegrationReport SemanticMapper::integrate(AnchoredFrame input) {
  const auto status = status_of(input);
  if (status != IntegrationStatus::kIntegrated) return {status, {}};
  const bool is_known = keyframe_poses_.contains(input.keyframe_id);
  if (brings_newer_keyframe(input)) move_keyframe(input.keyframe_id, input.T_map_keyframe);
  known_since_.try_emplace(input.keyframe_id, input.graph_version);
  // The graph reports this, too, but later.
  if (!is_known && input.is_keyframe) is_drifting_[input.keyframe_id] = !input.drift.is_none();

  StoredFrame stored{input.stamp, input.keyframe_id, input.T_keyframe_camera, Pose::Identity()};
  stored.T_map_camera = wanted_pose(stored);
  stored.median_depth_m = input.frame.median_depth_m();
  stored.drift = input.drift;
  const Pose T_map_camera = stored.T_map_camera;
  mapping::FrameVotes votes = votes_of(input.frame, T_map_camera, input.drift);
  map_.add(votes);
  mark_changed(votes);
  if (stakes_) stakes_->add(stored.keyframe_id, position_of_keyframe(stored), votes);
  p_map_robot_ = T_map_camera.translation();
  ++frames_integrated_;
  newest_ = record_of(input);
  if (config_.re_anchor) store(std::move(stored), input.frame, votes);
  if (input.drift.is_none()) return {IntegrationStatus::kIntegrated, std::move(votes)};
  mapping::FrameVotes whole = votes_of(input.frame, T_map_camera);
  if (votes != whole) keep_rest(input.keyframe_id, whole);
  return {IntegrationStatus::kIntegrated, std::move(whole)};
}

FrameRecord SemanticMapper::record_of(const AnchoredFrame& frame) const {
  const auto keyframe = keyframe_poses_.find(frame.keyframe_id);
  const auto previous = keyframe == keyframe_poses_.begin() ? keyframe : std::prev(keyframe);
  return {frame.stamp,
          keyframe->first,
          frame.T_keyframe_camera,
          keyframe->second,
          known_since_.at(keyframe->first),
          previous->first,
          previous->second,
          graph_version_,
          frame.drift,
          frame.is_keyframe,
          is_held(keyframe->first)};
}

bool SemanticMapper::restore(const FrameRecord& record, mapping::CompactFrame samples) {
  graph_version_ = std::max(graph_version_, record.graph_version);
  // Both are poses of one instant, so that what lies between them is known should the graph have lost the key-frame.
  if (record.previous_id != record.keyframe_id) move_keyframe(record.previous_id, record.T_map_previous);
  known_since_.try_emplace(record.previous_id, record.known_since);
  known_since_.try_emplace(record.keyframe_id, record.known_since);
  apply({record.keyframe_id, record.T_map_keyframe, !record.is_held});
  const IntegrationReport report =
      integrate({record.stamp, record.keyframe_id, record.T_map_keyframe, record.T_keyframe_camera, graph_version_,
                 std::move(samples), record.drift, record.is_keyframe});
  return report.status == IntegrationStatus::kIntegrated;
}

mapping::FrameVotes SemanticMapper::votes_of(const mapping::CompactFrame& samples, const Pose& T_map_camera,
                                             const mapping::Drift& drift) const {
  return mapping::compute_votes(samples, T_map_camera, config_.integration, config_.resolution_m, drift);
}

/// Keeps what is missing of the newest frame, which is in the map in part.
void SemanticMapper::keep_rest(std::uint64_t keyframe_id, const mapping::FrameVotes& whole) {
  const std::size_t index = frames_.size() - 1;
  if (!config_.re_anchor || !store_.has(index) || is_held(keyframe_id)) {
    ++frames_in_part_;
    return;
  }
  waiting_[keyframe_id].push_back(index);
  provisional_.set(index, whole);
}

void SemanticMapper::store(StoredFrame frame, const mapping::CompactFrame& samples, const mapping::FrameVotes& votes) {
  frame.work = samples.samples() + votes.hit_count() + votes.miss_count();
  credit_ += static_cast<std::int64_t>(frame.work * 3 / 4);
  store_.add(samples, votes);
  frames_of_keyframe_[frame.keyframe_id].push_back(frames_.size());
  frames_.push_back(std::move(frame));
}

void SemanticMapper::update_keyframe_poses(std::uint64_t graph_version, std::span<const KeyframePose> poses) {
  if (graph_version < graph_version_) return;
  graph_version_ = graph_version;
  find_orphans(poses);
  for (const KeyframePose& pose : poses) apply(pose);
  move_orphans();
}

void SemanticMapper::apply(const KeyframePose& pose) {
  if (!geometry::is_valid(pose.T_map_keyframe) || !is_near(pose.T_map_keyframe)) return;
  move_keyframe(pose.id, pose.T_map_keyframe);
  known_since_.try_emplace(pose.id, graph_version_);
  set_drifting(pose.id, pose.is_drifting);
}

/// Compares the known key-frames with those of a graph that is not applied yet.
void SemanticMapper::find_orphans(std::span<const KeyframePose> poses) {
  std::vector<std::uint64_t> listed;
  listed.reserve(poses.size());
  for (const KeyframePose& pose : poses) listed.push_back(pose.id);
  if (!std::is_sorted(listed.begin(), listed.end())) std::sort(listed.begin(), listed.end());
  const auto is_listed = [&](const auto& orphan) {
    return std::binary_search(listed.begin(), listed.end(), orphan.first);
  };
  std::erase_if(orphans_, is_listed);
  for (const auto& [id, T_map_keyframe] : keyframe_poses_) {
    const auto next = std::lower_bound(listed.begin(), listed.end(), id);
    const bool is_listed_too = next != listed.end() && *next == id;
    if (is_listed_too || known_since_.at(id) > graph_version_ || orphans_.contains(id)) continue;
    const auto anchor = std::find_if(std::make_reverse_iterator(next), listed.rend(),
                                     [&](std::uint64_t older) { return keyframe_poses_.contains(older); });
    if (anchor == listed.rend()) continue;
    orphans_[id] = {*anchor, keyframe_poses_.at(*anchor).inverse() * T_map_keyframe};
  }
}

void SemanticMapper::move_orphans() {
  for (const auto& [id, orphan] : orphans_) {
    const Pose T_map_orphan = keyframe_poses_.at(orphan.anchor) * orphan.T_anchor_orphan;
    if (is_near(T_map_orphan)) move_keyframe(id, T_map_orphan);
  }
}

bool SemanticMapper::is_held(std::uint64_t keyframe_id) const {
  const auto known = is_drifting_.find(keyframe_id);
  return known != is_drifting_.end() && !known->second;
}

void SemanticMapper::set_drifting(std::uint64_t keyframe_id, bool is_drifting) {
  is_drifting_[keyframe_id] = is_drifting;
  if (is_drifting) return;
  const auto waiting = waiting_.extract(keyframe_id);
  if (waiting.empty()) return;
  corrected_.insert(waiting.mapped().begin(), waiting.mapped().end());
  off_.insert(waiting.mapped().begin(), waiting.mapped().end());
}

void SemanticMapper::move_keyframe(std::uint64_t id, const Pose& T_map_keyframe) {
  const auto [known, is_new] = keyframe_poses_.try_emplace(id, T_map_keyframe);
  if (is_new || is_equal(known->second, T_map_keyframe)) return;
  known->second = T_map_keyframe;
  const auto anchored = frames_of_keyframe_.find(id);
  if (anchored == frames_of_keyframe_.end()) return;
  for (const std::size_t index : anchored->second) {
    const bool is_far = offset_voxels(frames_[index], wanted_pose(frames_[index])) > config_.re_anchor_threshold_voxels;
    if (is_far || corrected_.contains(index))
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

bool SemanticMapper::is_far_off(std::size_t index) const {
  return corrected_.contains(index) || offset_voxels(frames_[index], wanted_pose(frames_[index])) > 1.0;
}

std::uint64_t SemanticMapper::frames_far_off() const {
  return static_cast<std::uint64_t>(
      std::count_if(off_.begin(), off_.end(), [&](std::size_t index) { return is_far_off(index); }));
}

/// False when the frame was let go; its votes then stay where they are.
bool SemanticMapper::move_frame(std::size_t index) {
  const bool is_whole_now = corrected_.erase(index) > 0;
  if (is_whole_now) provisional_.erase(index);
  const auto samples = store_.has(index) ? store_.frame(index) : std::nullopt;
  auto gone = samples ? store_.votes(index) : std::nullopt;
  if (!gone) {
    if (is_whole_now) ++frames_in_part_;  // what the map lacks of it went with its samples
    return false;
  }
  const Pose wanted = wanted_pose(frames_[index]);
  const mapping::Drift drift = is_whole_now ? mapping::Drift{} : frames_[index].drift;
  mapping::FrameVotes come = votes_of(*samples, wanted, drift);
  if (!store_.replace_votes(index, come)) return false;
  if (stakes_) stakes_->subtract(frames_[index].keyframe_id, position_of_keyframe(frames_[index]), *gone);
  frames_[index].T_map_camera = wanted;
  if (stakes_) stakes_->add(frames_[index].keyframe_id, position_of_keyframe(frames_[index]), come);
  frames_[index].drift = drift;
  frames_[index].work = samples->samples() + come.hit_count() + come.miss_count();
  if (provisional_.contains(index)) provisional_.set(index, votes_of(*samples, wanted));
  mapping::drop_common(*gone, come);
  map_.subtract(*gone);
  map_.add(come);
  mark_changed(*gone);
  mark_changed(come);
  return true;
}

std::size_t SemanticMapper::re_anchor(std::size_t max_work) {
  using Candidate = std::pair<double, std::size_t>;  // squared distance from the robot [m2], index
  std::vector<Candidate> nearest;
  for (const std::size_t index : off_)
    nearest.emplace_back((wanted_pose(frames_[index]).translation() - p_map_robot_).squaredNorm(), index);
  std::make_heap(nearest.begin(), nearest.end(), std::greater<>());
  std::size_t moved = 0, work = 0;
  while (!nearest.empty() && work < max_work) {
    std::pop_heap(nearest.begin(), nearest.end(), std::greater<>());
    const std::size_t index = nearest.back().second;
    nearest.pop_back();
    if (!is_far_off(index)) {
      if (credit_ <= 0) continue;
      credit_ -= static_cast<std::int64_t>(frames_[index].work);
    }
    off_.erase(index);
    work += frames_[index].work;
    moved += move_frame(index) ? 1 : 0;
  }
  return moved;
}

std::size_t SemanticMapper::flush() {
  std::size_t moved = 0;
  for (std::size_t index = 0; index < frames_.size(); ++index)
    if (corrected_.contains(index) || !is_equal(wanted_pose(frames_[index]), frames_[index].T_map_camera))
      moved += move_frame(index) ? 1 : 0;
  off_.clear();
  return moved;
}

void SemanticMapper::mark_changed(const mapping::FrameVotes& votes) {
  for (const mapping::BlockVotes& block : votes.blocks)
    changed_tiles_.insert(mapping::tile_of(block.block, blocks_per_tile_edge_));
}

void SemanticMapper::mark_all_changed() {
  for (const mapping::BlockIndex& block : map_.sorted_blocks())
    changed_tiles_.insert(mapping::tile_of(block, blocks_per_tile_edge_));
}

bool SemanticMapper::enlarge_tiles() {
  const int before = blocks_per_tile_edge_;
  std::size_t tiles = std::max(tile_versions_.size(), changed_tiles_.size());
  while (tiles > kMaxTiles && 2 * blocks_per_tile_edge_ <= kMaxBlocksPerEnlargedEdge) {
    blocks_per_tile_edge_ *= 2;
    changed_tiles_.clear();
    mark_all_changed();
    tiles = changed_tiles_.size();
  }
  if (blocks_per_tile_edge_ == before) return false;
  tile_versions_.clear();
  checksum_ = 0;
  return true;
}

std::vector<mapping::BlockIndex> SemanticMapper::changed_blocks() const {
  std::vector<mapping::BlockIndex> blocks;
  for (const mapping::TileIndex& tile : changed_tiles_) {
    const auto of_tile = mapping::blocks_of(tile, blocks_per_tile_edge_);
    blocks.insert(blocks.end(), of_tile.begin(), of_tile.end());
  }
  return blocks;
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
