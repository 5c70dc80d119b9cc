#pragma once

#include "common/dds/topic.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::topics {

// What slam publishes.
inline constexpr dds::Topic<nav_msgs::msg::Odometry> kSlamOdometry{
    "/slam/odometry", dds::kFrameState, "slam", "camera rate",
    "pose of base_link in the map, with covariance; nothing while lost"};
inline constexpr dds::Topic<lapis_msgs::msg::TrackedFrame> kTrackedFrame{
    "/slam/frame", dds::kFrameState, "slam", "camera rate",
    "state and pose of each frame relative to its reference key-frame"};
inline constexpr dds::Topic<nav_msgs::msg::Path> kKeyframePath{"/slam/path", dds::kLatched, "slam",
                                                               "on change, at most 2 Hz", "key-frame trajectory"};
inline constexpr dds::Topic<lapis_msgs::msg::PoseGraph> kPoseGraph{"/slam/pose_graph", dds::kLatched, "slam",
                                                                   "on change, at most 2 Hz",
                                                                   "nodes and edges with information, one version"};
inline constexpr dds::Topic<lapis_msgs::msg::LandmarkTile> kLandmarks{
    "lapis/slam/landmarks", dds::kKeyedTiles, "slam", "changed tiles, at most 0.5 Hz",
    "landmarks and the key-frames that see them, by tile"};
inline constexpr dds::Topic<lapis_msgs::msg::LandmarkState> kLandmarkState{
    "/slam/landmark_state", dds::kLatched, "slam", "after the tiles of a version",
    "graph version and checksum of the landmarks"};
inline constexpr dds::Topic<lapis_msgs::msg::SlamStatus> kSlamStatus{"/slam/status", dds::kLatched, "slam",
                                                                     "1 Hz and on change", "state, reason, counts"};
inline constexpr dds::Topic<sensor_msgs::msg::CameraInfo> kDepthEstimate{
    "/slam/depth_camera_info", dds::kLatched, "slam", "on change, with slam.depth_calibration: estimate",
    "the depth camera as slam has found it: r and p say where it is beside colour, as of a stereo camera; p has the "
    "focal "
    "lengths of colour as slam has found them"};

}  // namespace lapis::topics
