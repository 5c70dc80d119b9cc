#include "simulator/simulator_component.hpp"

#include "common/files/atomic_file.hpp"
#include "simulator/core/truth/truth_files.hpp"
#include "simulator/run_files.hpp"
#include "simulator/set_up.hpp"
#include "simulator/tools.hpp"

namespace lapis::simulator {
namespace {

constexpr double kProgressPeriod_s = 2.0;

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

void describe_scene(const World& world) {
  const Scene& scene = world.scene();
  spdlog::info("scene {}: {} triangles, {} instances, {} rooms", scene.name, scene.mesh.triangles.size(),
               scene.instances.size(), scene.rooms.size());
  for (const auto& warning : scene.warnings) spdlog::warn("scene {}: {}", scene.name, warning);
}

}  // namespace

void SimulatorComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("scene", config.scene, "name of a bundled scene, or a file or folder (docs/scenes.md)");
  app.add_option("--seed", config.seed, "draws start, noise, systematic errors, label confusion, jitter");
  app.add_option("--tour", config.tour, "\"bundled\" or a file with way-points: the robot drives by itself");
  app.add_option("--duration", config.duration_s, "end after this much simulated time [s]");
  app.add_option("--mode", config.mode, "lockstep or freerun");
  app.add_flag("--validate", config.validate, "check the scene, print a table, write its navigation map, and exit");
  app.add_flag("--credits", config.credits, "list authors and licences of what the scene shows, and exit");
  app.add_option("--snapshot", config.snapshot_dir, "render views of every room into this folder, and exit");
  app.add_option("--ground-truth", config.truth_dir,
                 "write labelled voxels, explorable volume, rooms and navigation map into this folder, and exit");
  app.add_option("--export-tum", config.export_dir, "write the tour as a TUM RGB-D data set, and exit");
}

std::optional<int> SimulatorComponent::run_tool(const Config& config) { return run_scene_tool(config); }

SimulatorComponent::SimulatorComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), world_(open_world(config)), start_(start_pose(world_, config)),
      camera_(context, {.has_labels = true, .has_ground_truth = true}),
      wheels_(context.advertise(topics::kWheelOdometry)), collision_(context.advertise(topics::kCollision)) {
  if (!config_.output_dir.empty()) files::require_writable_folder(config_.output_dir, "simulator.output_dir");
  describe_scene(world_);
  if (config_.imu) imu_ = &context.advertise(topics::kImu);
  context.subscribe(topics::kCommand, [this](const auto& m) { command_ = from_message(m); });
  serve();
  begin();
  if (config_.mode == "lockstep") {
    driver_ = std::make_unique<runtime::LockstepDriver>(context, config_.lockstep, [this] { publish_again(); });
  }
  context.on_cycle([this](const runtime::Cycle&) { work(); });
  if (!config_.output_dir.empty()) make_truth();
}

void SimulatorComponent::serve() {
  const auto answer = [](const std::string& text) {
    std_srvs::srv::Trigger_Response response;
    response.success(true);
    response.message(text);
    return response;
  };
  context_.serve(topics::kPause, [this, answer](const auto&) {
    is_paused_ = true;
    return answer("paused at tick " + std::to_string(ticks_));
  });
  context_.serve(topics::kRun, [this, answer](const auto&) {
    is_paused_ = false;
    due_ = Clock::now();
    return answer("running from tick " + std::to_string(ticks_));
  });
  context_.serve(topics::kStep, [this, answer](const auto&) {
    is_paused_ = true;
    ++steps_;
    return answer("stepping on from tick " + std::to_string(ticks_));
  });
  context_.serve(topics::kReset, [this, answer](const auto&) {
    begin();
    if (driver_) driver_->restart();
    return answer("back at the start");
  });
}

/// At the start again, with time 0.
void SimulatorComponent::begin() {
  if (next_.valid()) next_.wait();
  simulation_ = std::make_unique<Simulation>(world_, simulation_config(config_), start_);
  if (!config_.output_dir.empty()) ideal_.emplace(truth_config(config_));
  tour_ = simulator::plan_tour(world_, start_, config_);
  command_.reset();
  last_.reset();
  ticks_ = 0;
  is_over_ = has_ended_ = false;
  began_.reset();
  due_ = Clock::now();
  camera_.publish_latched(robot::camera_mount(config_.robot.camera), world_.scene().labels, time::Time{});
  simulate_next();
}

/// One tick at most: between two the executor looks for signals, services and commands.
void SimulatorComponent::work() {
  using State = runtime::LockstepDriver::State;
  const State state = driver_ ? driver_->state() : State::kIdle;
  if (state == State::kFailed && failure_.empty()) {
    failure_ = driver_->failure();
    return context_.fail(failure_);
  }
  if (state != State::kIdle || !may_tick()) return;
  if (has_ended_) {
    report_progress(true);
    return context_.finish();
  }
  if (is_over_) {
    end();
  } else {
    tick();
  }
  context_.executor().wake();
}

