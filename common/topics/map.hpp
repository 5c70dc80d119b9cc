#pragma once

#include "common/dds/topic.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"

namespace lapis::topics {

// The semantic map.
inline constexpr dds::Topic<lapis_msgs::msg::MapDescription> kMapDescription{
    "/semantic_mapper/map_description", dds::kLatched, "semantic_mapper", "at the start and on change",
    "resolution, sensor model, settings of frames and labels of the map"};
inline constexpr dds::Topic<lapis_msgs::msg::VoxelTile> kVoxelTiles{
    "lapis/semantic_mapper/tiles", dds::kKeyedTiles, "semantic_mapper", "changed tiles, at most 2 Hz",
    "counts of the map by tile (common/mapping/wire/tile_codec.hpp)"};
inline constexpr dds::Topic<lapis_msgs::msg::MapState> kMapState{"/semantic_mapper/map_state", dds::kLatched,
                                                                 "semantic_mapper", "after the tiles of a version",
                                                                 "version and checksum of the map"};
inline constexpr dds::Topic<nav_msgs::msg::OccupancyGrid> kObstacles{"/semantic_mapper/obstacles", dds::kLatched,
                                                                     "semantic_mapper", "each frame, at most 17 Hz",
                                                                     "from the last 10 s of frames"};
inline constexpr dds::Topic<nav_msgs::msg::OccupancyGrid> kOccupancyGrid{
    "/semantic_mapper/occupancy_grid", dds::kLatched, "semantic_mapper", "at most 1 Hz",
    "floor plan; made only for readers"};
inline constexpr dds::Topic<nav_msgs::msg::OccupancyGrid> kProvisionalArea{
    "/map/provisional", dds::kLatched, "semantic_mapper", "on change, at most 1 Hz",
    "0 where frames have looked that wait for a corrected pose to enter the map"};

}  // namespace lapis::topics
