#include "semantic_mapper/semantic_mapper_component.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "common/mapping/wire/frame_codec.hpp"
#include "common/mapping/wire/tile_codec.hpp"
#include "common/messages/labels.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/map.hpp"
#include "common/topics/map_views.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr const char* kMapFile = "map.lapis";
constexpr const char* kOctreeFile = "map.ot";
constexpr const char* kPointsFile = "map.ply";
constexpr const char* kFramesFile = "frames.lapis";
constexpr std::size_t kFramesPerBeat = 1000;  // seconds of work while a map is rebuilt
constexpr double kFarewell_s = 1.0;
constexpr double kLongestSave_s = 300.0;
constexpr double kLongestFlush_s = 600.0;
constexpr std::size_t kWaitingFrames = 30;  // images wait here for slam's pose: one second at 30 Hz
constexpr std::size_t kWaitingInfos = 64;   // on a network they are ahead of their images by half a second more

double seconds_since(const std::optional<time::Time>& then, time::Time now) {
  return then ? (now - *then).seconds() : std::numeric_limits<double>::infinity();
}

bool has_pose(const lapis_msgs::msg::TrackedFrame& frame) {
  namespace Constants = lapis_msgs::msg::TrackedFrame_Constants;
  return frame.state() == Constants::STATE_TRACKING || frame.state() == Constants::STATE_DEAD_RECKONING;
}

/// Number in the notes of a map file; 0 when there is no such note.
std::uint64_t note(const mapping::MapFile& file, const char* key) {
  const auto found = file.provenance.find(key);
  return found == file.provenance.end() ? 0 : std::strtoull(found->second.c_str(), nullptr, 10);
}

}  // namespace

/// Without these rules no frame would enter the map, or its tiles could not be read.
config::Rules SemanticMapperComponent::rules(const Config& config) {
  const MapperConfig& map = config.map;
  constexpr int kMaxVoxelsPerTileEdge = mapping::kMaxBlocksPerTileEdge * mapping::kBlockEdge;
  return {{map.integration.min_range_m < config.robot.sensing_range_m,
           "semantic_mapper.integration.min_range_m has to be less than robot.sensing_range_m"},
          {map.integration.min_height_m < map.integration.max_height_m,
           "semantic_mapper.integration.min_height_m has to be less than semantic_mapper.integration.max_height_m"},
          {config.robot.sensing_range_m / map.resolution_m <= mapping::kMaxRangeInVoxels,
           fmt::format("robot.sensing_range_m has to be at most {} times semantic_mapper.resolution_m",
                       mapping::kMaxRangeInVoxels)},
          {map.tile_edge_m <= kMaxVoxelsPerTileEdge * map.resolution_m,
           fmt::format("semantic_mapper.tile_edge_m has to be at most {} times semantic_mapper.resolution_m",
                       kMaxVoxelsPerTileEdge)},
          {!config.keep_frames || !config.output_dir.empty(),
           "semantic_mapper.keep_frames needs semantic_mapper.output_dir"}};
}

