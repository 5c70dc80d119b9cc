#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/camera_frame.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/synthetic_room.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {

inline constexpr const char* kController = "lapis_controller";
inline constexpr double kRate_hz = 15.0;
inline constexpr double kRadius_m = 0.2;

/// Who publishes in a tick; a test silences some.
struct Speaking {
  bool camera = true;
  bool pose = true;
  bool map = true;
  bool planner = true;
};

/// All that the controller needs, played by the test: a depth camera in a hall, slam, mapper and planner, and a robot
/// that does at once what it is asked.
class Surroundings {
 public:
  explicit Surroundings(runtime::Context& context)
      : depth_(context.advertise(topics::kDepth)), info_(context.advertise(topics::kDepthInfo)),
        pose_(context.advertise(topics::kSlamOdometry)), mount_(context.advertise(topics::kStaticTransforms)),
        map_(context.advertise(topics::kObstacles)), planner_(context.advertise(topics::kPlannerStatus)),
        path(context.advertise(topics::kPlannerPath)) {
    mount_.publish(messages::to_static_transforms({{1.0, 0.0}, {}, std::nullopt}, kIds, stamp));
  }

  /// The next frame.
  void publish(const Speaking& who) {
    stamp = time::Time{1'000'000'000} + time::Duration::from_seconds(++frames_ / kRate_hz) + clock;
    if (who.camera) publish_view();
    if (who.pose) publish_pose();
    if (who.map) publish_map();
    if (who.planner) planner_.publish({});
  }
  void drive(const geometry_msgs::msg::Twist& command) {
    yaw_rad += command.angular().z() / kRate_hz;
    position += command.linear().x() / kRate_hz * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
    least_room_m = std::min(least_room_m, room_m());
  }
  void send_path(const std::vector<Eigen::Vector2d>& points) {
    nav_msgs::msg::Path message;
    message.header(messages::header(stamp, "map"));
    for (const auto& p : points) {
      geometry_msgs::msg::PoseStamped pose;
      pose.pose().position().x(p.x());
      pose.pose().position().y(p.y());
      pose.pose().orientation().w(1.0);
      message.poses().push_back(pose);
    }
    path.publish(message);
  }

  /// By which the robot is to turn on the spot, a heading after the other.
  void send_turn(const std::vector<double>& headings_rad, const std::string& frame = "base_link") {
    nav_msgs::msg::Path message;
    message.header(messages::header(stamp, frame));
    for (const double heading_rad : headings_rad) {
      geometry_msgs::msg::PoseStamped pose;
      pose.pose(messages::to_message(geometry::make_pose(
          Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ())))));
      message.poses().push_back(pose);
    }
    path.publish(message);
  }

  std::vector<Box> boxes{{{-9, -9, -0.3}, {9, 9, 0}, 2}, {{8, -9, 0}, {8.3, 9, 2.6}, 1}};  ///< the first is the floor
  time::Duration clock;  ///< by which the clock of all stamps was set
  time::Time stamp{1'000'000'000};
  Eigen::Vector2d position{0.0, 0.0};
  double yaw_rad = 0.0;
  double least_room_m = std::numeric_limits<double>::infinity();
  /// Spoils what is sent next.
  std::function<void(sensor_msgs::msg::Image&, sensor_msgs::msg::CameraInfo&)> spoil_view;
  std::function<void(nav_msgs::msg::Odometry&)> spoil_pose;
  std::function<void(nav_msgs::msg::OccupancyGrid&)> spoil_map;

 private:
  inline static const messages::CameraFrameIds kIds{"base_link", "camera_link", "camera_color_optical_frame",
                                                    "camera_depth_optical_frame", "map"};
  inline static const geometry::PinholeCamera kCamera{160, 90, 80, 80, 79.5, 44.5};

  double room_m() const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < boxes.size(); ++i) {
      const Eigen::Vector2d low = boxes[i].low.head<2>(), high = boxes[i].high.head<2>();
      nearest = std::min(nearest, (position - position.cwiseMax(low).cwiseMin(high)).norm());
    }
    return nearest - kRadius_m;
  }
  void publish_view() {
    const auto seen = render(boxes, kCamera, look({position.x(), position.y(), 1.0}, yaw_rad));
    geometry::Image<std::uint16_t> depth_mm(kCamera.width, kCamera.height);
    std::transform(seen.depth.pixels.begin(), seen.depth.pixels.end(), depth_mm.pixels.begin(),
                   [](float metres) { return static_cast<std::uint16_t>(std::lround(1e3f * metres)); });
    const geometry::ColorImage color(kCamera.width, kCamera.height);
    auto frame =
        messages::to_messages({stamp, color, &depth_mm, nullptr, std::nullopt}, {{}, kCamera, std::nullopt}, kIds);
    if (spoil_view) spoil_view(*frame.depth, frame.depth_info);
    depth_.publish(*frame.depth);
    info_.publish(frame.depth_info);
  }
  void publish_pose() {
    nav_msgs::msg::Odometry message;
    message.header(messages::header(stamp, "map"));
    message.child_frame_id("base_link");
    message.pose().pose(messages::to_message(geometry::make_pose(
        {position.x(), position.y(), 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())))));
    if (spoil_pose) spoil_pose(message);
    pose_.publish(message);
  }
  void publish_map() {
    nav_msgs::msg::OccupancyGrid message;
    message.header(messages::header(stamp, "map"));
    message.info().resolution(0.25f);
    message.info().width(40);
    message.info().height(40);
    message.info().origin().position().x(-5.0);
    message.info().origin().position().y(-5.0);
    message.info().origin().orientation().w(1.0);
    message.data().assign(1600, 0);
    if (spoil_map) spoil_map(message);
    map_.publish(message);
  }

  int frames_ = 0;
  dds::Publisher<sensor_msgs::msg::Image>& depth_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& info_;
  dds::Publisher<nav_msgs::msg::Odometry>& pose_;
  dds::Publisher<tf2_msgs::msg::TFMessage>& mount_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& map_;
  dds::Publisher<lapis_msgs::msg::PlannerStatus>& planner_;

 public:
  dds::Publisher<nav_msgs::msg::Path>& path;
};

