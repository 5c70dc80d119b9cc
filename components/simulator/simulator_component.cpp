#include "simulator/simulator_component.hpp"

#include <CLI/CLI.hpp>

#include <spdlog/fmt/fmt.h>

#include "common/files/atomic_file.hpp"
#include "common/messages/exploration_state.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/time/stamp_buffer.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/services.hpp"
#include "common/topics/transforms.hpp"
#include "simulator/core/truth/truth_files.hpp"
#include "simulator/run_files.hpp"
#include "simulator/set_up.hpp"
#include "simulator/tools.hpp"

namespace lapis::simulator {
namespace {

constexpr double kProgressPeriod_s = 2.0;
constexpr double kLongestLoading_s = 900.0;  // a large scan whose light has to be baked
constexpr double kLongestTruth_s = 900.0;
constexpr double kHurriedTruth_s = 3.0;
constexpr std::chrono::milliseconds kHurryPeriod(50);
constexpr std::chrono::milliseconds kMatchingPeriod(50);

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

World load_world(const SimulatorConfig& config, runtime::Context& context) {
  const runtime::LongWork work(context.heart(), "loads the scene", kLongestLoading_s);
  return open_world(config);
}

void describe_scene(const World& world) {
  const Scene& scene = world.scene();
  spdlog::info("scene {}: {} triangles, {} instances, {} rooms", scene.name, scene.mesh.triangles.size(),
               scene.instances.size(), scene.rooms.size());
  for (const auto& warning : scene.warnings) spdlog::warn("scene {}: {}", scene.name, warning);
}

}  // namespace

void SimulatorComponent::add_options(CLI::App& app, Config& config) {
  app.add_option(
      "scene", config.scene,
      "name of a bundled scene, KIND_SEED of a generated building, or a scene file or folder (docs/scenes.md)");
  app.add_option("--seed", config.seed, "seed of start pose, noise, systematic errors, label confusion and jitter");
  app.add_option("--tour", config.tour,
                 "tour that the robot drives by itself: \"bundled\" (of the scene) or a file with waypoints");
  app.add_option("--duration", config.duration_s, "simulated time after which the run ends; 0: no limit [s]");
  app.add_option("--mode", config.mode,
                 "lockstep: all participants answer a frame before the next one; freerun: wall-clock time");
  app.add_flag("--validate", config.validate,
               "check the scene, print the results as a table, write its navigation map as PNG, and exit");
  app.add_flag("--credits", config.credits, "list authors and licences of the models that the scene shows, and exit");
  app.add_option("--snapshot", config.snapshot_dir, "render views of every room into this folder, and exit");
  app.add_option("--ground-truth", config.truth_dir,
                 "write labelled voxels, explorable volume, rooms and navigation map into this folder, and exit");
  auto* generate =
      app.add_option("--generate", config.generated_seed,
                     "generate a building from this seed, print its scene file, and exit")
          ->check([](const std::string& text) {
            const bool is_seed = text.size() - 1 < 19 && text.find_first_not_of("0123456789") == std::string::npos;
            return std::string(is_seed ? "" : "wanted is a seed, a whole number of at most 19 digits, not " + text);
          });
  app.add_option("--kind", config.generated_kind, "kind of the building that --generate makes")
      ->needs(generate)
      ->check(CLI::IsMember(building_kinds()))
      ->capture_default_str();
  app.add_flag("--panes", config.generates_panes,
               "add free-standing panes of glass and mirrors to the building that --generate makes")
      ->needs(generate);
  app.add_option("--export-tum", config.export_dir, "record the tour as a TUM RGB-D data set in this folder, and exit");
}

config::Rules SimulatorComponent::rules(const Config& config) {
  return {{config.wheels.least_noise <= config.wheels.most_noise,
           "simulator.wheels.least_noise must not be greater than simulator.wheels.most_noise"},
          {config.start.empty() || given_start(config.start), "simulator.start has to be \"x y yaw_deg\", or empty"}};
}

std::optional<int> SimulatorComponent::run_tool(const Config& config) { return run_scene_tool(config); }

SimulatorComponent::SimulatorComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), world_(load_world(config, context)), start_(start_pose(world_, config)),
      tour_(plan_tour(world_, start_, config)),
      camera_(context, {.has_labels = config.labels, .has_ground_truth = true}, config.mode == "freerun"),
      collision_(context.advertise(topics::kCollision)) {
  if (!config_.output_dir.empty()) {
    files::require_writable_folder(config_.output_dir, "simulator.output_dir");
    map_descriptions_ = &context.subscribe(topics::kMapDescription, [this](const auto& m) { note_map(m); });
  }
  describe_scene(world_);
  if (config_.wheels.odometry) {
    odometry_ = &context.advertise(topics::kWheelOdometry);
    transforms_ = &context.advertise(topics::kTransforms);
  }
  if (config_.imu) imu_ = &context.advertise(topics::kImu);
  context.subscribe(topics::kCommand, [this](const auto& m) { run_->command(from_message(m)); });
  if (config_.ends_when_explored) {
    context.subscribe(topics::kPlannerStatus, [this](const auto& m) { note_planner(m); });
  }
  serve();
  begin();
  if (config_.mode == "lockstep") {
    driver_ = std::make_unique<runtime::LockstepDriver>(context, config_.lockstep, [this] { publish_again(); });
  }
  context.on_cycle([this](const runtime::Cycle&) { work(); });
}

