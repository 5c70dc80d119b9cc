#pragma once

// The topic table: all names, types and QoS settings that Lapis's processes agree on. docs/topics.md is printed from
// it. Source files include only the groups of topics that they use, because all groups together cost seconds of compile
// time.

#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/heartbeat.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/map.hpp"
#include "common/topics/map_views.hpp"
#include "common/topics/node.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/planner_views.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::topics {

/// Frames that a process names by itself, not by what a message says.
inline constexpr const char* kFrames[] = {
    "map", "odom", "base_link", "camera_link", "camera_color_optical_frame", "camera_depth_optical_frame"};

/// Calls `visit` with every row of the table, in its order.
template <class Visitor>
void for_each(Visitor&& visit) {
  visit(kClock);
  visit(kTick);
  visit(kAck);
  visit(kColor);
  visit(kCompressedColor);
  visit(kDepth);
  visit(kCompressedDepth);
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
  visit(kDepthEstimate);
  visit(kMapDescription);
  visit(kVoxelTiles);
  visit(kMapState);
  visit(kObstacles);
  visit(kOctomap);
  visit(kMapPoints);
  visit(kOccupancyGrid);
  visit(kProvisionalArea);
  visit(kPlannerPath);
  visit(kGoal);
  visit(kCandidates);
  visit(kPlannerMarkers);
  visit(kPlannerStatus);
  visit(kCommand);
  visit(kTeleop);
  visit(kLocalPath);
  visit(kControllerStatus);
  visit(kDiagnostics);
  visit(kRosout);
  visit(kParameterEvents);
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
  visit(kSnapshot);
}

/// Calls `visit` with every service that each process has under its own name.
template <class Visitor>
void for_each_node_service(Visitor&& visit) {
  visit(kListParameters);
  visit(kGetParameters);
  visit(kGetParameterTypes);
  visit(kDescribeParameters);
  visit(kSetParameters);
  visit(kSetParametersAtomically);
  visit(kGetTypeDescription);
}

}  // namespace lapis::topics
