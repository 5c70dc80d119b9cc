#pragma once

#include <optional>
#include <string>

#include "common/images/rectifier.hpp"
#include "common/messages/geometry.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/depth_input.hpp"
#include "common/runtime/stamped_input.hpp"
#include "common/time/stamp_tolerance.hpp"
#include "controller/controller_config.hpp"
#include "controller/conversions.hpp"

namespace lapis::controller {

/// Drives the robot along the planner's path, around obstacles that its camera sees, and stops it when inputs are
/// missing or old.
class ControllerComponent {
 public:
  using Config = ControllerComponentConfig;
  static constexpr const char* kName = "controller";
  static constexpr const char* kSummary = "Local planner: follows the planner's path among obstacles.";

  static config::Rules rules(const Config& config);

  ControllerComponent(const Config& config, runtime::Context& context);
  /// From the next command on.
  void reconfigure(const Config& config);
  void finish();

 private:
  using Odometry = nav_msgs::msg::Odometry;
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;
  using OccupancyGrid = nav_msgs::msg::OccupancyGrid;
  using Path = nav_msgs::msg::Path;

  void follow_clock(time::Duration step);
  bool is_of_camera(time::Time stamp) const;
  void work(const runtime::Cycle& cycle);
  void take_inputs(const runtime::Cycle& cycle, time::Time now);
  bool next_frame(const runtime::Cycle& cycle, time::Time now);
  void take_frame(const Odometry& odometry, const Image* depth, const Info* info, time::Time now);
  void see(const Image& depth, const Info& info, time::Time now);
  void take_map(time::Time now);
  void take_path(const Path& message);
  void refuse_path(const std::string& problem);
  void note_frame(const lapis_msgs::msg::TrackedFrame& frame);
  void add_mount(const tf2_msgs::msg::TFMessage& message);
  void drop(const std::string& what, const std::string& reason);
  void publish(Decision decision, time::Time now);
  void note_camera(time::Time stamp);
  void publish_odometry(const Velocity& command, time::Time now);
  void publish_status(const Decision& decision, time::Time now);

  Config config_;
  runtime::Context& context_;
  const std::string map_frame_;
  const std::string odom_frame_;
  const std::string base_frame_;
  Controller controller_;
  CommandOdometry motion_;
  dds::Publisher<geometry_msgs::msg::Twist>& command_;
  dds::Publisher<Path>& local_path_;
  dds::Publisher<lapis_msgs::msg::ControllerStatus>& status_;
  dds::Publisher<Odometry>* odometry_ = nullptr;  // with publish_odometry
  dds::Publisher<tf2_msgs::msg::TFMessage>* transforms_ = nullptr;
  std::optional<time::Time> odometry_since_;   // when the first command was given
  std::optional<time::Time> published_until_;  // stamp of the newest odometry
  runtime::StampedInput<Odometry> pose_;
  time::StampTolerance tolerance_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Info> info_;

  // Arrived since the last cycle.
  bool has_planner_spoken_ = false;
  std::optional<Path> path_;
  std::optional<OccupancyGrid> plan_;
  std::optional<OccupancyGrid> obstacles_;

  messages::StaticTransforms static_transforms_;
  images::KeptRectifier rectifier_;  // of the depth camera
  std::uint64_t frames_ = 0;
  time::Time camera_stamp_;                     // stamp of the depth image that arrived last
  std::optional<time::Duration> camera_ahead_;  // of the steady clock, by the least delayed images; none in lock-step
  time::Time seen_at_;          // time of the newest one that was noted, by the clock as it was set first
  time::Duration clock_steps_;  // sum of the steps by which the camera's clock was set
  bool is_due_ = false;         // a command is due by the wall clock
  std::optional<time::Time> reported_at_;
  Decision reported_;
};

}  // namespace lapis::controller