void SimulatorComponent::serve() {
  const auto answer = [](const std::string& text, bool is_done = true) {
    std_srvs::srv::Trigger_Response response;
    response.success(is_done);
    response.message(text);
    return response;
  };
  const auto tick = [this] { return std::to_string(run_->frames()); };
  context_.serve(topics::kPause, [this, answer, tick](const auto&) {
    pause();
    return answer("paused at tick " + tick());
  });
  context_.serve(topics::kRun, [this, answer, tick](const auto&) {
    resume();
    return answer("running from tick " + tick());
  });
  context_.serve(topics::kStep, [this, answer, tick](const auto&) {
    pause();
    ++steps_;
    return answer("stepping on from tick " + tick());
  });
  context_.serve(topics::kReset, [this, answer](const auto&) {
    const auto first = time::Duration::from_seconds(1.0 / config_.robot.camera.rate_hz);
    if (run_->frames() > 0 && run_->stamp() <= time::Time{} + first + time::kRestartGap) {
      return answer("not reset: consumers take a step back of less than a second for disorder; try again later", false);
    }
    begin();
    if (driver_) driver_->restart();
    return answer("back at the start");
  });
}

/// Ground truth is built for one map. A mapper that dies may be restarted, but not with other settings.
void SimulatorComponent::note_map(const lapis_msgs::msg::MapDescription& message) {
  const std::string topic = topics::kMapDescription.name;
  auto map = messages::from_message(message);
  if (!map) return fail(topic + ": " + map.reason);
  const bool is_first = !map_ || !has_truth_begun_;
  const std::string unlike = is_first ? "" : mapping::difference(*map_, *map);
  if (!unlike.empty()) return fail(topic + ": the map is another one than ground truth was begun for: " + unlike);
  map_ = std::move(*map);
}

/// A status with a stamp outside this run is latched from another one, and is ignored.
void SimulatorComponent::note_planner(const lapis_msgs::msg::PlannerStatus& message) {
  const time::Time stamp = messages::from_message(message.header().stamp());
  if (run_->frames() > 0 && stamp <= run_->stamp()) planner_ = message;
}

void SimulatorComponent::pause() {
  is_paused_ = true;
  ran_s_ = wall_s();
  running_since_.reset();
}

void SimulatorComponent::resume() {
  is_paused_ = false;
  steps_ = 0;
  due_ = Clock::now();
}

/// Wall-clock time since the first frame, without pauses.
double SimulatorComponent::wall_s() const {
  return running_since_ ? ran_s_ + seconds_between(*running_since_, Clock::now()) : ran_s_;
}

