#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "common/mapping/file/map_description.hpp"
#include "common/mapping/wire/tile_codec.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/landmarks.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/planner/drawn_map.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {

inline constexpr const char* kPlanner = "lapis_planner";
inline constexpr double kRate_hz = 15.0;
inline constexpr double kResolution_m = 0.25;
using Drawing = std::vector<std::string>;

/// A room of 5 m x 4 m. Its door to the unknown is in the wall on the right.
inline const Drawing kRoomWithDoor{
    "####################", "#..................#", "#..................#", "#..................#",
    "#..................#", "#..................#", "#...................", "#...................",
    "#...................", "#..................#", "#..................#", "#..................#",
    "#..................#", "#..................#", "#..................#", "####################"};
/// The same without a door.
inline const Drawing kClosedRoom = [] {
  Drawing lines = kRoomWithDoor;
  for (std::string& line : lines) line.back() = '#';
  return lines;
}();
/// With another door, in the wall on the left.
inline const Drawing kRoomWithTwoDoors = [] {
  Drawing lines = kRoomWithDoor;
  for (std::size_t i = 6; i < 9; ++i) lines[i].front() = '.';
  return lines;
}();

/// All that the planner needs, played by the test: mapper, slam, controller, and a robot that follows paths exactly.
class Peers {
 public:
  using PoseGraph = lapis_msgs::msg::PoseGraph;
  using Tracked = lapis_msgs::msg::TrackedFrame;

  explicit Peers(runtime::Context& context)
      : map_description(context.advertise(topics::kMapDescription)), tiles(context.advertise(topics::kVoxelTiles)),
        map_state(context.advertise(topics::kMapState)), obstacles(context.advertise(topics::kObstacles)),
        pose_graph(context.advertise(topics::kPoseGraph)), landmarks(context.advertise(topics::kLandmarks)),
        landmark_state(context.advertise(topics::kLandmarkState)), frames(context.advertise(topics::kTrackedFrame)),
        odometry(context.advertise(topics::kSlamOdometry)), controller(context.advertise(topics::kControllerStatus)),
        provisional_area(context.advertise(topics::kProvisionalArea)),
        slam_status(context.advertise(topics::kSlamStatus)) {}

  /// What the mapper says of the map of this epoch and session.
  void describe_map() {
    description.resolution_m = kResolution_m;
    description.epoch = epoch;
    description.session = session;
    map_description.publish(messages::to_message(description, header()));
  }
  /// A new version of the map, all of it.
  void draw(const Drawing& lines) {
    const mapping::VoxelMap map = drawn_map(lines, kResolution_m);
    ++map_version_;
    if (!draws_without_description) describe_map();
    for (const auto& block : map.sorted_blocks()) tiles_.insert({block.x, block.y, block.z});  // 2 m: one block a tile
    for (const mapping::TileIndex& index : tiles_) tiles.publish(tile(map, index));
    map_state.publish(state());
  }
  lapis_msgs::msg::VoxelTile tile(const mapping::VoxelMap& map, const mapping::TileIndex& index) const {
    lapis_msgs::msg::VoxelTile message;
    message.x(index.x);
    message.y(index.y);
    message.z(index.z);
    message.epoch(epoch);
    message.version(map_version_);
    message.data(mapping::encode_tile(map, index, 1).value());
    return message;
  }
  /// Of the newest map.
  lapis_msgs::msg::MapState state() const {
    lapis_msgs::msg::MapState message;
    message.header(header());
    message.epoch(epoch);
    message.version(map_version_);
    message.session(session);
    message.resolution_m(kResolution_m);
    message.tiles(static_cast<std::uint32_t>(tiles_.size()));
    std::uint64_t checksum = 0;
    for (const mapping::TileIndex& index : tiles_) checksum += mapping::tile_hash(index, map_version_);
    message.checksum(checksum);
    return message;
  }

  /// A new version of a graph: five key-frames half a metre apart, up to the robot, joined by odometry.
  PoseGraph graph() {
    PoseGraph message;
    message.header(header());
    message.session(session);
    message.version(++graph_version_);
    for (std::uint64_t id = 0; id < 5; ++id) {
      lapis_msgs::msg::PoseGraphNode node;
      node.id(id);
      const double x = position.x() - 0.5 * static_cast<double>(4 - id);
      node.pose(messages::to_message(geometry::make_pose({x, position.y(), 0.0}, Eigen::Quaterniond::Identity()) *
                                     geometry::T_base_camera({1.0, 0.0})));
      message.nodes().push_back(node);
      if (id > 0) message.edges().push_back(odometry_edge(id - 1, id));
    }
    return message;
  }
  static lapis_msgs::msg::PoseGraphEdge odometry_edge(std::uint64_t from, std::uint64_t to) {
    lapis_msgs::msg::PoseGraphEdge edge;
    edge.from_id(from);
    edge.to_id(to);
    edge.relative_pose().orientation().w(1.0);
    for (const std::size_t diagonal : {0U, 6U, 11U, 15U, 18U, 20U}) edge.information()[diagonal] = 1e4;
    return edge;
  }

