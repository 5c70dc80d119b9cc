#include "semantic_mapper/map_publisher.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <utility>

#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/topics/map.hpp"
#include "common/topics/map_views.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr double kFarewell_s = 1.0;

double seconds_since(const std::optional<time::Time>& then, time::Time now) {
  return then ? (now - *then).seconds() : std::numeric_limits<double>::infinity();
}

}  // namespace

MapPublisher::MapPublisher(const SemanticMapperComponentConfig& config, runtime::Context& context)
    : config_(config), context_(context), description_(context.advertise(topics::kMapDescription)),
      tiles_(context.advertise(topics::kVoxelTiles)), state_(context.advertise(topics::kMapState)),
      obstacles_(context.advertise(topics::kObstacles)), octomap_(context.advertise(topics::kOctomap)),
      points_(context.advertise(topics::kMapPoints)), grid_(context.advertise(topics::kOccupancyGrid)),
      provisional_(context.advertise(topics::kProvisionalArea)) {}

void MapPublisher::describe(const mapping::LabelList& labels, const MapProgress& progress) {
  mapping::MapDescription now;
  now.resolution_m = config_.map.resolution_m;
  now.frames = frame_settings(config_);
  now.sensor_model = mapping::with_classes(config_.sensor_model, labels);
  now.labels = labels;
  now.epoch = epoch_;
  now.session = progress.session;
  if (described_ == now) return;
  mapping::validate(now);
  description_.publish(messages::to_message(now, header(progress.published)));
  described_ = std::move(now);
}

void MapPublisher::begin_map(time::Time stamp) {
  floor_plan_.emplace(config_.map.band);
  obstacle_layer_.emplace(config_.obstacles, config_.map.band, config_.map.resolution_m);
  begin_epoch(stamp);
  tiles_stamp_.reset();
  views_stamp_.reset();
  obstacles_stamp_.reset();
  provisional_stamp_.reset();
  provisional_changes_.reset();
}

/// Ends all tiles published so far.
void MapPublisher::begin_epoch(time::Time stamp) {
  for (const auto& [x, y, z] : published_tiles_) {
    lapis_msgs::msg::VoxelTile tile;
    tile.x(x);
    tile.y(y);
    tile.z(z);
    tiles_.end_key(tile);
  }
  published_tiles_.clear();
  epoch_ = std::max(stamp.nanoseconds, epoch_ + 1);
}

void MapPublisher::add_obstacles(time::Time stamp, const mapping::FrameVotes& votes) {
  obstacle_layer_->add(stamp - clock_steps_, votes);
}

void MapPublisher::follow_clock(time::Duration step) {
  clock_steps_ = {clock_steps_.nanoseconds + step.nanoseconds};
  for (auto* stamp : {&tiles_stamp_, &views_stamp_, &obstacles_stamp_, &provisional_stamp_}) {
    if (*stamp) *stamp = **stamp + step;
  }
}

void MapPublisher::publish(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress,
                           bool is_final) {
  const auto is_due = [is_final](const auto& then, time::Time now, double period_s) {
    return is_final || seconds_since(then, now) >= period_s;
  };
  if (is_due(tiles_stamp_, progress.newest, config_.tile_period_s)) publish_tiles(mapper, labels, progress);
  if (seconds_since(obstacles_stamp_, progress.published) >= config_.obstacle_period_s) publish_obstacles(progress);
  if (is_due(provisional_stamp_, progress.published, config_.view_period_s)) publish_provisional_area(mapper, progress);
  publish_views(mapper, labels, progress, is_due(views_stamp_, progress.newest, config_.view_period_s));
}

void MapPublisher::finish(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress) {
  publish_provisional_area(mapper, progress);
  publish_tiles(mapper, labels, progress);
  for (dds::Writer* writer : std::initializer_list<dds::Writer*>{&description_, &tiles_, &state_}) {
    writer->wait_until_acknowledged(kFarewell_s);
  }
}