/// Begins a new run at the start pose and at time 0.
void SimulatorComponent::begin() {
  run_.reset();  // frees its memory before the next run allocates its own
  run_ =
      std::make_unique<Run>(world_, start_, config_, tour_, SimulatorFrameIds{camera_.ids(), context_.frame("odom")});
  planner_.reset();
  has_ended_ = false;
  steps_ = 0;
  ran_s_ = 0.0;
  running_since_.reset();
  due_ = Clock::now();
  camera_.publish_latched(set_up(config_.robot.camera), world_.scene().labels, time::Time{});
}

/// Begins at most one tick, because the executor handles signals, services and commands between ticks.
void SimulatorComponent::work() {
  using State = runtime::LockstepDriver::State;
  if (!failure_.empty()) return;
  try {
    if (truth_.valid() && truth_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) truth_.get();
    const State state = driver_ ? driver_->state() : State::kIdle;
    if (state == State::kFailed) throw std::runtime_error(driver_->failure());
    if (state == State::kIdle && may_tick()) tick();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void SimulatorComponent::fail(const std::string& reason) {
  failure_ = reason;
  context_.fail(reason);
}

/// False while paused, while it waits for readers or for the map's description, and before the wall-clock time of the
/// next tick; in that case the executor is woken at that time.
bool SimulatorComponent::may_tick() {
  if (is_paused_ && steps_ == 0) return false;
  if (!driver_ && run_->frames() == 0 && !camera_.has_readers(static_cast<std::size_t>(config_.wait_for_readers))) {
    context_.executor().at(Clock::now() + kMatchingPeriod, [] {});
    return false;
  }
  if (run_->frames() == 0 && !is_map_settled()) return false;
  const double pace = driver_ ? config_.max_real_time_factor : 1.0;
  if (pace > 0.0 && Clock::now() < due_) {
    context_.executor().at(due_, [] {});
    return false;
  }
  if (pace > 0.0) {
    const std::chrono::duration<double> period(1.0 / (pace * config_.robot.camera.rate_hz));
    // The ticks after a late one do not catch up.
    due_ = std::max(due_ + std::chrono::duration_cast<Clock::duration>(period), Clock::now());
  }
  if (is_paused_) --steps_;
  return true;
}

/// True when it is known for which map ground truth is built: that of the connected mapper, or the default map when no
/// mapper is connected.
bool SimulatorComponent::is_map_settled() {
  if (map_ || map_descriptions_ == nullptr || map_descriptions_->matched() == 0) return true;
  context_.executor().at(Clock::now() + kMatchingPeriod, [] {});  // checks again, because the mapper may leave
  if (context_.rate_limit().pass("map")) spdlog::info("waiting for {}", topics::kMapDescription.name);
  return false;
}

/// Publishes a frame. The last frame is followed by a tick without a frame, in which the other processes finish their
/// work; then the run ends.
void SimulatorComponent::tick() {
  if (has_ended_) {
    report_progress(true);
    return context_.finish();
  }
  if (!is_paused_ && !running_since_) running_since_ = reported_ = Clock::now();
  if (run_->frames() == 0 && map_descriptions_ != nullptr) begin_truth();
  has_ended_ = run_->is_over() || (planner_ && messages::has_ended(*planner_));
  if (!has_ended_) {
    run_->advance();
    publish_again();
    publish_contact();
    report_progress(false);
  }
  if (driver_) driver_->begin(run_->stamp(), has_ended_);
  context_.executor().wake();
}

/// Publishes nothing in the last tick, which has no frame.
void SimulatorComponent::publish_again() {
  if (has_ended_) return;
  if (odometry_ != nullptr) {
    for (const auto& message : run_->messages()->odometry) odometry_->publish(message);
    for (const auto& message : run_->messages()->transforms) transforms_->publish(message);
  }
  for (const auto& message : run_->messages()->imu) imu_->publish(message);
  camera_.publish(run_->messages()->camera);
}

void SimulatorComponent::publish_contact() {
  if (run_->has_contact_changed()) {
    std_msgs::msg::Bool message;
    message.data(run_->is_in_contact());
    collision_.publish(message);
  }
  context_.status().value("frames", run_->frames());
  context_.status().value("collisions", run_->collisions());
}

void SimulatorComponent::report_progress(bool is_last) {
  const auto now = Clock::now();
  if (!is_last && seconds_between(reported_, now) < kProgressPeriod_s) return;
  reported_ = now;
  const double simulated_s = run_->stamp().seconds();
  const std::string text =
      fmt::format("{:.1f} s simulated, real-time factor {:.2f}", simulated_s, simulated_s / std::max(wall_s(), 1e-3));
  spdlog::info(text);
  context_.heart().set_progress(text);
}

/// Begins the ground truth: that of the scene only once, the ideal map for each run.
void SimulatorComponent::begin_truth() {
  if (map_) run_->keep_ideal_map(map_->resolution_m, map_->frames);
  if (std::exchange(has_truth_begun_, true)) return;
  const mapping::MapDescription map = map_.value_or(default_map(config_));
  if (!map_)
    spdlog::warn("no mapper is there: no ideal.lapis is made, and mesh.lapis has voxels of {} m", map.resolution_m);
  make_truth(map);
}

/// Makes the ground truth of the scene in a separate thread, so that the run does not wait for it.
void SimulatorComponent::make_truth(const mapping::MapDescription& map) {
  truth_ = std::async(std::launch::async, [this, map] {
    write_truth(world_, start_, config_, map, truth_folder(config_), truth_cancelled_.get_token());
  });
}

/// Waits for the ground truth of the scene; gives up after kHurriedTruth_s when the process has to end soon.
void SimulatorComponent::await_truth() {
  std::optional<Clock::time_point> hurried_since;
  while (truth_.wait_for(kHurryPeriod) != std::future_status::ready) {
    if (!hurried_since && context_.is_in_a_hurry()) hurried_since = Clock::now();
    if (!hurried_since || seconds_between(*hurried_since, Clock::now()) < kHurriedTruth_s) continue;
    spdlog::warn("ground truth takes too long and is left out; lapis_simulator --ground-truth DIR makes it");
    truth_cancelled_.request_stop();
    break;
  }
  truth_.get();
}

void SimulatorComponent::reconfigure(const Config& config) {
  config_.max_real_time_factor = config.max_real_time_factor;
}

void SimulatorComponent::finish() {
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (const auto refused = run_->commands_refused(); refused > 0) {
    spdlog::warn("commands refused, because they are not finite: {}", refused);
  }
  const runtime::LongWork work(context_.heart(), "makes the ground truth", kLongestTruth_s);
  try {
    if (truth_.valid()) await_truth();
  } catch (const std::exception& error) {
    fail(error.what());
  }
  if (!config_.output_dir.empty()) write_files();
}

void SimulatorComponent::write_files() {
  RunSummary summary;
  summary.exit_reason = !failure_.empty() ? failure_ : has_ended_ ? "completed" : "stopped";
  summary.frames = run_->frames();
  summary.simulated_s = run_->stamp().seconds();
  summary.wall_s = wall_s();
  summary.collisions = run_->collisions();
  summary.hardest_push_m_s = run_->hardest_push_m_s();
  if (planner_) summary.planner = PlannerEnd{messages::state_name(*planner_), planner_->reason()};
  if (driver_) {
    summary.cpu_ms = driver_->cpu_ms();
    summary.demoted = driver_->demoted();
  }
  files::replace_text(std::filesystem::path(config_.output_dir) / "simulation.yaml",
                      to_yaml(summary, world_, start_, config_));
  if (const IdealMap* ideal = run_->ideal_map()) write_ideal_map(truth_folder(config_), world_.scene(), *ideal);
}

}  // namespace lapis::simulator

template int lapis::runtime::run_component<lapis::simulator::SimulatorComponent>(int argc, char** argv);
