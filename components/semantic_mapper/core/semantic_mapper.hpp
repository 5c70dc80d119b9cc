#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/mapping/file/map_description.hpp"
#include "common/mapping/model/column_projection.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "common/mapping/votes/compact_frame.hpp"
#include "common/mapping/votes/integration.hpp"
#include "common/mapping/wire/map_mirror.hpp"
#include "common/mapping/wire/tile_codec.hpp"
#include "common/time/time.hpp"
#include "semantic_mapper/core/frame_store.hpp"
#include "semantic_mapper/core/map_stakes.hpp"
#include "semantic_mapper/core/provisional_area.hpp"

namespace lapis::semantic_mapper {

struct MapperConfig {
  double resolution_m = mapping::kDefaultResolution_m;  ///< edge of a voxel
  double tile_edge_m = mapping::kDefaultTileEdge_m;     ///< least edge of a tile; see enlarge_tiles
  mapping::IntegrationConfig integration;
  /// A frame is moved when a point at its median depth is off by more than this [voxels], in [0, 10].
  double re_anchor_threshold_voxels = 0.2;
  /// False: frames stay where they were first put (the paper's frozen map) and are not stored.
  bool re_anchor = true;
  FrameStoreConfig stored_frames;
  mapping::HeightBand band = {};  ///< of the provisional area
  /// Sensor model by which stakes() decides what is occupied; nothing: no stakes are kept.
  std::optional<mapping::SensorModel> stakes_model = std::nullopt;
};

/// A camera frame and where it was taken: T_map_camera = T_map_keyframe * T_keyframe_camera. The pose graph may move
/// the first factor at any time; the second never changes.
struct AnchoredFrame {
  time::Time stamp;
  std::uint64_t keyframe_id = 0;
  geometry::Pose T_map_keyframe = geometry::Pose::Identity();
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();
  std::uint64_t graph_version = 0;  ///< of T_map_keyframe
  mapping::CompactFrame frame;
  mapping::Drift drift = {};
  bool is_keyframe = false;  ///< it is its own reference
};

struct KeyframePose {
  std::uint64_t id = 0;
  geometry::Pose T_map_keyframe = geometry::Pose::Identity();
  bool is_drifting = false;  ///< odometry alone connects it, and nothing has corrected it since
};

/// How a frame entered a map. With its samples, it can enter another one in the same way (SemanticMapper::restore).
struct FrameRecord {
  time::Time stamp;
  std::uint64_t keyframe_id = 0;
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();
  geometry::Pose T_map_keyframe = geometry::Pose::Identity();  ///< as the map had it
  std::uint64_t known_since = 0;                               ///< version of the graph that has the key-frame
  std::uint64_t previous_id = 0;  ///< newest older key-frame that the map had; the key-frame itself if it had none
  geometry::Pose T_map_previous = geometry::Pose::Identity();  ///< as the map had it then
  std::uint64_t graph_version = 0;                             ///< newest one that the map had followed
  mapping::Drift drift = {};
  bool is_keyframe = false;  ///< it is its own reference
  bool is_held = false;      ///< the key-frame was known not to drift
};

/// A frame in the map; FrameStore has its samples and votes.
struct StoredFrame {
  time::Time stamp;
  std::uint64_t keyframe_id = 0;
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();
  geometry::Pose T_map_camera = geometry::Pose::Identity();  ///< at which its votes are in the map now
  double median_depth_m = 0.0;
  std::size_t work = 0;       ///< cost of moving it: number of its samples and votes
  mapping::Drift drift = {};  ///< drift that its votes in the map now allow for
};

struct TileUpdate {
  mapping::TileIndex index;
  std::uint64_t version = 0;
  std::vector<std::uint8_t> bytes;  ///< encoded as in tile_codec.hpp
};

enum class IntegrationStatus {
  kIntegrated,
  kInvalidPose,  ///< a pose is not finite or not rigid
  kTooFarAway,   ///< a pose is more than 10 km from its origin
  kMapIsFull     ///< 2^24 - 1 frames: one more could overflow a count
};

struct IntegrationReport {
  IntegrationStatus status = IntegrationStatus::kIntegrated;
  mapping::FrameVotes votes;  ///< of the whole frame at its pose; those of a frame with drift are not all in the map
};

/// Semantic map that follows the pose graph. Every integrated frame is kept in compact form, with the pose at which it
/// is in the map and the votes that it has there (unless MapperConfig::re_anchor is false). When the graph moves its
/// key-frame, the difference between these votes and those at the new pose is put into the map. At any instant the map
/// equals, bit for bit, one built from the stored frames at their recorded poses, plus the map that it began with.
///
/// Of a frame with drift, only what its drift allows enters the map (integration.hpp). When its key-frame drifts, too,
/// the rest waits, and enters at the corrected pose as soon as the graph reports that the key-frame does not drift any
/// more. On any other key-frame nothing will ever correct the frame, and it stays in the map in part.
class SemanticMapper {
 public:
  /// Throws std::runtime_error that names the value that is out of range.
  explicit SemanticMapper(const MapperConfig& config);
  /// Resumes the map of an earlier run. Its frames are not known any more, so its counts stay where they are. Throws,
  /// too, when its voxels are not of config.resolution_m.
  SemanticMapper(const MapperConfig& config, mapping::VoxelMap base);

