#pragma once

#include <string>

#include "common/mapping/file/map_description.hpp"
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
  double max_stamp_difference_s = 0.0;
  double label_wait_s = 1.5;
  double frame_interval_s = 0.0;
  double tile_period_s = 0.5;
  double view_period_s = 1.0;
  double obstacle_period_s = 0.06;  // each frame at 15 Hz; the controller stops when none come
  int re_anchor_work_per_cycle = 1'000'000;
  std::string resume_from;
  bool resume_any_session = true;
  std::string output_dir;
  double save_period_s = 30.0;
  bool keep_frames = false;
  robot::RobotDescription robot;
};

/// How frames enter the map.
inline mapping::FrameSettings frame_settings(const SemanticMapperComponentConfig& config) {
  return {config.map.integration, config.frame.stride};
}

/// Reads what counts say about these classes.
inline mapping::BeliefReader belief_reader(const SemanticMapperComponentConfig& config,
                                           const mapping::LabelList& labels) {
  return mapping::BeliefReader(mapping::with_classes(config.sensor_model, labels));
}

template <class Field>
void describe(Field& field, ObstacleConfig& c) {
  field("window_s", c.window_s, config::in_range(0.1, 600.0),
        "time after which the obstacle layer forgets a voxel that no frame has seen again [s]");
  field("misses_to_clear", c.misses_to_clear, config::in_range(1, 100),
        "number of frames that must look through a voxel after its last hit until the obstacle layer takes it as free");
  field.moved("passes_to_clear", "semantic_mapper.obstacles.misses_to_clear");
}

template <class Field>
void describe(Field& field, FrameStoreConfig& c) {
  field("memory_mb", c.memory_mb, config::in_range(0, 1'000'000),
        "memory for the frames that re-anchoring may move; beyond it, the oldest frames are kept on disk [MiB]");
  field("spill_dir", c.spill_dir, config::anything(),
        "folder of the unnamed file for stored frames beyond memory_mb; a frame that the disk does not take keeps its "
        "place in the map");
}

/// Keys of what is published when, and of files.
template <class Field>
void describe_output(Field& field, SemanticMapperComponentConfig& c) {
  field("tile_period_s", c.tile_period_s, config::in_range(0.0, 60.0),
        "shortest time between published versions of the map's tiles, by the frames' time stamps [s]",
        config::Change::kAtRunTime);
  field("view_period_s", c.view_period_s, config::in_range(0.0, 60.0),
        "shortest time between publications of octomap, points, occupancy grid (these only while they have a reader) "
        "and /map/provisional [s]",
        config::Change::kAtRunTime);
  field("obstacle_period_s", c.obstacle_period_s, config::in_range(0.0, 60.0),
        "shortest time between publications of the obstacle grid, by the frames' time stamps [s]",
        config::Change::kAtRunTime);
  field("resume_from", c.resume_from, config::anything(),
        "map.lapis of an earlier run, whose map the mapper resumes (set slam.resume_from, too), or frames.lapis of "
        "this session of slam, from which it rebuilds the map; empty: the mapper begins a new map");
  field("resume_any_session", c.resume_any_session, config::anything(),
        "whether the map of a map.lapis continues in a later session of slam, too; false: only in the session that "
        "made it, else a new map begins");
  field("output_dir", c.output_dir, config::anything(),
        "folder for map.lapis, map.ot and map.ply; empty: the mapper saves no map");
  field("save_period_s", c.save_period_s, config::in_range(1.0, 86400.0),
        "time between saves of the map in output_dir, by the frames' time stamps [s]");
  field("keep_frames", c.keep_frames, config::anything(),
        "whether the mapper appends every integrated frame to frames.lapis in output_dir, so that a restarted mapper "
        "can rebuild the map (resume_from: frames.lapis), and its frames follow the pose graph again");
}

template <class Field>
void describe(Field& field, SemanticMapperComponentConfig& c) {
  field("resolution_m", c.map.resolution_m, config::in_range(0.02, 0.5), "edge length of a voxel of the map [m]");
  field("tile_edge_m", c.map.tile_edge_m, config::in_range(0.1, 6.4),
        "smallest edge length of a published map tile; it doubles when the map has too many tiles (README) [m]");
  field("integration", c.map.integration);
  field("frame", c.frame);
  field("sensor_model", c.sensor_model);
  field.moved("sensor_model.pass_gain", "semantic_mapper.sensor_model.miss_gain");
  field("kernel_length_voxels", c.kernel_length_voxels,
        config::in_range(mapping::kMinKernelLength_voxels, mapping::kMaxKernelLength_voxels),
        "radius within which a hit votes for other voxels with hits; only with sensor_model.fusion: bki [voxels]");
  field.moved("grid.min_height_m", "robot.obstacle_min_height_m");
  field.moved("grid.max_height_m", "robot.obstacle_max_height_m");
  field("obstacles", c.obstacles);
  field("re_anchor", c.map.re_anchor, config::anything(),
        "whether frames in the map follow corrections of the pose graph; false: the paper's frozen map, in which no "
        "frames are stored");
  field("re_anchor_threshold_voxels", c.map.re_anchor_threshold_voxels, config::in_range(0.0, 10.0),
        "displacement of a point at a frame's median depth beyond which the mapper moves the frame to its corrected "
        "pose [voxels]");
  field("re_anchor_work_per_cycle", c.re_anchor_work_per_cycle, config::in_range(1, 1'000'000'000),
        "number of samples and votes of moved frames at which re-anchoring stops until the next cycle; it moves at "
        "least one frame");
  field("stored_frames", c.map.stored_frames);
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.5),
        "largest difference between the stamps of pose, depth, labels and camera info of a frame; 0: 0.6 of the "
        "camera's period, at most 0.12 s [s]");
  field("label_wait_s", c.label_wait_s, config::in_range(0.0, 3.0),
        "how much newer a frame of slam may be than one that still waits for its labels, where somebody publishes "
        "labels; then the older one enters the map without them. Obstacles do not wait. At most 90 frames wait. In "
        "lock-step each frame has its labels, or none come [s]");
  field("frame_interval_s", c.frame_interval_s, config::in_range(0.0, 60.0),
        "shortest time between integrated frames, by their time stamps; 0: every frame is integrated [s]");
  describe_output(field, c);
}

}  // namespace lapis::semantic_mapper
