#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>

#include "common/runtime/context.hpp"
#include "idl/lapis_msgs.hpp"
#include "slam/core/map/landmark_tiles.hpp"
#include "slam/core/map/published_ids.hpp"

namespace lapis::slam {

/// Publishes the landmarks version by version: first the tiles that changed, a part with each frame, so that no frame
/// takes long and no socket buffer overflows; then the state that announces the version.
class LandmarkPublisher {
 public:
  /// `period_s`: least time between two versions, by the frames' stamps.
  LandmarkPublisher(runtime::Context& context, double period_s);

  /// Begins with the landmarks of a map, all of which are published in a new epoch; `ids` are those of its key-frames.
  /// The tiles that were published before end.
  void begin_epoch(std::int64_t session, std::int64_t epoch, const PublishedIds& ids);
  /// True when `graph_version` is new, the previous version is out, and the period is over or no frames follow.
  bool wants(std::uint64_t graph_version, time::Time stamp, bool is_final) const;
  /// The clock of the frames was set, so no time since the last version is known.
  void forget_stamps();
  /// Begins a version: finds the tiles that differ from those of the previous version.
  void begin_version(const Map& map, std::uint64_t graph_version, const std_msgs::msg::Header& header);
  /// Publishes the part that belongs to the frame with this stamp; a second call with the same stamp does nothing.
  void publish_part(time::Time stamp);
  /// Publishes all that is left of the version.
  void publish_rest();
  bool wait_until_acknowledged(double timeout_s);

 private:
  void publish_next_tile();
  void publish_state();

  runtime::Context& context_;
  dds::Publisher<lapis_msgs::msg::LandmarkTile>& tiles_;
  dds::Publisher<lapis_msgs::msg::LandmarkState>& state_;
  double period_s_;

  std::int64_t session_ = 0;
  std::int64_t epoch_ = 0;
  PublishedIds ids_;
  LandmarkTiles landmarks_{LandmarkTileConfig{}};
  std::set<mapping::TileIndex> published_;  // in this epoch
  std::optional<time::Time> version_stamp_;
  std::uint64_t graph_version_ = 0;         // of the version begun last
  std_msgs::msg::Header header_;            // of that version
  std::deque<mapping::LandmarkTile> left_;  // tiles of it that are still to be published
  bool is_announced_ = true;                // its state is out
  std::optional<time::Time> part_stamp_;
};

}  // namespace lapis::slam
