#include "simulator/run.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "simulator/run_files.hpp"
#include "simulator/set_up.hpp"

namespace lapis::simulator {

Run::Run(const World& world, const StartPose& start, const SimulatorConfig& config, std::optional<TourFollower> tour,
         SimulatorFrameIds ids)
    : world_(world), start_(start), config_(config), ids_(std::move(ids)),
      simulation_(world, simulation_config(config), start), tour_(std::move(tour)) {
  begin_next();
}

void Run::keep_ideal_map(double resolution_m, const mapping::FrameSettings& frames) {
  ideal_map_.emplace(resolution_m, frames);
}

void Run::command(const DriveCommand& command) {
  if (!tour_ && step_) command_ = command;
}

void Run::advance() {
  if (const auto problem = tour_ ? tour_->stalled() : ""; !problem.empty()) {
    throw std::runtime_error("scene " + world_.scene().name + ": " + problem);
  }
  const bool was_in_contact = is_in_contact();
  step_ = next_.get();
  const SensorFrame& frame = step_->frame;
  has_contact_changed_ = frame.tick == 1 || frame.is_in_contact != was_in_contact;
  if (frame.is_in_contact && !was_in_contact) note_collision(frame);
  hardest_push_m_s_ = std::max(hardest_push_m_s_, frame.push_m_s);
  if (tour_) command_ = tour_->command(frame.robot);
  is_over_ =
      (tour_ && tour_->is_finished()) || (config_.duration_s > 0.0 && frame.stamp.seconds() >= config_.duration_s);
  if (!is_over_) begin_next();
}

void Run::note_collision(const SensorFrame& frame) {
  ++collisions_;
  spdlog::warn(
      "the robot touches something at {:.1f} s, x {:.2f} m, y {:.2f} m of the scene, driving at it with {:.2f} m/s",
      frame.stamp.seconds(), frame.robot.position.x(), frame.robot.position.y(), frame.push_m_s);
}

void Run::begin_next() {
  next_ = std::async(std::launch::async, [this, command = std::exchange(command_, std::nullopt)] {
    add_to_ideal_map();  // adds the last frame: only published frames count
    Step step;
    step.frame = simulation_.next(command);
    step.messages = to_messages(step.frame, set_up(config_.robot.camera), ids_);
    return step;
  });
}

void Run::add_to_ideal_map() {
  // The order matters: before the first frame, another thread may be writing ideal_map_ in keep_ideal_map().
  if (frames_in_ideal_map_ == frames() || !ideal_map_) return;
  add_to(*ideal_map_, step_->frame, world_, start_, config_);
  frames_in_ideal_map_ = frames();
}

void Run::wait() const {
  if (next_.valid()) next_.wait();
}

std::uint64_t Run::commands_refused() {
  wait();
  return simulation_.commands_refused();
}

const IdealMap* Run::ideal_map() {
  wait();
  add_to_ideal_map();
  return ideal_map_ ? &*ideal_map_ : nullptr;
}

}  // namespace lapis::simulator