SemanticMapperComponent::SemanticMapperComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), map_description_(context.advertise(topics::kMapDescription)),
      tiles_(context.advertise(topics::kVoxelTiles)), map_state_(context.advertise(topics::kMapState)),
      obstacles_(context.advertise(topics::kObstacles)), octomap_(context.advertise(topics::kOctomap)),
      points_(context.advertise(topics::kMapPoints)), grid_(context.advertise(topics::kOccupancyGrid)),
      provisional_(context.advertise(topics::kProvisionalArea)),
      tracked_(context, topics::kTrackedFrame, "slam frame", kWaitingFrames),
      depth_(context, topics::kDepth, "depth", kWaitingFrames),
      labels_(context, topics::kLabels, "labels", kWaitingFrames),
      confidence_(context, topics::kLabelConfidence, "label confidence", kWaitingFrames),
      info_(context, topics::kColorInfo, "camera info", kWaitingInfos),
      disk_({SemanticMapperComponent::kName,
             config.output_dir,
             config.resume_from,
             {kMapFile, kOctreeFile, kPointsFile, kFramesFile},
             config.save_period_s},
            context) {
  config_.map.integration.max_range_m = config_.robot.sensing_range_m;
  config_.map.band = {config_.robot.obstacle_min_height_m, config_.robot.obstacle_max_height_m};
  if (config_.sensor_model.fusion == "bki") {
    config_.map.integration.kernel_length_voxels = config_.kernel_length_voxels;
  }
  if (config_.map.re_anchor) {
    files::require_writable_folder(config_.map.stored_frames.spill_dir, "semantic_mapper.stored_frames.spill_dir");
  }
  load_map();
  context.subscribe(topics::kLabelInfo, [this](const auto& m) { set_labels(m); });
  context.subscribe(topics::kPoseGraph, [this](Graph& m) { graph_ = std::move(m); });
  context.serve(topics::kSaveMap, [this](const auto&) { return save_on_request(); });
  tracked_.on_clock_set([this](time::Duration step) { follow_clock(step); });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
  describe_map();
}

/// Loads the map to resume, if there is one; throws with the file and the remedy.
void SemanticMapperComponent::load_map() {
  if (is_frame_journal(config_.resume_from)) return rebuild_map();
  resumed_ = disk_.resume(mapping::load_map);
  if (!resumed_) return;
  const double resolution_m = resumed_->map.resolution_m();
  if (resolution_m != config_.map.resolution_m) {
    throw std::runtime_error(disk_.misfit("semantic_mapper.resolution_m was " + std::to_string(resolution_m) +
                                          " when it was made: set it so again"));
  }
  if ((resumed_->sensor_model.fusion == "bki") != (config_.sensor_model.fusion == "bki")) {
    throw std::runtime_error(disk_.misfit("semantic_mapper.sensor_model.fusion was " + resumed_->sensor_model.fusion +
                                          " when it was made: votes of a kernel and whole ones do not mix"));
  }
  resumed_labels_ = label_list_ = resumed_->labels;
  config_.frame.max_label = label_list_.largest_accepted_id();
  resumed_frames_ = note(*resumed_, "frames");
  const auto unlike = resumed_->frames ? mapping::difference(*resumed_->frames, frame_settings()) : "";
  if (!unlike.empty())
    spdlog::warn("{}: its frames entered it otherwise than new ones: {}", config_.resume_from, unlike);
  is_mixed_ = !resumed_->frames || !unlike.empty();
  spdlog::info("{}: {} frames, {} blocks", config_.resume_from, resumed_frames_, resumed_->map.block_count());
}

/// Integrates the frames of a mapper of this session once more; throws with the file and the remedy.
void SemanticMapperComponent::rebuild_map() {
  rebuilt_ = std::make_unique<SemanticMapper>(config_.map);
  const auto restore = [this](const FrameRecord& record, mapping::CompactFrame samples) {
    is_mixed_ |= samples.stride() != config_.frame.stride;
    if (rebuilt_->frames_integrated() % kFramesPerBeat == 0) context_.heart().beat();
    return rebuilt_->restore(record, std::move(samples));
  };
  rebuilt_from_ = disk_.resume(
      [&](const std::string& path, std::string& error) { return read_frame_journal(path, restore, error); });
  spdlog::info("rebuilt {} frames from {}", rebuilt_from_->frames, config_.resume_from);
  if (rebuilt_from_->dropped == 0) return;
  spdlog::warn("{}: {} bytes after the last whole frame are not used", config_.resume_from, rebuilt_from_->dropped);
}

void SemanticMapperComponent::set_labels(const vision_msgs::msg::LabelInfo& message) {
  auto labels = messages::from_message(message);
  if (!labels) {
    context_.status().count("label lists refused: " + labels.reason);
    spdlog::warn("label list refused: {}", labels.reason);
    return;
  }
  try {
    label_list_ = mapping::LabelList::united(*labels, resumed_labels_);
  } catch (const std::runtime_error& error) {  // one id must mean one class in all counts
    throw runtime::BadSetup("semantic_mapper.resume_from: " + config_.resume_from + " and " + topics::kLabelInfo.name +
                            ": " + error.what());
  }
  config_.frame.max_label = label_list_.largest_accepted_id();
}

