#pragma once

#include <string>

#include "common/robot/robot_description.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"

namespace lapis::semantic_mapper {

/// What the process adds to the map's configuration.
struct SemanticMapperComponentConfig {
  MapperConfig map;
  mapping::CompactFrameConfig frame;
  mapping::SensorModel sensor_model;
  double kernel_length_voxels = 2.0;
  ObstacleConfig obstacles;
  double max_stamp_difference_s = 0.016;
  double frame_interval_s = 0.0;
  double tile_period_s = 0.5;
  double view_period_s = 1.0;
  double obstacle_period_s = 0.06;  // each frame at 15 Hz; the controller stops when none come
  int re_anchor_work_per_cycle = 1'000'000;
  std::string resume_from;
  bool resume_any_session = true;
  std::string output_dir;
  double save_period_s = 30.0;
  robot::RobotDescription robot;
};

template <class Field>
void describe(Field& field, ObstacleConfig& c) {
  field("window_s", c.window_s, config::in_range(0.1, 600.0), "what was seen longer ago is forgotten [s]");
  field("misses_to_clear", c.misses_to_clear, config::in_range(1, 100),
        "frames that must look through an obstacle before it is gone");
  field.moved("passes_to_clear", "semantic_mapper.obstacles.misses_to_clear");
}

template <class Field>
void describe(Field& field, FrameStoreConfig& c) {
  field("memory_mb", c.memory_mb, config::in_range(0, 1'000'000),
        "memory for frames that may have to move; the oldest beyond it wait on disk [MB]");
  field("spill_dir", c.spill_dir, config::anything(),
        "folder for them, in a file without a name; a frame that does not fit stays in the map where it is");
}

template <class Field>
void describe(Field& field, SemanticMapperComponentConfig& c) {
  field("resolution_m", c.map.resolution_m, config::in_range(0.02, 0.5), "edge of a voxel [m]");
  field("tile_edge_m", c.map.tile_edge_m, config::in_range(0.1, 6.4), "least edge of a tile [m]");
  field("integration", c.map.integration);
  field("frame", c.frame);
  field("sensor_model", c.sensor_model);
  field.moved("sensor_model.pass_gain", "semantic_mapper.sensor_model.miss_gain");
  field("kernel_length_voxels", c.kernel_length_voxels,
        config::in_range(mapping::kMinKernelLength_voxels, mapping::kMaxKernelLength_voxels),
        "of the kernel by which hits vote for the voxels of other hits around them, with sensor_model.fusion: bki");
  field.moved("grid.min_height_m", "robot.obstacle_min_height_m");
  field.moved("grid.max_height_m", "robot.obstacle_max_height_m");
  field("obstacles", c.obstacles);
  field("re_anchor", c.map.re_anchor, config::anything(),
        "frames follow the pose graph; false: the paper's frozen map, no frames are stored");
  field("re_anchor_threshold_voxels", c.map.re_anchor_threshold_voxels, config::in_range(0.0, 10.0),
        "a frame is moved when a point at its median depth is off by more");
  field("re_anchor_work_per_cycle", c.re_anchor_work_per_cycle, config::in_range(1, 1'000'000'000),
        "frames are moved until their samples and votes exceed this; the next cycle continues");
  field("stored_frames", c.map.stored_frames);
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.1),
        "between pose, depth, labels and camera info of one frame [s]");
  field("frame_interval_s", c.frame_interval_s, config::in_range(0.0, 60.0),
        "least time between integrated frames, by their stamps [s]");
  field("tile_period_s", c.tile_period_s, config::in_range(0.0, 60.0), "least time between published versions [s]");
  field("view_period_s", c.view_period_s, config::in_range(0.0, 60.0),
        "least time between octomap, points and occupancy grid, which are made only for readers [s]");
  field("obstacle_period_s", c.obstacle_period_s, config::in_range(0.0, 60.0),
        "least time between obstacle grids, by the frames' stamps [s]");
  field("resume_from", c.resume_from, config::anything(),
        "map.lapis of an earlier run to resume, beside slam.resume_from; empty: none");
  field(
      "resume_any_session", c.resume_any_session, config::anything(),
      "with a session that slam.resume_from has made, too; false: a new map begins unless slam still runs that the map "
      "was made with");
  field("output_dir", c.output_dir, config::anything(), "folder for map.lapis, map.ot and map.ply; empty: none");
  field("save_period_s", c.save_period_s, config::in_range(1.0, 86400.0),
        "time between saves, by the frames' stamps [s]");
}

}  // namespace lapis::semantic_mapper
