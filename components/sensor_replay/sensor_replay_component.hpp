#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "common/runtime/context.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/runtime/run_component.hpp"
#include "sensor_replay/recording.hpp"
#include "sensor_replay/sensor_replay_config.hpp"

namespace lapis::sensor_replay {

/// Plays a recorded data set or a bag on the topics of a camera, in lock-step with its subscribers or by the wall
/// clock.
class SensorReplayComponent {
 public:
  using Config = SensorReplayConfig;
  static constexpr const char* kName = "sensor_replay";
  static constexpr const char* kSummary = "Plays a TUM RGB-D data set, or a bag of rosbag2, on the camera topics.";

  static void add_options(CLI::App& app, Config& config);
  static std::optional<int> run_tool(const Config& config);

  SensorReplayComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void work();
  void play_by_wall_clock();
  void play_when_due();
  Recording::Step publish_next();
  void report_progress(bool is_last);

  const Config config_;
  runtime::Context& context_;
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<runtime::LockstepDriver> driver_;
  std::optional<time::Time> first_stamp_;  // by the wall clock
  std::size_t played_ = 0;
  bool has_ended_ = false;
  double longest_tick_s_ = 0.0;               // of the ticks with a frame
  std::optional<Clock::time_point> closing_;  // beginning of the tick after the last frame
  std::optional<Clock::time_point> began_;
  Clock::time_point reported_;
};

}  // namespace lapis::sensor_replay