  /// What integrate() would report of the frame now, if it had no drift; the map stays as it is. Labels only decide
  /// what the hits of the votes are for, so a frame without them gives the same misses, and hits in the same voxels.
  IntegrationReport look(const AnchoredFrame& input) const;
  /// Puts a frame into the map at its key-frame's newest known pose.
  IntegrationReport integrate(AnchoredFrame input);
  /// How the newest frame entered the map; nothing before the first.
  const std::optional<FrameRecord>& newest_record() const { return newest_; }
  /// Puts a frame into the map as it entered the map of another mapper with the same configuration; the records of that
  /// mapper have to come in order. After the same pose graph and flush() the two maps are equal, as long as the graph
  /// lists the key-frames and takes no correction back. False when integrate refuses the frame.
  bool restore(const FrameRecord& record, mapping::CompactFrame samples);
  /// Newest poses of the graph, and which of them drift; older versions are ignored. Does not move frames yet.
  ///
  /// Key-frames of later versions keep their poses. Others that are not listed were lost when slam resumed an older
  /// save of its map: each of them follows, as if it were fixed to it, the newest older key-frame that is listed and
  /// was known before. It stays when there is none, and has its own pose again once it is listed.
  void update_keyframe_poses(std::uint64_t graph_version, std::span<const KeyframePose> poses);
  /// True when the key-frame is known not to drift; until the graph reports it, only its own frame can tell.
  bool is_held(std::uint64_t keyframe_id) const;
  /// Moves frames that are off by more than the threshold or were corrected while they waited, nearest to the newest
  /// frame first, until their StoredFrame::work reaches `max_work` (at least one); returns how many. Frames that are
  /// off by less than a voxel wait when, over time, moving such frames would cost more than 3/4 of the work of
  /// integrating new ones, because bundle adjustment may correct their key-frames again and again.
  std::size_t re_anchor(std::size_t max_work);
  /// Moves every frame that is off at all or was corrected while it waited: afterwards the map equals one built at the
  /// graph's poses. Returns how many.
  std::size_t flush();
  /// Number of frames that re_anchor has yet to move.
  std::size_t frames_off() const { return off_.size(); }
  /// Number of frames that are in the map in part, and will be integrated whole once they are corrected.
  std::size_t frames_waiting() const { return provisional_.size(); }
  /// Number of frames with drift that stay in the map in part for good.
  std::size_t frames_in_part() const { return frames_in_part_; }
  /// Where the waiting frames have looked.
  OccupancyGrid provisional_area() const { return provisional_.grid(); }
  /// Grows with every change of that area.
  std::uint64_t provisional_changes() const { return provisional_.changes(); }

  const mapping::VoxelMap& map() const { return map_; }
  /// How much of the map depends on which key-frame, also by frames that stay where they were first put; null unless
  /// MapperConfig::stakes_model is set.
  const MapStakes* stakes();
  /// Samples of a stored frame; nothing when it was let go (FrameStore).
  std::optional<mapping::CompactFrame> stored_frame(std::size_t index) { return store_.frame(index); }
  const FrameStore& store() const { return store_; }
  const std::vector<StoredFrame>& frames() const { return frames_; }
  /// Number of frames that integrate has accepted, stored or not.
  std::size_t frames_integrated() const { return frames_integrated_; }
  const MapperConfig& config() const { return config_; }
  std::uint64_t graph_version() const { return graph_version_; }
  /// Number of frames that re_anchor() has yet to move and that are off by more than a voxel at this graph version, or
  /// were corrected while they waited.
  std::uint64_t frames_far_off() const;
  /// Memory of the stored frames [bytes].
  std::size_t frame_bytes() const { return store_.memory_bytes() + frames_.size() * sizeof(StoredFrame); }