/// The real controller and its surroundings, by the wall clock or in lock-step.
class ControllerContract : public ::testing::Test {
 protected:
  using Command = geometry_msgs::msg::Twist;
  using Status = lapis_msgs::msg::ControllerStatus;

  explicit ControllerContract(const std::vector<std::string>& options = {})
      : context({"test_driver", participant_options("test_driver")}), world(context), controller(kController, options) {
    context.subscribe(topics::kCommand, [this](const Command& m) { commands.push_back(m); });
    context.subscribe(topics::kControllerStatus, [this](const Status& m) { statuses.push_back(m); });
    context.subscribe(topics::kLocalPath, [this](const auto& m) { local_path = m; });
    context.subscribe(topics::kWheelOdometry, [this](const auto& m) { readings.push_back(m); });
    context.subscribe(topics::kTransforms, [this](const auto& m) { transforms = m; });
    context.subscribe(topics::kDiagnostics, [this](const auto& m) { note(m); });
  }

  bool wait_until(const std::function<bool()>& condition, Seconds deadline = Seconds(15)) {
    const auto end = std::chrono::steady_clock::now() + deadline;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      context.executor().spin_once(std::chrono::milliseconds(2));
    }
    return true;
  }
  /// Diagnostics counters of what was dropped, and of clocks that were set, whose name contains `text`, summed.
  std::uint64_t count_of(const std::string& text) const {
    std::uint64_t sum = 0;
    for (const auto& [key, value] : counters) {
      if (key.find(text) != std::string::npos) sum += std::stoull(value);
    }
    return sum;
  }
  static bool is_zero(const Command& command) { return command.linear().x() == 0.0 && command.angular().z() == 0.0; }
  static bool is_finite(const Command& command) {
    const auto is_sound = [](const auto& v) {
      return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
    };
    return is_sound(command.linear()) && is_sound(command.angular());
  }

  runtime::Context context;
  Surroundings world;
  std::vector<Command> commands;
  std::vector<Status> statuses;
  nav_msgs::msg::Path local_path;
  std::vector<nav_msgs::msg::Odometry> readings;  // of a controller that publishes odometry
  tf2_msgs::msg::TFMessage transforms;
  std::map<std::string, std::string> counters;
  ChildProcess controller;

 private:
  void note(const diagnostic_msgs::msg::DiagnosticArray& message) {
    for (const auto& status : message.status()) {
      if (status.hardware_id() != "controller") continue;
      for (const auto& pair : status.values()) {
        const bool is_wanted = pair.key().find("dropped") != std::string::npos ||
                               pair.key().find("clock of its source") != std::string::npos;
        if (is_wanted) counters[pair.key()] = pair.value();
      }
    }
  }
};

/// In lock-step: the test is the clock, and each tick brings one command.
class LockstepController : public ControllerContract {
 protected:
  explicit LockstepController(const std::vector<std::string>& options = {})
      : ControllerContract(options), driver_(context, {{"controller"}, 5.0, 30.0, "abort"}, [] {}) {}
  void SetUp() override {
    ASSERT_TRUE(wait_until([&] { return driver_.state() == State::kIdle; })) << controller.log();
  }
  /// One frame; false when it is not answered with exactly one command.
  bool tick(const Speaking& who = {}) {
    const std::size_t before = commands.size();
    world.publish(who);
    driver_.begin(world.stamp, false);
    if (!wait_until([&] { return driver_.state() != State::kWaiting; })) return false;
    if (driver_.state() != State::kIdle || commands.size() != before + 1) return false;
    world.drive(commands.back());
    return true;
  }
  /// Ticks until a command is, or is not, zero; the seconds of frames it took, or infinity.
  double ticks_until(bool is_wanted_zero, double limit_s, const Speaking& who = {}) {
    for (int i = 1; i <= limit_s * kRate_hz; ++i) {
      if (!tick(who)) ADD_FAILURE() << "not one command for a tick" << controller.log();
      if (is_zero(commands.back()) == is_wanted_zero) return i / kRate_hz;
    }
    return std::numeric_limits<double>::infinity();
  }
  /// On its way, at more than half of the full speed.
  void get_going() {
    world.send_path({{0, 0}, {3, 0}, {6, 0}});
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << controller.log();
    ASSERT_GT(commands.back().linear().x(), 0.4) << statuses.back().reason() << controller.log();
  }

 private:
  using State = runtime::LockstepDriver::State;
  runtime::LockstepDriver driver_;
};

}  // namespace lapis::test
