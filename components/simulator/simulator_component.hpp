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

/// Simulates a robot in a building on the topics of its hardware, in lock-step with their consumers or by the wall
/// clock.
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

  const Config config_;
  runtime::Context& context_;
  const World world_;
  const StartPose start_;
  const std::optional<TourFollower> tour_;  // at its beginning
  runtime::CameraPublisher camera_;
  dds::Publisher<nav_msgs::msg::Odometry>* odometry_ = nullptr;  ///< none: a robot without wheel odometry
  dds::Publisher<tf2_msgs::msg::TFMessage>* transforms_ = nullptr;
  dds::Publisher<std_msgs::msg::Bool>& collision_;
  dds::Publisher<sensor_msgs::msg::Imu>* imu_ = nullptr;
  std::unique_ptr<runtime::LockstepDriver> driver_;
  std::unique_ptr<Run> run_;
  std::optional<lapis_msgs::msg::PlannerStatus> planner_;  // newest of this run
  dds::Source* map_descriptions_ = nullptr;                // with a run folder only
  std::optional<mapping::MapDescription> map_;             // newest
  bool has_truth_begun_ = false;
  std::string failure_;
  bool has_ended_ = false;  // the tick after the last frame is out
  bool is_paused_ = false;
  int steps_ = 0;                                   // asked for while paused
  double ran_s_ = 0.0;                              // by the wall clock, up to the last pause
  std::optional<Clock::time_point> running_since_;  // the first frame, or the last pause
  Clock::time_point due_;                           // of the next tick by the wall clock
  Clock::time_point reported_;
  std::stop_source truth_cancelled_;
  std::future<void> truth_;  // of the scene is being written; last: its thread uses what is above
};

}  // namespace lapis::simulator