mapping::FrameSettings SemanticMapperComponent::frame_settings() const {
  return {config_.map.integration, config_.frame.stride};
}

/// Publishes the description of the map when it differs from the one published last: at the start, and later only in
/// cycles, before the tiles that need it, so that in lock-step each description is published in a defined tick. Throws
/// std::runtime_error that names what is not allowed.
void SemanticMapperComponent::describe_map() {
  mapping::MapDescription now;
  now.resolution_m = config_.map.resolution_m;
  now.frames = frame_settings();
  now.sensor_model = mapping::with_classes(config_.sensor_model, label_list_);
  now.labels = label_list_;
  now.epoch = epoch_;
  now.session = session_;
  if (described_ == now) return;
  mapping::validate(now);
  map_description_.publish(messages::to_message(now, header(published_stamp_)));
  described_ = std::move(now);
}

void SemanticMapperComponent::work(const runtime::Cycle& cycle) {
  while (next_frame(cycle)) {
  }
  describe_map();
  if (mapper_ == nullptr) return;
  if (graph_) follow_graph(*graph_);
  graph_.reset();
  if (cycle.is_final) {
    flush();
  } else {
    mapper_->re_anchor(static_cast<std::size_t>(config_.re_anchor_work_per_cycle));
  }
  report_drift();
  publish(cycle.is_final);
}

/// Joins and integrates the oldest tracked frame; false when its partners may still come.
bool SemanticMapperComponent::next_frame(const runtime::Cycle& cycle) {
  using time::Match;
  if (tracked_.empty()) return false;
  const auto tolerance = time::Duration::from_seconds(config_.max_stamp_difference_s);
  auto& [stamp, tracked] = tracked_.front();
  const time::Time now = stamp;
  Image* depth = nullptr;
  Image* labels = nullptr;
  Image* confidence = nullptr;
  Info* info = nullptr;
  // Labels are optional: a slow segmentation costs frames their labels, but does not cost the map its frames.
  const bool is_last_chance = cycle.inputs_complete || tracked_.is_full();
  const bool no_labels_come = is_last_chance || !labels_.has_publisher();
  const bool no_confidence_comes = is_last_chance || !confidence_.has_publisher();
  const auto depth_match = depth_.match(now, tolerance, cycle.inputs_complete, depth);
  const auto label_match = labels_.match(now, tolerance, no_labels_come, labels);
  const auto confidence_match = confidence_.match(now, tolerance, no_confidence_comes, confidence);
  const auto info_match = info_.match(now, tolerance, cycle.inputs_complete, info);
  for (const Match match : {depth_match, label_match, confidence_match, info_match}) {
    if (match == Match::kWait) return false;
  }
  published_stamp_ = now;
  if (!has_pose(tracked)) {
    drop("slam has no pose");
  } else if (depth == nullptr) {
    drop("no depth image for a tracked frame");
  } else if (info == nullptr) {
    drop("no camera info for a tracked frame");
  } else {
    integrate(tracked, *depth, labels, confidence, *info);
  }
  tracked_.drop_until(now);
  depth_.drop_until(now - tolerance);
  labels_.drop_until(now - tolerance);
  confidence_.drop_until(now - tolerance);
  info_.drop_until(now - tolerance);
  return true;
}

