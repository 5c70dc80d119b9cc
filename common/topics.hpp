#pragma once

// The topic table: every name, type and QoS that Lapis's processes promise each other.
// docs/topics.md is printed from it.

#include "common/dds/topic.hpp"
#include "idl/diagnostic_msgs.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/octomap_msgs.hpp"
#include "idl/rosgraph_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/std_msgs.hpp"
#include "idl/std_srvs.hpp"
#include "idl/tf2_msgs.hpp"
#include "idl/vision_msgs.hpp"
#include "idl/visualization_msgs.hpp"

namespace lapis::topics {

using dds::ServiceTopic;
using dds::Topic;

// Time and lock-step.
inline constexpr Topic<rosgraph_msgs::msg::Clock> kClock{
    "/clock", {.depth = 10, .urgent = true}, "simulator, sensor_replay", "each tick", "time of the newest data", true};
inline constexpr Topic<lapis_msgs::msg::Tick> kTick{
    "/sim/tick",
    dds::kLockstep,
    "simulator, sensor_replay",
    "each stage of a tick",
    "releases a stage of lock-step with the counts of samples known so far",
    true};
inline constexpr Topic<lapis_msgs::msg::Ack> kAck{"/sim/ack",
                                                  dds::kLockstep,
                                                  "all that take part",
                                                  "each stage of a tick",
                                                  "answer to a tick with the counts of samples published",
                                                  true};

// Sensors.
inline constexpr Topic<sensor_msgs::msg::Image> kColor{"/camera/color/image_raw", dds::kSensor, "camera", "15 or 30 Hz",
                                                       "rgb8, bgr8, rgba8, bgra8 or mono8"};
inline constexpr Topic<sensor_msgs::msg::CompressedImage> kCompressedColor{
    "/camera/color/image_raw/compressed", dds::kSensor, "camera", "camera rate",
    "JPEG or PNG; read instead of image_raw with slam.input.color: compressed"};
inline constexpr Topic<sensor_msgs::msg::Image> kDepth{"/camera/depth/image_raw", dds::kSensor, "camera", "camera rate",
                                                       "16UC1 in mm or 32FC1 in m, registered to colour; 0 = none"};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kColorInfo{"/camera/color/camera_info", dds::kSensor, "camera",
                                                                "camera rate", "intrinsics"};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kDepthInfo{"/camera/depth/camera_info", dds::kSensor, "camera",
                                                                "camera rate", "intrinsics, the same as colour"};
inline constexpr Topic<sensor_msgs::msg::Image> kLabels{"/camera/semantic/image_raw", dds::kSensor,
                                                        "camera, or a segmentation", "camera rate or less",
                                                        "mono8 or mono16 class ids; 0 and the largest id = unlabelled"};
inline constexpr Topic<sensor_msgs::msg::Image> kLabelConfidence{"/camera/semantic/confidence", dds::kSensor,
                                                                 "camera, or a segmentation", "as the labels",
                                                                 "optional; 32FC1 or mono8"};
inline constexpr Topic<vision_msgs::msg::LabelInfo> kLabelInfo{
    "/camera/semantic/label_info", dds::kLatched, "camera, or a segmentation", "once", "names of the class ids"};
inline constexpr Topic<nav_msgs::msg::Odometry> kWheelOdometry{"/odom", dds::kBurst, "robot", "50 Hz",
                                                               "optional; wheel odometry, drifting"};
inline constexpr Topic<sensor_msgs::msg::Imu> kImu{"/imu", dds::kBurst, "robot", "200 Hz", "optional"};

// Ground truth: only the evaluator and tests may read these.
inline constexpr Topic<nav_msgs::msg::Odometry> kGroundTruth{
    "/ground_truth/odom", dds::kFrameState, "simulator, sensor_replay", "camera rate", "true pose of base_link"};
inline constexpr Topic<std_msgs::msg::Bool> kCollision{"/ground_truth/collision", dds::kState, "simulator", "on change",
                                                       "the robot touches something"};

// Transforms.
inline constexpr Topic<tf2_msgs::msg::TFMessage> kTransforms{
    "/tf", dds::kBurst, "slam, robot", "camera rate; 50 Hz from a robot", "map -> odom -> base_link", true};
inline constexpr Topic<tf2_msgs::msg::TFMessage> kStaticTransforms{
    "/tf_static", dds::kLatchedByMany, "camera", "once", "base_link -> camera_link -> optical frame", true};

// slam.
inline constexpr Topic<nav_msgs::msg::Odometry> kSlamOdometry{
    "/slam/odometry", dds::kFrameState, "slam", "camera rate",
    "pose of base_link in the map, with covariance; nothing while lost"};
inline constexpr Topic<lapis_msgs::msg::TrackedFrame> kTrackedFrame{
    "/slam/frame", dds::kFrameState, "slam", "camera rate",
    "state and pose of each frame relative to its reference key-frame"};
inline constexpr Topic<nav_msgs::msg::Path> kKeyframePath{"/slam/path", dds::kLatched, "slam",
                                                          "on change, at most 2 Hz", "key-frame trajectory"};
inline constexpr Topic<lapis_msgs::msg::PoseGraph> kPoseGraph{"/slam/pose_graph", dds::kLatched, "slam",
                                                              "on change, at most 2 Hz",
                                                              "nodes and edges with information, one version"};
inline constexpr Topic<lapis_msgs::msg::LandmarkTile> kLandmarks{"lapis/slam/landmarks", dds::kKeyedTiles, "slam",
                                                                 "changed tiles, at most 0.5 Hz",
                                                                 "landmarks and the key-frames that see them, by tile"};
inline constexpr Topic<lapis_msgs::msg::LandmarkState> kLandmarkState{"/slam/landmark_state", dds::kLatched, "slam",
                                                                      "after the tiles of a version",
                                                                      "graph version and checksum of the landmarks"};
inline constexpr Topic<lapis_msgs::msg::SlamStatus> kSlamStatus{"/slam/status", dds::kLatched, "slam",
                                                                "1 Hz and on change", "state, reason, counts"};

// semantic_mapper.
inline constexpr Topic<lapis_msgs::msg::MapDescription> kMapDescription{
    "/semantic_mapper/map_description", dds::kLatched, "semantic_mapper", "at the start and on change",
    "resolution, sensor model, settings of frames and labels of the map"};
inline constexpr Topic<lapis_msgs::msg::VoxelTile> kVoxelTiles{
    "lapis/semantic_mapper/tiles", dds::kKeyedTiles, "semantic_mapper", "changed tiles, at most 2 Hz",
    "counts of the map by tile (common/mapping/tile_codec.hpp)"};
inline constexpr Topic<lapis_msgs::msg::MapState> kMapState{"/semantic_mapper/map_state", dds::kLatched,
                                                            "semantic_mapper", "after the tiles of a version",
                                                            "version and checksum of the map"};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kObstacles{"/semantic_mapper/obstacles", dds::kLatched,
                                                                "semantic_mapper", "each frame, at most 17 Hz",
                                                                "from the last 10 s of frames"};
inline constexpr Topic<octomap_msgs::msg::Octomap> kOctomap{"/semantic_mapper/octomap", dds::kLatched,
                                                            "semantic_mapper", "at most 1 Hz",
                                                            "ColorOcTree in class colours; made only for readers"};
inline constexpr Topic<sensor_msgs::msg::PointCloud2> kMapPoints{
    "/semantic_mapper/points", dds::kLatched, "semantic_mapper", "at most 1 Hz",
    "occupied voxels: x y z rgb label probability; made only for readers"};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kOccupancyGrid{"/semantic_mapper/occupancy_grid", dds::kLatched,
                                                                    "semantic_mapper", "at most 1 Hz",
                                                                    "floor plan; made only for readers"};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kSaveMap{"/semantic_mapper/save", "semantic_mapper",
                                                               "save map.lapis, map.ot and map.ply now"};

// simulator.
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kPause{"/sim/pause", "simulator", "no further tick", true};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kRun{"/sim/run", "simulator", "go on after a pause", true};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kStep{"/sim/step", "simulator", "pause, but for one tick", true};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kReset{"/sim/reset", "simulator",
                                                             "back to the start and to time 0: a new run", true};

// planner and controller.
inline constexpr Topic<nav_msgs::msg::Path> kPlannerPath{"/planner/path", dds::kLatched, "planner", "on change",
                                                         "path to the chosen goal"};
inline constexpr Topic<lapis_msgs::msg::CandidateSet> kCandidates{
    "/planner/candidates", dds::kLatched, "planner", "each decision", "cost, information, utility of every candidate"};
inline constexpr Topic<visualization_msgs::msg::MarkerArray> kPlannerMarkers{
    "/planner/markers", dds::kLatched, "planner", "each decision",
    "frontiers, candidates, hallucinated graph; made only for readers"};
inline constexpr Topic<lapis_msgs::msg::PlannerStatus> kPlannerStatus{"/planner/status", dds::kLatched, "planner",
                                                                      "each frame and on change", "state and reason"};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kStartExploring{"/planner/start", "planner",
                                                                      "explore, also after a pause or the end"};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kStopExploring{"/planner/stop", "planner", "stand still, idle"};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kPauseExploring{"/planner/pause", "planner",
                                                                      "stand still until /planner/start"};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kReturnHome{"/planner/return_home", "planner",
                                                                  "drive to where exploration began"};
inline constexpr Topic<geometry_msgs::msg::Twist> kCommand{"/cmd_vel", dds::kCommand, "controller", "10 to 20 Hz",
                                                           "velocity command"};
inline constexpr Topic<nav_msgs::msg::Path> kLocalPath{"/controller/local_path", dds::kCommand, "controller",
                                                       "each command", "path that is being followed"};
inline constexpr Topic<lapis_msgs::msg::ControllerStatus> kControllerStatus{
    "/controller/status", dds::kLatched, "controller", "1 Hz and on change", "state and reason"};

// Everybody.
inline constexpr Topic<diagnostic_msgs::msg::DiagnosticArray> kDiagnostics{
    "/diagnostics",
    dds::kState,
    "all",
    "1 Hz and on change",
    "health, counters, CPU time and memory of the process",
    true};
inline constexpr Topic<lapis_msgs::msg::Heartbeat> kHeartbeat{"/heartbeat",
                                                              dds::kLatchedByMany,
                                                              "all",
                                                              "2 Hz and before long work",
                                                              "life, phase and activity, for the supervisor",
                                                              true};

/// Calls `visit` with every row of the table, in its order.
template <class Visitor>
void for_each(Visitor&& visit) {
  visit(kClock);
  visit(kTick);
  visit(kAck);
  visit(kColor);
  visit(kCompressedColor);
  visit(kDepth);
  visit(kColorInfo);
  visit(kDepthInfo);
  visit(kLabels);
  visit(kLabelConfidence);
  visit(kLabelInfo);
  visit(kWheelOdometry);
  visit(kImu);
  visit(kGroundTruth);
  visit(kCollision);
  visit(kTransforms);
  visit(kStaticTransforms);
  visit(kSlamOdometry);
  visit(kTrackedFrame);
  visit(kKeyframePath);
  visit(kPoseGraph);
  visit(kLandmarks);
  visit(kLandmarkState);
  visit(kSlamStatus);
  visit(kMapDescription);
  visit(kVoxelTiles);
  visit(kMapState);
  visit(kObstacles);
  visit(kOctomap);
  visit(kMapPoints);
  visit(kOccupancyGrid);
  visit(kPlannerPath);
  visit(kCandidates);
  visit(kPlannerMarkers);
  visit(kPlannerStatus);
  visit(kCommand);
  visit(kLocalPath);
  visit(kControllerStatus);
  visit(kDiagnostics);
  visit(kHeartbeat);
}

/// Calls `visit` with every service.
template <class Visitor>
void for_each_service(Visitor&& visit) {
  visit(kSaveMap);
  visit(kPause);
  visit(kRun);
  visit(kStep);
  visit(kReset);
  visit(kStartExploring);
  visit(kStopExploring);
  visit(kPauseExploring);
  visit(kReturnHome);
}

}  // namespace lapis::topics