  bool has_changes() const { return !changed_tiles_.empty(); }
  /// Blocks of the tiles that the next take_changed_tiles will look at, in any order.
  std::vector<mapping::BlockIndex> changed_blocks() const;
  /// Doubles the edge of the tiles while there are too many for a late joiner: the cost of reliable samples grows with
  /// the square of their number (docs/decisions/0029-late-joiners.md). When it returns true, all tiles are new ones and
  /// will be published again: the caller has to begin a new epoch.
  bool enlarge_tiles();
  /// Present edge of the tiles [m]; at least config().tile_edge_m.
  double tile_edge_m() const { return blocks_per_tile_edge_ * mapping::kBlockEdge * config_.resolution_m; }
  /// Makes a new version of what changed since the last call, and returns its tiles in canonical order. Without changes
  /// the version stays, and nothing is returned.
  std::vector<TileUpdate> take_changed_tiles();
  /// All tiles of the current version.
  std::vector<TileUpdate> all_tiles() const;
  /// State of the version that take_changed_tiles made last; the caller sets its epoch.
  mapping::MapState state() const;
  std::uint64_t version() const { return version_; }
  /// Number of tiles since the start that could not be encoded within mapping::kMaxTileBytes.
  std::size_t tiles_too_large() const { return tiles_too_large_; }

 private:
  /// A key-frame that the graph has lost, and the older one that it follows.
  struct Orphan {
    std::uint64_t anchor = 0;
    geometry::Pose T_anchor_orphan = geometry::Pose::Identity();
  };

  IntegrationStatus status_of(const AnchoredFrame& frame) const;
  bool brings_newer_keyframe(const AnchoredFrame& frame) const;
  mapping::FrameVotes votes_of(const mapping::CompactFrame& samples, const geometry::Pose& T_map_camera,
                               const mapping::Drift& drift = {}) const;
  void store(StoredFrame frame, const mapping::CompactFrame& samples, const mapping::FrameVotes& votes);
  FrameRecord record_of(const AnchoredFrame& frame) const;
  void keep_rest(std::uint64_t keyframe_id, const mapping::FrameVotes& whole);
  void apply(const KeyframePose& pose);
  void find_orphans(std::span<const KeyframePose> poses);
  void move_orphans();
  void set_drifting(std::uint64_t keyframe_id, bool is_drifting);
  bool move_frame(std::size_t index);
  void move_keyframe(std::uint64_t id, const geometry::Pose& T_map_keyframe);
  geometry::Pose wanted_pose(const StoredFrame& frame) const;
  double offset_voxels(const StoredFrame& frame, const geometry::Pose& T_map_camera) const;
  bool is_far_off(std::size_t index) const;
  void mark_changed(const mapping::FrameVotes& votes);
  void mark_all_changed();

  MapperConfig config_;
  int blocks_per_tile_edge_;
  mapping::VoxelMap map_;
  std::size_t frames_before_ = 0;  ///< least number of frames that can have given the initial map its counts
  std::size_t frames_integrated_ = 0;
  std::optional<FrameRecord> newest_;
  std::vector<StoredFrame> frames_;  ///< in order of integration
  FrameStore store_;
  std::int64_t credit_ = 0;  ///< work for moves of less than a voxel: 3/4 of what was integrated, less what they took
  Eigen::Vector3d p_map_robot_ = Eigen::Vector3d::Zero();  ///< camera of the newest frame

  std::uint64_t graph_version_ = 0;
  std::map<std::uint64_t, geometry::Pose> keyframe_poses_;
  std::unordered_map<std::uint64_t, std::uint64_t> known_since_;  ///< of the same key-frames: a version that has it
  std::map<std::uint64_t, Orphan> orphans_;  ///< by id: an anchor that is lost as well moves before what follows it
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> frames_of_keyframe_;
  std::set<std::size_t> off_;  ///< frames beyond the threshold, and corrected ones

  std::unordered_map<std::uint64_t, bool> is_drifting_;                  ///< of key-frames, as far as it is known
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> waiting_;  ///< frames, by key-frames that drift
  std::unordered_set<std::size_t> corrected_;  ///< frames that have waited and can be integrated whole
  ProvisionalArea provisional_;                ///< of the frames in waiting_ and corrected_
  std::optional<MapStakes> stakes_;
  std::size_t frames_in_part_ = 0;

  std::unordered_set<mapping::TileIndex, mapping::GridIndexHash> changed_tiles_;
  std::unordered_map<mapping::TileIndex, std::uint64_t, mapping::GridIndexHash> tile_versions_;
  std::uint64_t version_ = 0;
  std::uint64_t checksum_ = 0;
  std::size_t tiles_too_large_ = 0;
};

}  // namespace lapis::semantic_mapper