void SemanticMapperComponent::integrate(const Tracked& tracked, const Image& depth, const Image* labels,
                                        const Image* confidence, const Info& info) {
  const time::Time stamp = messages::from_message(tracked.header().stamp());
  const bool is_first = mapper_ == nullptr || tracked.session() != session_;
  if (!is_first && (stamp - stamp_).seconds() < config_.frame_interval_s) return;
  auto frame = to_core(depth, labels, confidence, info, config_.frame);
  if (!frame) return drop(frame.reason);
  const auto above_list = frame->labels_out_of_list();
  if (above_list > 0) context_.status().count("pixels unlabelled: label not in the list", above_list);
  auto anchored = to_core(tracked, std::move(*frame));
  if (!anchored) return drop(anchored.reason);
  if (is_first) start_new_map(tracked.session(), stamp);
  const auto& before = mapper_->newest_record();
  if (is_first && before && before->stamp == stamp) {
    stamp_ = stamp;  // a rebuilt map has the frame: in lock-step, the tick in which its process died comes again
    return;
  }
  const auto packed = journal_ && !config_.map.re_anchor ? mapping::pack(anchored->frame) : std::vector<std::uint8_t>{};
  const auto report = mapper_->integrate(std::move(*anchored));
  switch (report.status) {
    case IntegrationStatus::kIntegrated: break;
    case IntegrationStatus::kInvalidPose: return drop("pose is not valid");
    case IntegrationStatus::kTooFarAway: return drop("pose is more than 10 km from the map's origin");
    case IntegrationStatus::kMapIsFull: return drop("map is full");
  }
  if (journal_)
    keep_newest_frame(config_.map.re_anchor ? mapper_->store().packed_frame(mapper_->store().size() - 1) : packed);
  stamp_ = stamp;
  obstacle_layer_->add(stamp - clock_steps_, report.votes);
  ++frames_integrated_;
  context_.status().value("frames", frames_integrated_);
  context_.status().value("stored_frames_mb", std::to_string(mapper_->frame_bytes() >> 20));
  report_store(mapper_->store());
}

/// Appends the newest frame to the journal; the status reports a failure until a later frame is kept.
void SemanticMapperComponent::keep_newest_frame(const std::optional<std::vector<std::uint8_t>>& packed) {
  auto problem = packed ? journal_->append(*mapper_->newest_record(), *packed)
                        : std::optional("semantic_mapper.stored_frames: " + mapper_->store().problem());
  if (!problem && !keep_problem_) return;
  keep_problem_ = std::move(problem);
  report_disk();
  if (!keep_problem_) return;
  context_.status().count("frames not kept: disk");
  if (context_.rate_limit().pass("journal")) spdlog::error("frame not kept: {}; mapping continues", *keep_problem_);
}

/// Reports frames that are not whole in the map, because odometry alone gave their poses.
void SemanticMapperComponent::report_drift() {
  context_.status().value("frames_waiting", static_cast<std::uint64_t>(mapper_->frames_waiting()));
  context_.status().value("frames_in_part", static_cast<std::uint64_t>(mapper_->frames_in_part()));
}

void SemanticMapperComponent::report_store(const FrameStore& store) {
  context_.status().value("spilled_frames_mb", std::to_string(store.disk_bytes() >> 20));
  if (store.let_go() == 0) return;
  context_.status().value("frames_that_cannot_move", static_cast<std::uint64_t>(store.let_go()));
  if (context_.rate_limit().pass("store")) {
    spdlog::warn("{} frames stay in the map where they are: {}; see semantic_mapper.stored_frames", store.let_go(),
                 store.problem());
  }
}

void SemanticMapperComponent::log_drift() const {
  if (mapper_->frames_waiting() + mapper_->frames_in_part() == 0) return;
  spdlog::warn("{} frames at poses by odometry alone wait for a correction, {} more stay in the map in part",
               mapper_->frames_waiting(), mapper_->frames_in_part());
}

void SemanticMapperComponent::drop(const std::string& reason) {
  ++frames_dropped_;
  context_.status().count("frames dropped: " + reason);
  if (context_.rate_limit().pass(reason)) spdlog::warn("frame dropped: {}", reason);
}

/// From here on, the map contains nothing from an earlier run.
void SemanticMapperComponent::forget_resumed() {
  resumed_labels_ = {};
  resumed_frames_ = 0;
  is_mixed_ = false;
}

