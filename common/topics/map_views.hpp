#pragma once

#include "common/dds/topic.hpp"
#include "idl/octomap_msgs.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::topics {

// The semantic map for viewers.
inline constexpr dds::Topic<octomap_msgs::msg::Octomap> kOctomap{"/semantic_mapper/octomap", dds::kLatched,
                                                                 "semantic_mapper", "at most 1 Hz",
                                                                 "ColorOcTree in class colours; made only for readers"};
inline constexpr dds::Topic<sensor_msgs::msg::PointCloud2> kMapPoints{
    "/semantic_mapper/points", dds::kLatched, "semantic_mapper", "at most 1 Hz",
    "occupied voxels: x y z rgb label probability; made only for readers"};

}  // namespace lapis::topics
