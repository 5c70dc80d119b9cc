#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "common/mapping/file/map_description.hpp"
#include "common/runtime/camera_publisher.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/runtime/run_component.hpp"
#include "simulator/core/world.hpp"
#include "simulator/run.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Simulates a robot in a building on the topics of its hardware, either in lock-step with the consumers of these
/// topics or at the pace of the wall clock.
class SimulatorComponent {
 public:
  using Config = SimulatorConfig;
  static constexpr const char* kName = "simulator";
  static constexpr const char* kSummary =
      "Simulates an RGB-D robot in a furnished building.\n"
      "Tools on scenes, without DDS: --validate, --snapshot, --export-tum, --ground-truth, --credits, --generate";

  static void add_options(CLI::App& app, Config& config);
  static config::Rules rules(const Config& config);
  static std::optional<int> run_tool(const Config& config);

  SimulatorComponent(const Config& config, runtime::Context& context);
  /// From the next tick on.
  void reconfigure(const Config& config);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void serve();
  void note_map(const lapis_msgs::msg::MapDescription& message);
  void note_planner(const lapis_msgs::msg::PlannerStatus& message);
  void pause();
  void resume();
  double wall_s() const;
  void begin();
  void work();
  bool may_tick();
  bool is_map_settled();
  void tick();
  void publish_again();
  void publish_contact();
  void report_progress(bool is_last);
  void begin_truth();
  void make_truth(const mapping::MapDescription& map);
  void await_truth();
  void fail(const std::string& reason);
  void write_files();

  Config config_;
  runtime::Context& context_;
  const World world_;
  const StartPose start_;
  const std::optional<TourFollower> tour_;  // in its initial state; every run gets a copy
  runtime::CameraPublisher camera_;
  dds::Publisher<nav_msgs::msg::Odometry>* odometry_ = nullptr;  ///< null for a robot without wheel odometry
  dds::Publisher<tf2_msgs::msg::TFMessage>* transforms_ = nullptr;
  dds::Publisher<std_msgs::msg::Bool>& collision_;
  dds::Publisher<sensor_msgs::msg::Imu>* imu_ = nullptr;
  std::unique_ptr<runtime::LockstepDriver> driver_;
  std::unique_ptr<Run> run_;
  std::optional<lapis_msgs::msg::PlannerStatus> planner_;  // newest status of this run
  dds::Source* map_descriptions_ = nullptr;                // null without a run folder
  std::optional<mapping::MapDescription> map_;             // newest description
  bool has_truth_begun_ = false;
  std::string failure_;
  bool has_ended_ = false;  // the last tick, which has no frame, has begun
  bool is_paused_ = false;
  int steps_ = 0;                                   // number of ticks that were requested while paused
  double ran_s_ = 0.0;                              // wall-clock time up to the last pause
  std::optional<Clock::time_point> running_since_;  // time of the first frame, or of the first one after the last pause
  Clock::time_point due_;                           // wall-clock time of the next tick
  Clock::time_point reported_;
  std::stop_source truth_cancelled_;
  std::future<void> truth_;  // writes the scene's ground truth; declared last: its thread uses the members above
};

}  // namespace lapis::simulator