/// False while paused, or before the wall-clock time of the next tick, at which it wakes the executor.
bool SimulatorComponent::may_tick() {
  if (is_paused_ && steps_ == 0) return false;
  const double pace = driver_ ? config_.max_real_time_factor : 1.0;
  if (pace > 0.0 && Clock::now() < due_) {
    context_.executor().at(due_, [] {});
    return false;
  }
  if (pace > 0.0) {
    const std::chrono::duration<double> period(1.0 / (pace * config_.robot.camera.rate_hz));
    due_ = std::max(due_ + std::chrono::duration_cast<Clock::duration>(period), Clock::now());  // lost time stays lost
  }
  if (is_paused_) --steps_;
  return true;
}

void SimulatorComponent::tick() {
  if (!began_) began_ = reported_ = Clock::now();
  Step step = next_.get();
  ++ticks_;
  stamp_ = step.frame.stamp;
  last_ = std::move(step.messages);
  publish_again();
  publish_contact(step.frame.is_in_contact);
  if (tour_) command_ = tour_->command(step.frame.robot);
  const bool is_tour_over = tour_ && tour_->is_finished();
  is_over_ = is_tour_over || (config_.duration_s > 0.0 && stamp_.seconds() >= config_.duration_s);
  if (!is_over_) simulate_next();
  if (driver_) driver_->begin(stamp_, false);
  report_progress(false);
}

/// A tick without a frame: others finish their work.
void SimulatorComponent::end() {
  has_ended_ = true;
  last_.reset();
  if (driver_) driver_->begin(stamp_, true);
}

void SimulatorComponent::publish_again() {
  if (!last_) return;
  for (const auto& message : last_->wheels) wheels_.publish(message);
  for (const auto& message : last_->imu) imu_->publish(message);
  camera_.publish(last_->camera);
}

void SimulatorComponent::publish_contact(bool is_in_contact) {
  if (is_in_contact && !is_in_contact_) ++collisions_;
  if (is_in_contact != is_in_contact_ || ticks_ == 1) {
    std_msgs::msg::Bool message;
    message.data(is_in_contact);
    collision_.publish(message);
  }
  is_in_contact_ = is_in_contact;
  context_.status().value("frames", ticks_);
  context_.status().value("collisions", collisions_);
}

/// In a thread of its own, because rendering takes longer than the others' work on a stage.
void SimulatorComponent::simulate_next() {
  next_ = std::async(std::launch::async, [this, command = std::exchange(command_, std::nullopt)] {
    Step step;
    step.frame = simulation_->next(command);
    if (ideal_) add_to(*ideal_, step.frame, world_, start_, config_);
    step.messages =
        to_messages(step.frame, pinhole_camera(config_.robot.camera), {camera_.ids(), context_.frame("odom")});
    return step;
  });
}

void SimulatorComponent::report_progress(bool is_last) {
  const auto now = Clock::now();
  if (!is_last && seconds_between(reported_, now) < kProgressPeriod_s) return;
  reported_ = now;
  const double elapsed_s = std::max(seconds_between(*began_, now), 1e-3);
  spdlog::info("{:.1f} s simulated, real-time factor {:.2f}", stamp_.seconds(), stamp_.seconds() / elapsed_s);
}

/// The ground truth of the scene, in a thread of its own: the run does not wait for it.
void SimulatorComponent::make_truth() {
  truth_ = std::async(std::launch::async, [this] {
    write_truth(world_, start_, config_, config_.truth.resolution_m, truth_folder(config_));
  });
}

void SimulatorComponent::finish() {
  if (next_.valid()) next_.wait();
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (simulation_->commands_refused() > 0) {
    spdlog::warn("commands refused, because they are not finite: {}", simulation_->commands_refused());
  }
  if (!config_.output_dir.empty()) write_files();
}

void SimulatorComponent::write_files() {
  RunSummary summary;
  summary.exit_reason = !failure_.empty() ? failure_ : has_ended_ ? "completed" : "stopped";
  summary.frames = ticks_;
  summary.simulated_s = stamp_.seconds();
  if (began_) summary.wall_s = seconds_between(*began_, Clock::now());
  summary.collisions = collisions_;
  if (driver_) summary.cpu_ms = driver_->cpu_ms();
  files::replace_text(std::filesystem::path(config_.output_dir) / "simulation.yaml",
                      to_yaml(summary, world_, start_, config_));
  truth_.get();
  write_ideal_map(truth_folder(config_), world_.scene(), *ideal_);
}

}  // namespace lapis::simulator