/// Ends the map of a session of slam, and saves it where maps are kept on disk.
void SemanticMapperComponent::end_map() {
  if (mapper_ == nullptr) return;
  spdlog::warn("slam began a new map; so does the mapper");
  log_drift();
  if (disk_.is_kept()) {
    if (const auto problem = save()) spdlog::error("map not saved: {}; mapping continues", *problem);
  }
  mapper_.reset();
  journal_.reset();
  forget_resumed();
}

/// Continues when the stamps of frames have jumped; whether the map is still right is for slam to say. The step is
/// known to the jitter of delays only, and time must not go back.
void SemanticMapperComponent::follow_clock(time::Duration step) {
  const time::Time first = tracked_.front().first;
  for (auto* images : {&depth_, &labels_, &confidence_}) images->expect_restart(first);
  info_.expect_restart(first);
  step = std::min(step, first - stamp_);
  clock_steps_ = {clock_steps_.nanoseconds + step.nanoseconds};
  stamp_ = stamp_ + step;
  for (auto* stamp : {&tiles_stamp_, &views_stamp_, &obstacles_stamp_, &provisional_stamp_}) {
    if (*stamp) *stamp = **stamp + step;
  }
  disk_.note_save(stamp_);
}

/// The first map of the process resumes the saved one, if there is one that fits.
std::unique_ptr<SemanticMapper> SemanticMapperComponent::begin_map(std::int64_t session) {
  const bool is_other_map =
      resumed_ && !config_.resume_any_session && session != static_cast<std::int64_t>(note(*resumed_, "session"));
  if (is_other_map || (rebuilt_from_ && session != rebuilt_from_->session)) {
    spdlog::warn("{} is of another session of slam; a new map begins", config_.resume_from);
    resumed_.reset();
    rebuilt_from_.reset();
    rebuilt_.reset();
    forget_resumed();
  }
  if (rebuilt_from_) {
    frames_integrated_ += rebuilt_from_->frames;
    return std::move(rebuilt_);
  }
  if (!resumed_) return std::make_unique<SemanticMapper>(config_.map);
  if (session < static_cast<std::int64_t>(note(*resumed_, "session"))) {
    throw runtime::BadSetup("semantic_mapper.resume_from: " + config_.resume_from +
                            " belongs to a later session of slam; give slam.resume_from the slam.lapis of that run");
  }
  return std::make_unique<SemanticMapper>(config_.map, std::move(resumed_->map));
}

/// Keeps the frames of the map that begins, in the file that it was rebuilt from if that is the one of this process. A
/// map with the counts of an earlier run cannot be rebuilt from its new frames, so none are kept: it is resumed from
/// map.lapis.
void SemanticMapperComponent::begin_journal(std::int64_t session) {
  if (!config_.keep_frames) return;
  const std::string file = disk_.path(kFramesFile);
  if (resumed_) {
    spdlog::warn("{} holds counts without frames, so no frames are kept", config_.resume_from);
    if (const auto problem = files::set_aside(file)) spdlog::error(*problem);
    return;
  }
  std::error_code error;
  const bool continues = rebuilt_from_ && std::filesystem::equivalent(file, config_.resume_from, error);
  journal_.emplace(file, session, continues ? rebuilt_from_->end : 0);
}

