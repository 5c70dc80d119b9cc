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
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr const char* kMapFile = "map.lapis";
constexpr const char* kOctreeFile = "map.ot";
constexpr const char* kPointsFile = "map.ply";
constexpr const char* kFramesFile = "frames.lapis";
constexpr std::size_t kFramesPerBeat = 1000;  // seconds of work while a map is rebuilt
constexpr double kLongestSave_s = 300.0;
constexpr double kLongestFlush_s = 600.0;
constexpr std::size_t kPlacedPerCycle = 5;    // frames of a sub-map that was joined; each takes milliseconds
constexpr std::size_t kUnconnectedShare = 4;  // of the memory for stored frames, a fourth for those of sub-maps

bool is_unconnected(const lapis_msgs::msg::TrackedFrame& frame) {
  return frame.state() == lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED;
}

/// With what other sections say of the map.
SemanticMapperComponentConfig completed(SemanticMapperComponentConfig config) {
  config.map.integration.max_range_m = config.robot.sensing_range_m;
  config.map.band = {config.robot.obstacle_min_height_m, config.robot.obstacle_max_height_m};
  if (config.sensor_model.fusion == "bki") config.map.integration.kernel_length_voxels = config.kernel_length_voxels;
  return config;
}

/// Why a frame did not enter the map; empty when it did.
std::string fault_of(IntegrationStatus status) {
  switch (status) {
    case IntegrationStatus::kIntegrated: break;
    case IntegrationStatus::kInvalidPose: return "pose is not valid";
    case IntegrationStatus::kTooFarAway: return "pose is more than 10 km from the map's origin";
    case IntegrationStatus::kMapIsFull: return "map is full";
  }
  return "";
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
    : config_(completed(config)), context_(context), publisher_(config_, context),
      input_(config_, context, [this](const std::string& reason) { drop(reason); }),
      disk_({SemanticMapperComponent::kName,
             config.output_dir,
             config.resume_from,
             {kMapFile, kOctreeFile, kPointsFile, kFramesFile},
             config.save_period_s},
            context),
      unconnected_((static_cast<std::size_t>(config.map.stored_frames.memory_mb) << 20) / kUnconnectedShare) {
  if (config_.map.re_anchor) {
    files::require_writable_folder(config_.map.stored_frames.spill_dir, "semantic_mapper.stored_frames.spill_dir");
  }
  load_map();
  context.subscribe(topics::kLabelInfo, [this](const auto& m) { set_labels(m); });
  context.subscribe(topics::kPoseGraph, [this](Graph& m) { graph_ = std::move(m); });
  context.serve(topics::kSaveMap, [this](const auto&) { return save_on_request(); });
  input_.on_clock_set([this](time::Duration step, time::Time first) { follow_clock(step, first); });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
  publisher_.describe(label_list_, progress_);
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
  const auto unlike = resumed_->frames ? mapping::difference(*resumed_->frames, frame_settings(config_)) : "";
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

void SemanticMapperComponent::work(const runtime::Cycle& cycle) {
  input_.collect(cycle);
  take_frames(cycle.inputs_complete);
  for (SeenFrame& seen : input_.waiting()) see_obstacles(seen);
  progress_.published = input_.published();
  publisher_.describe(label_list_, progress_);
  if (mapper_ == nullptr) return;
  if (graph_) follow_graph(*graph_);
  graph_.reset();
  enter_placed_frames(cycle.is_final ? unconnected_.size() : kPlacedPerCycle);
  if (cycle.is_final) {
    flush();
  } else {
    mapper_->re_anchor(static_cast<std::size_t>(config_.re_anchor_work_per_cycle));
  }
  report_drift();
  publisher_.publish(*mapper_, label_list_, progress_, cycle.is_final);
  save_when_due();
}

void SemanticMapperComponent::take_frames(bool is_last_chance) {
  while (auto seen = input_.take(is_last_chance)) integrate(std::move(*seen));
}

bool SemanticMapperComponent::is_of_other_map(const Tracked& tracked) const {
  return mapper_ == nullptr || tracked.session() != progress_.session;
}

void SemanticMapperComponent::integrate(SeenFrame seen) {
  if (is_unconnected(seen.tracked)) return keep_unconnected(seen.tracked, std::move(seen.samples));
  auto anchored = to_core(seen.tracked, std::move(seen.samples));
  if (!anchored) return drop(anchored.reason);
  if (is_of_other_map(seen.tracked)) start_new_map(seen.tracked.session(), seen.stamp);
  const auto& record = mapper_->newest_record();
  if (record && record->stamp == seen.stamp) {  // a rebuilt map has it: in lock-step, the tick in which its process
    progress_.newest = seen.stamp;              // died comes again
    return;
  }
  const auto report = enter(std::move(*anchored));
  if (report && !seen.is_in_obstacles) publisher_.add_obstacles(seen.stamp, report->votes);
}

/// Obstacles need no labels, so those of a frame that waits for its labels are seen at once, as they will be in its
/// votes.
void SemanticMapperComponent::see_obstacles(SeenFrame& seen) {
  if (seen.is_in_obstacles || is_unconnected(seen.tracked)) return;
  const auto anchored = to_core(seen.tracked, seen.samples);
  if (!anchored) return;  // reported when its labels are there
  if (is_of_other_map(seen.tracked)) start_new_map(seen.tracked.session(), seen.stamp);
  const auto report = mapper_->look(*anchored);
  if (report.status != IntegrationStatus::kIntegrated) return;
  publisher_.add_obstacles(seen.stamp, report.votes);
  seen.is_in_obstacles = true;
}

/// Puts a frame into the map, and into the journal; nothing when it is dropped.
std::optional<IntegrationReport> SemanticMapperComponent::enter(AnchoredFrame frame) {
  const time::Time stamp = frame.stamp;
  const auto packed = journal_ && !config_.map.re_anchor ? mapping::pack(frame.frame) : std::vector<std::uint8_t>{};
  auto report = mapper_->integrate(std::move(frame));
  if (const std::string fault = fault_of(report.status); !fault.empty()) {
    drop(fault);
    return std::nullopt;
  }
  if (journal_)
    keep_newest_frame(config_.map.re_anchor ? mapper_->store().packed_frame(mapper_->store().size() - 1) : packed);
  progress_.newest = std::max(progress_.newest, stamp);
  ++progress_.frames_integrated;
  context_.status().value("frames", progress_.frames_integrated);
  context_.status().value("stored_frames_mb", std::to_string(mapper_->frame_bytes() >> 20));
  report_store(mapper_->store());
  return report;
}

/// Nobody knows yet where in the map the frame is.
void SemanticMapperComponent::keep_unconnected(const Tracked& tracked, mapping::CompactFrame frame) {
  if (is_of_other_map(tracked)) return drop("slam has no pose");
  auto unconnected = to_unconnected(tracked, std::move(frame));
  if (!unconnected) return drop(unconnected.reason);
  const std::size_t before = unconnected_.let_go();
  unconnected_.add(*unconnected);
  const std::size_t let_go = unconnected_.let_go() - before;
  if (let_go > 0) context_.status().count("frames dropped: too many wait for their place in the map", let_go);
}

/// Frames of sub-maps that slam has joined to the map, the oldest first.
void SemanticMapperComponent::enter_placed_frames(std::size_t most) {
  for (std::size_t i = 0; i < most; ++i) {
    auto frame = unconnected_.take_placed();
    if (!frame) return;
    enter(std::move(*frame));
  }
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
  context_.status().value("frames_unconnected", static_cast<std::uint64_t>(unconnected_.size()));
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
  if (unconnected_.size() > 0)
    spdlog::warn("{} frames are not in the map: slam does not know where they are", unconnected_.size());
  if (mapper_->frames_waiting() + mapper_->frames_in_part() == 0) return;
  spdlog::warn("{} frames at poses by odometry alone wait for a correction, {} more stay in the map in part",
               mapper_->frames_waiting(), mapper_->frames_in_part());
}

void SemanticMapperComponent::drop(const std::string& reason) {
  ++progress_.frames_dropped;
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
  unconnected_.clear();
  journal_.reset();
  forget_resumed();
}

/// Continues when the stamps of frames have jumped; whether the map is still right is for slam to say. The step is
/// known to the jitter of delays only, and time must not go back.
void SemanticMapperComponent::follow_clock(time::Duration step, time::Time first) {
  take_frames(true);  // by the stamps of before
  step = std::min(step, first - progress_.newest);
  progress_.newest = progress_.newest + step;
  publisher_.follow_clock(step);
  disk_.note_save(progress_.newest);
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
    progress_.frames_integrated += rebuilt_from_->frames;
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
  progress_.session = session;
  progress_.newest = stamp;
  if (rebuilt_from_ && graph_) follow_graph(*graph_);  // as the earlier process had done
  resumed_.reset();
  rebuilt_from_.reset();
  publisher_.begin_map(stamp);
}

void SemanticMapperComponent::follow_graph(const Graph& graph) {
  if (graph.session() != progress_.session) return;
  const auto poses = to_core(graph);
  mapper_->update_keyframe_poses(graph.version(), poses);
  unconnected_.place(graph.version(), poses);
}

void SemanticMapperComponent::save_when_due() {
  if (!disk_.is_due(progress_.newest)) return;
  disk_.note_save(progress_.newest);
  if (const auto problem = save()) spdlog::error("map not saved: {}; mapping continues", *problem);
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
  const auto reader = belief_reader(config_, label_list_);
  const mapping::MapFile file{mapper_->map(),
                              reader.model(),
                              label_list_,
                              {{"frames", std::to_string(resumed_frames_ + mapper_->frames_integrated())},
                               {"graph_version", std::to_string(mapper_->graph_version())},
                               {"session", std::to_string(progress_.session)}},
                              is_mixed_ ? std::nullopt : std::optional(frame_settings(config_))};
  if (auto problem = mapping::save_map(disk_.path(kMapFile), file)) return problem;
  const auto tree = encode_octree(file.map, reader, label_list_);
  if (auto problem = files::replace_file(disk_.path(kOctreeFile), tree.file)) return problem;
  const auto ply = encode_ply(occupied_points(file.map, reader, label_list_));
  return files::replace_file(disk_.path(kPointsFile), ply);
}

void SemanticMapperComponent::reconfigure(const Config& config) {
  config_.tile_period_s = config.tile_period_s;
  config_.view_period_s = config.view_period_s;
  config_.obstacle_period_s = config.obstacle_period_s;
}

void SemanticMapperComponent::finish() {
  take_frames(true);
  spdlog::info("{} frames integrated, {} dropped", progress_.frames_integrated, progress_.frames_dropped);
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (mapper_ == nullptr) return;
  if (graph_) follow_graph(*graph_);
  enter_placed_frames(unconnected_.size());
  flush();
  log_drift();
  publisher_.finish(*mapper_, label_list_, progress_);
  if (!disk_.is_kept()) return;
  if (const auto problem = save()) throw std::runtime_error(*problem);
  if (journal_) journal_->remove();  // nobody has to rebuild a map that is whole
}

}  // namespace lapis::semantic_mapper

template int lapis::runtime::run_component<lapis::semantic_mapper::SemanticMapperComponent>(int argc, char** argv);
