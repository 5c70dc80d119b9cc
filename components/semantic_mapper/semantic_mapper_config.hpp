#pragma once

#include <string>

#include "common/config/schema.hpp"
#include "semantic_mapper/core/export.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"

namespace lapis::semantic_mapper {

/// What the process adds to the map's configuration.
struct SemanticMapperComponentConfig {
  MapperConfig map;
  mapping::CompactFrameConfig frame;
  mapping::SensorModel sensor_model;
  GridConfig grid;
  double max_stamp_difference_s = 0.016;
  double frame_interval_s = 0.0;
  double tile_period_s = 0.5;
  double view_period_s = 1.0;
  int re_anchored_frames_per_cycle = 20;
  std::string output_dir;
  double save_period_s = 30.0;
};

}  // namespace lapis::semantic_mapper

namespace lapis::mapping {

template <class Field>
void describe(Field& field, IntegrationConfig& c) {
  field("min_range_m", c.min_range_m, config::in_range(0.0, 5.0), "measurements nearer than this say nothing [m]");
  field("max_range_m", c.max_range_m, config::in_range(0.5, 20.0),
        "Euclidean; returns beyond carve free space up to here [m]");
  field("min_height_m", c.min_height_m, config::in_range(-1000.0, 1000.0),
        "voxels whose centre is lower in the map frame get no votes [m]");
  field("max_height_m", c.max_height_m, config::in_range(-1000.0, 1000.0),
        "voxels whose centre is higher get no votes [m]");
  field("end_margin_voxels", c.end_margin_voxels, config::in_range(0.0, 3.0),
        "a voxel is passed only if the ray leaves it at least this far before the measured surface");
  field("depth_noise_per_m", c.depth_noise_per_m, config::in_range(0.0, 0.05),
        "standard deviation of depth z is this times z^2; passes keep two of them away from the surface [1/m]");
}

template <class Field>
void describe(Field& field, CompactFrameConfig& c) {
  field("stride", c.stride, config::in_range(1, 16), "every stride-th pixel of every stride-th row is kept");
}

template <class Field>
void describe(Field& field, SensorModel& c) {
  field("hit_gain", c.hit_gain, config::in_range(0.01, 5.0), "log-odds gain of occupied by a first hit");
  field("pass_gain", c.pass_gain, config::in_range(0.01, 5.0), "log-odds loss of occupied by a pass");
  field("label_accuracy", c.label_accuracy, config::in_range(0.05, 0.999), "probability that a label is right");
  field("prior_occupied", c.prior_occupied, config::in_range(0.001, 0.999), "of a voxel that was never observed");
}

}  // namespace lapis::mapping

namespace lapis::semantic_mapper {

template <class Field>
void describe(Field& field, GridConfig& c) {
  field("min_height_m", c.min_height_m, config::in_range(-100.0, 100.0), "voxels whose centre is below say nothing [m]");
  field("max_height_m", c.max_height_m, config::in_range(-100.0, 100.0), "voxels whose centre is above say nothing [m]");
}

template <class Field>
void describe(Field& field, SemanticMapperComponentConfig& c) {
  field("resolution_m", c.map.resolution_m, config::in_range(0.02, 0.5), "edge of a voxel [m]");
  field("tile_edge_m", c.map.tile_edge_m, config::in_range(0.1, 6.4), "least edge of a tile [m]");
  field("integration", c.map.integration);
  field("frame", c.frame);
  field("sensor_model", c.sensor_model);
  field("grid", c.grid);
  field("re_anchor", c.map.re_anchor, config::anything(), "frames follow the pose graph; false: the paper's frozen map");
  field("re_anchor_threshold_voxels", c.map.re_anchor_threshold_voxels, config::in_range(0.0, 10.0),
        "a frame is moved when a point at its median depth is off by more");
  field("re_anchored_frames_per_cycle", c.re_anchored_frames_per_cycle, config::in_range(1, 10000),
        "bound of the work per cycle");
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.1),
        "between pose, depth, labels and camera info of one frame [s]");
  field("frame_interval_s", c.frame_interval_s, config::in_range(0.0, 60.0),
        "least time between integrated frames, by their stamps [s]");
  field("tile_period_s", c.tile_period_s, config::in_range(0.0, 60.0), "least time between published versions [s]");
  field("view_period_s", c.view_period_s, config::in_range(0.0, 60.0),
        "least time between octomap, points and occupancy grid, which are made only for readers [s]");
  field("output_dir", c.output_dir, config::anything(), "folder for map.lapis, map.ot and map.ply; empty: none");
  field("save_period_s", c.save_period_s, config::in_range(1.0, 86400.0), "time between saves, by the frames' stamps [s]");
}

}  // namespace lapis::semantic_mapper