void SemanticMapperComponent::start_new_map(std::int64_t session, time::Time stamp) {
  end_map();
  mapper_ = begin_map(session);
  disk_.begin(stamp, resumed_ || rebuilt_from_);
  begin_journal(session);
  session_ = session;
  if (rebuilt_from_ && graph_) follow_graph(*graph_);  // as the earlier process had done
  resumed_.reset();
  rebuilt_from_.reset();
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
void SemanticMapperComponent::begin_epoch(time::Time stamp) {
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

void SemanticMapperComponent::follow_graph(const Graph& graph) {
  if (graph.session() == session_) mapper_->update_keyframe_poses(graph.version(), to_core(graph));
}

void SemanticMapperComponent::publish(bool is_final) {
  if (is_final || seconds_since(tiles_stamp_, stamp_) >= config_.tile_period_s) publish_tiles();
  if (seconds_since(obstacles_stamp_, published_stamp_) >= config_.obstacle_period_s) publish_obstacles();
  if (is_final || seconds_since(provisional_stamp_, published_stamp_) >= config_.view_period_s)
    publish_provisional_area();
  publish_views(is_final || seconds_since(views_stamp_, stamp_) >= config_.view_period_s);
  if (!disk_.is_due(stamp_)) return;
  disk_.note_save(stamp_);
  if (const auto problem = save()) spdlog::error("map not saved: {}; mapping continues", *problem);
}

void SemanticMapperComponent::publish_tiles() {
  tiles_stamp_ = stamp_;
  if (!mapper_->has_changes()) return;
  if (mapper_->enlarge_tiles()) {
    begin_epoch(stamp_);
    describe_map();
    spdlog::info("large map: tiles of {} m from now on", mapper_->tile_edge_m());
  }
  floor_plan_->mark_changed(mapper_->changed_blocks());
  for (const auto& tile : mapper_->take_changed_tiles()) {
    published_tiles_.emplace(tile.index.x, tile.index.y, tile.index.z);
    tiles_.publish(to_message(tile, epoch_));
  }
  if (mapper_->tiles_too_large() > 0) {
    context_.status().value("tiles_too_large", static_cast<std::uint64_t>(mapper_->tiles_too_large()));
    if (context_.rate_limit().pass("tile")) {
      spdlog::warn("{} tiles are over 1 MiB and were not published; lower semantic_mapper.tile_edge_m",
                   mapper_->tiles_too_large());
    }
  }
  const auto state = mapper_->state();
  lapis_msgs::msg::MapState message;
  message.header(header(stamp_));
  message.epoch(epoch_);
  message.version(state.version);
  message.session(session_);
  message.graph_version(mapper_->graph_version());
  message.resolution_m(state.resolution_m);
  message.tile_edge_m(mapper_->tile_edge_m());
  message.tiles(state.tiles);
  message.checksum(state.checksum);
  message.frames_integrated(frames_integrated_);
  message.frames_dropped(frames_dropped_);
  message.frames_off(mapper_->frames_far_off());
  map_state_.publish(message);
}

/// Also for frames that could not be integrated, because the robot has to find its way back to where slam tracks.
void SemanticMapperComponent::publish_obstacles() {
  obstacles_stamp_ = published_stamp_;
  obstacles_.publish(to_message(obstacle_layer_->grid(), header(published_stamp_)));
}

/// Publishes the area when it has changed, also when a new map begins, in which no frame waits.
void SemanticMapperComponent::publish_provisional_area() {
  provisional_stamp_ = published_stamp_;
  if (provisional_changes_ == mapper_->provisional_changes()) return;
  provisional_changes_ = mapper_->provisional_changes();
  OccupancyGrid area = mapper_->provisional_area();
  if (area == provisional_area_) return;
  provisional_.publish(to_message(area, header(published_stamp_)));
  provisional_area_ = std::move(area);
}

/// True when a view has a reader and is due, or when a reader has come since the last call.
bool SemanticMapperComponent::wants_view(const dds::Writer& writer, bool is_due) {
  const bool has_new_reader = std::exchange(seen_matches_[&writer], writer.total_matches()) != writer.total_matches();
  return writer.matched() > 0 && (is_due || has_new_reader);
}

void SemanticMapperComponent::publish_views(bool is_due) {
  if (is_due) views_stamp_ = stamp_;
  const bool wants_octomap = wants_view(octomap_, is_due);
  const bool wants_points = wants_view(points_, is_due);
  const bool wants_grid = wants_view(grid_, is_due);
  if (!wants_octomap && !wants_points && !wants_grid) return;
  publish_tiles();  // so that all outputs show one version
  const auto reader = belief_reader();
  const auto& map = mapper_->map();
  if (wants_octomap) {
    octomap_.publish(to_message(encode_octree(map, reader, label_list_), map.resolution_m(), header(stamp_)));
  }
  if (wants_points) points_.publish(to_message(occupied_points(map, reader, label_list_), header(stamp_)));
  if (wants_grid) grid_.publish(to_message(floor_plan_->project(map, reader), header(stamp_)));
}

std_srvs::srv::Trigger_Response SemanticMapperComponent::save_on_request() {
  std_srvs::srv::Trigger_Response response;
  response.success(false);
  if (!disk_.is_kept()) {
    response.message("semantic_mapper.output_dir is not set");
  } else if (mapper_ == nullptr) {
    response.message("there is no map yet");
  } else {
    flush();
    const auto problem = save();
    response.success(!problem);
    response.message(problem ? *problem : "map saved in " + config_.output_dir);
  }
  return response;
}

/// Moves all frames to the poses of the present pose graph.
void SemanticMapperComponent::flush() {
  const runtime::LongWork work(context_.heart(), "moves frames to corrected poses", kLongestFlush_s);
  mapper_->flush();
}

/// Saves the map as it is, without moving frames to corrected poses first, which may take long. Returns nothing, or why
/// it could not be saved; the status reports this until a later save succeeds.
std::optional<std::string> SemanticMapperComponent::save() {
  save_problem_ = write_files();
  report_disk();
  return save_problem_;
}

void SemanticMapperComponent::report_disk() {
  using Level = runtime::Status::Level;
  if (save_problem_) return context_.status().set(Level::kError, "map not saved: " + *save_problem_);
  if (keep_problem_) return context_.status().set(Level::kError, "frame not kept: " + *keep_problem_);
  context_.status().set(Level::kOk, "mapping");
}

std::optional<std::string> SemanticMapperComponent::write_files() {
  const runtime::LongWork work(context_.heart(), "saves the map", kLongestSave_s);
  const auto reader = belief_reader();
  const mapping::MapFile file{mapper_->map(),
                              reader.model(),
                              label_list_,
                              {{"frames", std::to_string(resumed_frames_ + mapper_->frames_integrated())},
                               {"graph_version", std::to_string(mapper_->graph_version())},
                               {"session", std::to_string(session_)}},
                              is_mixed_ ? std::nullopt : std::optional(frame_settings())};
  if (auto problem = mapping::save_map(disk_.path(kMapFile), file)) return problem;
  const auto tree = encode_octree(file.map, reader, label_list_);
  if (auto problem = files::replace_file(disk_.path(kOctreeFile), tree.file)) return problem;
  const auto ply = encode_ply(occupied_points(file.map, reader, label_list_));
  return files::replace_file(disk_.path(kPointsFile), ply);
}

void SemanticMapperComponent::finish() {
  spdlog::info("{} frames integrated, {} dropped", frames_integrated_, frames_dropped_);
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (mapper_ == nullptr) return;
  if (graph_) follow_graph(*graph_);
  flush();
  log_drift();
  publish_provisional_area();
  publish_tiles();
  for (dds::Writer* writer : std::initializer_list<dds::Writer*>{&map_description_, &tiles_, &map_state_}) {
    writer->wait_until_acknowledged(kFarewell_s);
  }
  if (!disk_.is_kept()) return;
  if (const auto problem = save()) throw std::runtime_error(*problem);
  if (journal_) journal_->remove();  // nobody has to rebuild a map that is whole
}

mapping::BeliefReader SemanticMapperComponent::belief_reader() const {
  return mapping::BeliefReader(mapping::with_classes(config_.sensor_model, label_list_));
}

std_msgs::msg::Header SemanticMapperComponent::header(time::Time stamp) const {
  std_msgs::msg::Header h;
  h.stamp(messages::to_message(stamp));
  h.frame_id(context_.frame("map"));
  return h;
}

}  // namespace lapis::semantic_mapper

template int lapis::runtime::run_component<lapis::semantic_mapper::SemanticMapperComponent>(int argc, char** argv);