void MapPublisher::publish_tiles(SemanticMapper& mapper, const mapping::LabelList& labels,
                                 const MapProgress& progress) {
  tiles_stamp_ = progress.newest;
  if (!mapper.has_changes()) return;
  if (mapper.enlarge_tiles()) {
    begin_epoch(progress.newest);
    describe(labels, progress);
    spdlog::info("large map: tiles of {} m from now on", mapper.tile_edge_m());
  }
  floor_plan_->mark_changed(mapper.changed_blocks());
  for (const auto& tile : mapper.take_changed_tiles()) {
    published_tiles_.emplace(tile.index.x, tile.index.y, tile.index.z);
    tiles_.publish(to_message(tile, epoch_));
  }
  if (mapper.tiles_too_large() > 0) {
    context_.status().value("tiles_too_large", static_cast<std::uint64_t>(mapper.tiles_too_large()));
    if (context_.rate_limit().pass("tile")) {
      spdlog::warn("{} tiles are over 1 MiB and were not published; lower semantic_mapper.tile_edge_m",
                   mapper.tiles_too_large());
    }
  }
  publish_state(mapper, progress);
}

void MapPublisher::publish_state(const SemanticMapper& mapper, const MapProgress& progress) {
  const auto state = mapper.state();
  lapis_msgs::msg::MapState message;
  message.header(header(progress.newest));
  message.epoch(epoch_);
  message.version(state.version);
  message.session(progress.session);
  message.graph_version(mapper.graph_version());
  message.resolution_m(state.resolution_m);
  message.tile_edge_m(mapper.tile_edge_m());
  message.tiles(state.tiles);
  message.checksum(state.checksum);
  message.frames_integrated(progress.frames_integrated);
  message.frames_dropped(progress.frames_dropped);
  message.frames_off(mapper.frames_far_off());
  state_.publish(message);
}

/// Also for frames that could not be integrated, because the robot has to find its way back to where slam tracks.
void MapPublisher::publish_obstacles(const MapProgress& progress) {
  obstacles_stamp_ = progress.published;
  obstacles_.publish(to_message(obstacle_layer_->grid(), header(progress.published)));
}

/// Publishes the area when it has changed, also when a new map begins, in which no frame waits.
void MapPublisher::publish_provisional_area(SemanticMapper& mapper, const MapProgress& progress) {
  provisional_stamp_ = progress.published;
  if (provisional_changes_ == mapper.provisional_changes()) return;
  provisional_changes_ = mapper.provisional_changes();
  OccupancyGrid area = mapper.provisional_area();
  if (area == provisional_area_) return;
  provisional_.publish(to_message(area, header(progress.published)));
  provisional_area_ = std::move(area);
}

/// True when a view has a reader and is due, or when a reader has come since the last call.
bool MapPublisher::wants_view(const dds::Writer& writer, bool is_due) {
  const bool has_new_reader = std::exchange(seen_matches_[&writer], writer.total_matches()) != writer.total_matches();
  return writer.matched() > 0 && (is_due || has_new_reader);
}

void MapPublisher::publish_views(SemanticMapper& mapper, const mapping::LabelList& labels, const MapProgress& progress,
                                 bool is_due) {
  if (is_due) views_stamp_ = progress.newest;
  const bool wants_octomap = wants_view(octomap_, is_due);
  const bool wants_points = wants_view(points_, is_due);
  const bool wants_grid = wants_view(grid_, is_due);
  if (!wants_octomap && !wants_points && !wants_grid) return;
  publish_tiles(mapper, labels, progress);  // so that all outputs show one version
  const auto reader = belief_reader(config_, labels);
  const auto& map = mapper.map();
  const auto newest = header(progress.newest);
  if (wants_octomap) octomap_.publish(to_message(encode_octree(map, reader, labels), map.resolution_m(), newest));
  if (wants_points) points_.publish(to_message(occupied_points(map, reader, labels), newest));
  if (wants_grid) grid_.publish(to_message(floor_plan_->project(map, reader), newest));
}

std_msgs::msg::Header MapPublisher::header(time::Time stamp) const {
  std_msgs::msg::Header header;
  header.stamp(messages::to_message(stamp));
  header.frame_id(context_.frame("map"));
  return header;
}

}  // namespace lapis::semantic_mapper
