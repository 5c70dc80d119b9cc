#pragma once

#include <future>
#include <optional>

#include "simulator/conversions.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "simulator/core/simulation.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// One run of the robot, from its start to its end. A separate thread simulates the next frame while the other
/// processes work on the last one, because both take about as long.
class Run {
 public:
  /// @param world must outlive the run.
  /// @param tour path that the robot drives by itself; without one it obeys commands.
  /// @throws std::runtime_error when the robot does not fit at the start.
  Run(const World& world, const StartPose& start, const SimulatorConfig& config, std::optional<TourFollower> tour,
      SimulatorFrameIds ids);

  /// Keeps the map that a mapper with these settings would build from the frames without noise. To be called before the
  /// first frame.
  void keep_ideal_map(double resolution_m, const mapping::FrameSettings& frames);
  /// The command takes effect from the next frame but one, because the next one is already being simulated. It is
  /// ignored on a tour, and before the first frame, because there is no frame yet that it can answer.
  void command(const DriveCommand& command);
  /// Waits for the next frame, and starts the simulation of the one after it.
  /// @throws whatever the simulation of the next frame threw; std::runtime_error when the robot is stuck on its tour.
  void advance();
  /// True when no frame follows: the tour is finished, or the time is up.
  bool is_over() const { return is_over_; }

  /// Messages of the last frame, and of the other sensors since the frame before it; null before the first frame.
  const SensorMessages* messages() const { return step_ ? &step_->messages : nullptr; }
  bool is_in_contact() const { return step_ && step_->frame.is_in_contact; }
  /// Number of frames so far, and the time of the last one.
  std::uint64_t frames() const { return step_ ? step_->frame.tick : 0; }
  time::Time stamp() const { return step_ ? step_->frame.stamp : time::Time{}; }
  /// True when contact with an obstacle began or ended with the last frame; the first one counts, too.
  bool has_contact_changed() const { return has_contact_changed_; }
  /// Number of contacts so far.
  std::uint64_t collisions() const { return collisions_; }
  /// Greatest speed of the robot towards something that it touched [m/s].
  double hardest_push_m_s() const { return hardest_push_m_s_; }
  /// Number of commands that were refused because they were not finite. Waits for the frame that is being simulated.
  std::uint64_t commands_refused();
  /// The ideal map of the frames so far; null when none is kept. Waits for the frame that is being simulated.
  const IdealMap* ideal_map();

 private:
  struct Step {
    SensorFrame frame;
    SensorMessages messages;
  };
  void note_collision(const SensorFrame& frame);
  void begin_next();
  void add_to_ideal_map();
  void wait() const;

  const World& world_;
  const StartPose start_;
  const SimulatorConfig config_;
  const SimulatorFrameIds ids_;
  Simulation simulation_;
  std::optional<TourFollower> tour_;
  std::optional<DriveCommand> command_;  // the newest, which the robot does not obey yet
  std::optional<IdealMap> ideal_map_;
  std::uint64_t frames_in_ideal_map_ = 0;
  std::optional<Step> step_;
  std::uint64_t collisions_ = 0;
  double hardest_push_m_s_ = 0.0;
  bool is_over_ = false;
  bool has_contact_changed_ = false;
  std::future<Step> next_;  // declared last: its thread uses the members above, and ends before they are destroyed
};

}  // namespace lapis::simulator
