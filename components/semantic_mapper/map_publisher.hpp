#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "common/mapping/file/map_description.hpp"
#include "common/runtime/context.hpp"
#include "semantic_mapper/conversions.hpp"
#include "semantic_mapper/core/floor_plan.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
#include "semantic_mapper/semantic_mapper_config.hpp"

namespace lapis::semantic_mapper {

/// How far a map has come.
struct MapProgress {
  std::int64_t session = 0;
  time::Time newest;     ///< stamp of the newest frame in the map
  time::Time published;  ///< stamp of the newest frame that slam published
  std::uint64_t frames_integrated = 0;
  std::uint64_t frames_dropped = 0;
};

/// Publishes description, tiles and state, obstacles and provisional area of a map, and views of it while they have
/// readers, each at its own period; one map after the other.
class MapPublisher {
 public:
  /// `config` is completed with what the robot's section says, and outlives the publisher.
  MapPublisher(const SemanticMapperComponentConfig& config, runtime::Context& context);

  /// Publishes the description of the map when it differs from the one published last: at the start, and later only in
  /// cycles, before the tiles that need it, so that in lock-step each description is published in a defined tick.
  /// Throws std::runtime_error that names what is not allowed.
  void describe(const mapping::LabelList& labels, const MapProgress& progress);
  /// A new map begins, whose first frame has this stamp.
  void begin_map(time::Time stamp);
  /// Adds the votes of the newest frame.
  void add_obstacles(time::Time stamp, const mapping::FrameVotes& votes);
  /// The stamps of frames have jumped by this step.
  void follow_clock(time::Duration step);
  /// Publishes what is due, with `is_final` everything but obstacles.
  void publish(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress, bool is_final);
  /// Publishes the last changes of a map, and waits a moment until readers have them.
  void finish(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress);

 private:
  void begin_epoch(time::Time stamp);
  void publish_tiles(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress);
  void publish_state(const SemanticMapper& mapper, const MapProgress& progress);
  void publish_obstacles(const MapProgress& progress);
  void publish_provisional_area(SemanticMapper& mapper, const MapProgress& progress);
  void publish_views(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress,
                     bool is_due);
  bool wants_view(const dds::Writer& writer, bool is_due);
  std_msgs::msg::Header header(time::Time stamp) const;

  const SemanticMapperComponentConfig& config_;
  runtime::Context& context_;
  dds::Publisher<lapis_msgs::msg::MapDescription>& description_;
  dds::Publisher<lapis_msgs::msg::VoxelTile>& tiles_;
  dds::Publisher<lapis_msgs::msg::MapState>& state_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& obstacles_;
  dds::Publisher<octomap_msgs::msg::Octomap>& octomap_;
  dds::Publisher<sensor_msgs::msg::PointCloud2>& points_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& grid_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& provisional_;

  std::optional<FloorPlan> floor_plan_;  // of the map
  std::optional<ObstacleLayer> obstacle_layer_;
  std::int64_t epoch_ = 0;
  std::optional<mapping::MapDescription> described_;  // published last
  std::optional<time::Time> tiles_stamp_;             // published last
  std::optional<time::Time> views_stamp_;
  std::optional<time::Time> obstacles_stamp_;
  std::optional<time::Time> provisional_stamp_;
  time::Duration clock_steps_;                           // sum of the steps by which the clock of the frames was set
  OccupancyGrid provisional_area_;                       // published last
  std::optional<std::uint64_t> provisional_changes_;     // count of changes at the last look
  std::set<std::tuple<int, int, int>> published_tiles_;  // of this epoch
  std::map<const dds::Writer*, std::uint64_t> seen_matches_;
};

}  // namespace lapis::semantic_mapper