  /// Stamp, frame and, while slam tracks, pose of the next tick; the robot drives on.
  void publish_frame(std::uint8_t tracking = lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING) {
    stamp = time::Time{1'000'000'000} + time::Duration::from_seconds(++frames_so_far / kRate_hz) + clock;
    Tracked frame;
    frame.header(messages::header(stamp, "camera_color_optical_frame"));
    frame.map_frame_id("map");
    frame.session(session);
    frame.state(tracking);
    frame.reason(reason);
    frame.drift_m(drift_m);
    frames.publish(frame);
    drive();
    using namespace lapis_msgs::msg::TrackedFrame_Constants;
    if (tracking == STATE_TRACKING || tracking == STATE_DEAD_RECKONING) odometry.publish(pose());
  }
  nav_msgs::msg::Odometry pose() const {
    nav_msgs::msg::Odometry message;
    message.header(header());
    message.child_frame_id("base_link");
    message.pose().pose(messages::to_message(geometry::make_pose(
        {position.x(), position.y(), 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())))));
    for (const std::size_t axis : {0U, 7U, 14U})
      message.pose().covariance()[axis] = position_sigma_m * position_sigma_m;
    return message;
  }
  void say_blocked() {
    lapis_msgs::msg::ControllerStatus message;
    message.header(header());
    message.state(lapis_msgs::msg::ControllerStatus_Constants::STATE_BLOCKED);
    controller.publish(message);
  }
  nav_msgs::msg::OccupancyGrid free_grid() const {
    nav_msgs::msg::OccupancyGrid message;
    message.header(header());
    message.info().resolution(static_cast<float>(kResolution_m));
    message.info().width(4);
    message.info().height(4);
    message.info().origin().orientation().w(1.0);
    message.data().assign(16, 0);
    return message;
  }
  std_msgs::msg::Header header() const { return messages::header(stamp, "map"); }
  void follow(const nav_msgs::msg::Path& path) {
    path_.clear();
    if (path.header().frame_id() != "map") return;  // a turn on the spot
    for (const auto& pose : path.poses()) path_.push_back(*messages::from_message(pose.pose()));
  }

  dds::Publisher<lapis_msgs::msg::MapDescription>& map_description;
  dds::Publisher<lapis_msgs::msg::VoxelTile>& tiles;
  dds::Publisher<lapis_msgs::msg::MapState>& map_state;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& obstacles;
  dds::Publisher<PoseGraph>& pose_graph;
  dds::Publisher<lapis_msgs::msg::LandmarkTile>& landmarks;
  dds::Publisher<lapis_msgs::msg::LandmarkState>& landmark_state;
  dds::Publisher<Tracked>& frames;
  dds::Publisher<nav_msgs::msg::Odometry>& odometry;
  dds::Publisher<lapis_msgs::msg::ControllerStatus>& controller;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& provisional_area;
  dds::Publisher<lapis_msgs::msg::SlamStatus>& slam_status;

  mapping::MapDescription description;  ///< resolution, epoch and session are filled in
  bool draws_without_description = false;
  std::int64_t session = 1;
  std::int64_t epoch = 5;
  int frames_so_far = 0;
  time::Duration clock;  ///< by which the clock of all stamps was set
  time::Time stamp{1'000'000'000};
  Eigen::Vector2d position{2.0, 2.0};
  double yaw_rad = 0.0;
  double position_sigma_m = 0.0;  ///< that slam publishes, each axis
  double drift_m = 0.0;           ///< since slam tracked, as it says
  std::string reason;             ///< why it does not track
  bool drives = false;

 private:
  // 0.6 m/s; poses of a path are nearer to each other than it comes in a tick, or it turns at once.
  void drive() {
    double left_m = 0.6 / kRate_hz;
    while (drives && !path_.empty() && left_m > 0.0) {
      left_m -= (path_.front().translation().head<2>() - position).norm();
      position = path_.front().translation().head<2>();
      yaw_rad = std::atan2(path_.front()(1, 0), path_.front()(0, 0));
      path_.erase(path_.begin());
    }
  }

  std::set<mapping::TileIndex> tiles_;
  std::uint64_t map_version_ = 0, graph_version_ = 0;
  std::vector<geometry::Pose> path_;
};

/// The real planner and its peers, in lock-step or by the wall clock.
class PlannerRun {
 public:
  using Path = nav_msgs::msg::Path;
  using Status = lapis_msgs::msg::PlannerStatus;
  using Candidates = lapis_msgs::msg::CandidateSet;

  PlannerRun() : context({"test_driver", participant_options("test_driver")}), peers(context) {
    context.subscribe(topics::kPlannerPath, [this](const Path& m) {
      paths.push_back(m);
      peers.follow(m);
    });
    context.subscribe(topics::kPlannerStatus, [this](const Status& m) { statuses.push_back(m); });
    context.subscribe(topics::kCandidates, [this](const Candidates& m) { candidates.push_back(m); });
    context.subscribe(topics::kDiagnostics, [this](const auto& m) { diagnostics_.push_back(m); });
  }

