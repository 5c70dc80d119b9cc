#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "common/runtime/camera_publisher.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/runtime/run_component.hpp"
#include "simulator/conversions.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "simulator/core/simulation.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/world.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::simulator {

/// Simulates a robot in a building on the topics of its hardware, in lock-step with their consumers or by the wall
/// clock. The next frame is simulated in a thread of its own while the others work on the last one.
class SimulatorComponent {
 public:
  using Config = SimulatorConfig;
  static constexpr const char* kName = "simulator";
  static constexpr const char* kSummary =
      "Simulates an RGB-D robot in a furnished building.\n"
      "Tools on scenes, without DDS: --validate, --snapshot, --export-tum, --credits";

  static void add_options(CLI::App& app, Config& config);
  static std::optional<int> run_tool(const Config& config);

  SimulatorComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  struct Step {
    SensorFrame frame;
    SensorMessages messages;
  };

  void serve();
  void begin();
  void work();
  bool may_tick();
  void tick();
  void end();
  void publish_again();
  void publish_contact(bool is_in_contact);
  void simulate_next();
  void report_progress(bool is_last);
  void make_truth();
  void write_files();

  const Config config_;
  runtime::Context& context_;
  const World world_;
  const StartPose start_;
  runtime::CameraPublisher camera_;
  dds::Publisher<nav_msgs::msg::Odometry>& wheels_;
  dds::Publisher<std_msgs::msg::Bool>& collision_;
  dds::Publisher<sensor_msgs::msg::Imu>* imu_ = nullptr;
  std::unique_ptr<runtime::LockstepDriver> driver_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<TourFollower> tour_;
  std::optional<DriveCommand> command_;  // newest, not yet obeyed
  std::optional<IdealMap> ideal_;
  std::optional<SensorMessages> last_;  // lock-step may want them again
  time::Time stamp_;
  std::uint64_t ticks_ = 0;
  std::uint64_t collisions_ = 0;
  std::string failure_;
  bool is_in_contact_ = false;
  bool is_over_ = false;    // no further frame
  bool has_ended_ = false;  // and the others know
  bool is_paused_ = false;
  int steps_ = 0;  // asked for while paused
  std::optional<Clock::time_point> began_;
  Clock::time_point due_;  // of the next tick by the wall clock
  Clock::time_point reported_;
  // Last: their threads use what is above, and end before it does.
  std::future<Step> next_;
  std::future<void> truth_;  // ground truth of the scene is being written
};

}  // namespace lapis::simulator
