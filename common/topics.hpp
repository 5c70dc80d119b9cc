#pragma once

// The topic table: every name, type and QoS that Lapis's processes promise each other (design section 4).
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
inline constexpr Topic<rosgraph_msgs::msg::Clock> kClock{"/clock", {.depth = 10, .urgent = true}, true};
inline constexpr Topic<lapis_msgs::msg::Tick> kTick{"/sim/tick", dds::kLockstep, true};
inline constexpr Topic<lapis_msgs::msg::Ack> kAck{"/sim/ack", dds::kLockstep, true};

// Sensors.
inline constexpr Topic<sensor_msgs::msg::Image> kColor{"/camera/color/image_raw", dds::kSensor};
inline constexpr Topic<sensor_msgs::msg::Image> kDepth{"/camera/depth/image_raw", dds::kSensor};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kColorInfo{"/camera/color/camera_info", dds::kSensor};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kDepthInfo{"/camera/depth/camera_info", dds::kSensor};
inline constexpr Topic<sensor_msgs::msg::Image> kLabels{"/camera/semantic/image_raw", dds::kSensor};
inline constexpr Topic<sensor_msgs::msg::Image> kLabelConfidence{"/camera/semantic/confidence", dds::kSensor};
inline constexpr Topic<vision_msgs::msg::LabelInfo> kLabelInfo{"/camera/semantic/label_info", dds::kLatched};
inline constexpr Topic<nav_msgs::msg::Odometry> kWheelOdometry{"/odom", dds::kState};
inline constexpr Topic<sensor_msgs::msg::Imu> kImu{"/imu", dds::kState};

// Ground truth: only the evaluator and tests may read these.
inline constexpr Topic<nav_msgs::msg::Odometry> kGroundTruth{"/ground_truth/odom", dds::kFrameState};
inline constexpr Topic<std_msgs::msg::Bool> kCollision{"/ground_truth/collision", dds::kState};

// Transforms.
inline constexpr Topic<tf2_msgs::msg::TFMessage> kTransforms{"/tf", dds::kTransform, true};
inline constexpr Topic<tf2_msgs::msg::TFMessage> kStaticTransforms{"/tf_static", dds::kLatched, true};

// slam.
inline constexpr Topic<nav_msgs::msg::Odometry> kSlamOdometry{"/slam/odometry", dds::kFrameState};
inline constexpr Topic<lapis_msgs::msg::TrackedFrame> kTrackedFrame{"/slam/frame", dds::kFrameState};
inline constexpr Topic<nav_msgs::msg::Path> kKeyframePath{"/slam/path", dds::kLatched};
inline constexpr Topic<lapis_msgs::msg::PoseGraph> kPoseGraph{"/slam/pose_graph", dds::kLatched};
inline constexpr Topic<lapis_msgs::msg::LandmarkTile> kLandmarks{"lapis/slam/landmarks", dds::kKeyedTiles};
inline constexpr Topic<lapis_msgs::msg::SlamStatus> kSlamStatus{"/slam/status", dds::kLatched};

// semantic_mapper.
inline constexpr Topic<lapis_msgs::msg::VoxelTile> kVoxelTiles{"lapis/semantic_mapper/tiles", dds::kKeyedTiles};
inline constexpr Topic<lapis_msgs::msg::MapState> kMapState{"/semantic_mapper/map_state", dds::kLatched};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kObstacles{"/semantic_mapper/obstacles", dds::kLatched};
inline constexpr Topic<octomap_msgs::msg::Octomap> kOctomap{"/semantic_mapper/octomap", dds::kLatched};
inline constexpr Topic<sensor_msgs::msg::PointCloud2> kMapPoints{"/semantic_mapper/points", dds::kLatched};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kOccupancyGrid{"/semantic_mapper/occupancy_grid", dds::kLatched};
inline constexpr ServiceTopic<std_srvs::srv::Trigger> kSaveMap{"/semantic_mapper/save"};

// planner and controller.
inline constexpr Topic<nav_msgs::msg::Path> kPlannerPath{"/planner/path", dds::kLatched};
inline constexpr Topic<lapis_msgs::msg::CandidateSet> kCandidates{"/planner/candidates", dds::kLatched};
inline constexpr Topic<visualization_msgs::msg::MarkerArray> kPlannerMarkers{"/planner/markers", dds::kLatched};
inline constexpr Topic<lapis_msgs::msg::PlannerStatus> kPlannerStatus{"/planner/status", dds::kLatched};
inline constexpr Topic<geometry_msgs::msg::Twist> kCommand{"/cmd_vel", dds::kCommand};
inline constexpr Topic<nav_msgs::msg::Path> kLocalPath{"/controller/local_path", dds::kCommand};
inline constexpr Topic<lapis_msgs::msg::ControllerStatus> kControllerStatus{"/controller/status", dds::kLatched};

// Everybody.
inline constexpr Topic<diagnostic_msgs::msg::DiagnosticArray> kDiagnostics{"/diagnostics", dds::kState, true};

}  // namespace lapis::topics