  /// Starts the planner in lock-step, the test being the clock: one frame is one tick.
  bool start(const std::vector<std::string>& settings = {}) {
    start_free(settings);
    driver_ = std::make_unique<runtime::LockstepDriver>(
        context, runtime::LockstepConfig{{"planner"}, 5.0, 30.0, "abort"}, [] {});
    return wait_until([this] { return driver_->state() == Driver::kIdle; });
  }
  /// Starts it without; "key=value" each.
  void start_free(const std::vector<std::string>& settings = {}) {
    // Peers draw a map of one layer: above and below it would be nothing but gaps.
    std::vector<std::string> arguments{"--set", "planner.gaps.least_nats=0"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", "planner." + setting});
    planner.emplace(kPlanner, arguments);
  }

  bool wait_until(const std::function<bool()>& condition, Seconds deadline = Seconds(15)) {
    const auto end = std::chrono::steady_clock::now() + deadline;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      context.executor().spin_once(std::chrono::milliseconds(2));
    }
    return true;
  }
  /// One frame; false when it is not answered, or when what was counted does not come.
  bool tick(std::uint8_t tracking = kTracking) {
    peers.publish_frame(tracking);
    driver_->begin(peers.stamp, false);
    return wait_until([this] { return driver_->state() != Driver::kWaiting; }) && driver_->state() == Driver::kIdle;
  }
  /// Ticks until the condition holds; how many it took, or nothing when it does not within the limit.
  std::optional<int> ticks_until(const std::function<bool()>& condition, double limit_s = 10.0,
                                 std::uint8_t tracking = kTracking) {
    for (int i = 1; i <= limit_s * kRate_hz && tick(tracking); ++i) {
      if (condition()) return i;
    }
    return std::nullopt;
  }
  /// Without lock-step: a frame per period until the condition holds.
  bool frames_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 15 * kRate_hz; ++i) {
      peers.publish_frame();
      if (wait_until(condition, Seconds(1.0 / kRate_hz))) return true;
    }
    return false;
  }

  bool has_path() const { return !paths.empty() && !paths.back().poses().empty() && !turns(); }
  /// On the spot.
  bool turns() const { return !paths.empty() && paths.back().header().frame_id() == "base_link"; }
  bool stands() const { return !paths.empty() && paths.back().poses().empty(); }
  std::uint8_t state() const { return statuses.empty() ? std::uint8_t{255} : statuses.back().state(); }
  std::string reason() const { return statuses.empty() ? "no status" : statuses.back().reason(); }
  Eigen::Vector2d goal() const {
    const auto& p = paths.back().poses().back().pose().position();
    return {p.x(), p.y()};
  }
  /// Diagnostics counters whose name contains `text`, summed.
  double count_of(const std::string& text) const { return sum_of(newest_values(diagnostics_, "planner"), text); }
  /// What the planner gives on /diagnostics as the reason of an ERROR; empty: there was none.
  std::string error() const {
    for (const auto& array : diagnostics_) {
      for (const auto& status : array.status()) {
        if (status.hardware_id() == "planner" && status.level() == 2) return status.message();
      }
    }
    return "";
  }
  bool wait_for_count(const std::string& text) {
    return wait_until([&] { return count_of(text) > 0.0; }, Seconds(5));
  }
  /// All paths so far are in the map frame, finite, and go in small steps, or turn on the spot.
  bool are_paths_sound() const { return std::all_of(paths.begin(), paths.end(), is_sound); }

  static constexpr auto kTracking = lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING;
  static constexpr auto kReckoning = lapis_msgs::msg::TrackedFrame_Constants::STATE_DEAD_RECKONING;
  static constexpr auto kLost = lapis_msgs::msg::TrackedFrame_Constants::STATE_LOST;
  static constexpr auto kInitializing = lapis_msgs::msg::TrackedFrame_Constants::STATE_INITIALIZING;

  runtime::Context context;
  Peers peers;
  std::vector<Path> paths;
  std::vector<Status> statuses;
  std::vector<Candidates> candidates;
  std::optional<ChildProcess> planner;

 private:
  using Driver = runtime::LockstepDriver::State;

  static bool is_sound(const Path& path) {
    const std::string& frame = path.header().frame_id();
    std::optional<geometry::Pose> before;
    for (const auto& stamped : path.poses()) {
      const auto T = messages::from_message(stamped.pose());
      if (!T || stamped.header().frame_id() != frame) return false;
      if (before && (before->translation() - T->translation()).norm() > 0.15) return false;
      if (frame == "base_link" && T->translation().norm() > 0.0) return false;
      before = *T;
    }
    return frame == "map" || frame == "base_link";
  }

  std::vector<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  std::unique_ptr<runtime::LockstepDriver> driver_;
};

/// Whatever happens: no path that is none, and no crash.
class PlannerContract : public ::testing::Test, public PlannerRun {
 protected:
  void TearDown() override {
    EXPECT_TRUE(are_paths_sound());
    EXPECT_TRUE(planner && (has_ended || planner->is_running())) << planner->log();
  }
  /// Drives to the one door.
  void get_going() {
    ASSERT_TRUE(start()) << planner->log();
    peers.draw(kRoomWithDoor);
    ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  }

  bool has_ended = false;  ///< as the test wanted
};

}  // namespace lapis::test
