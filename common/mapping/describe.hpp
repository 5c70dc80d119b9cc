#pragma once

// Configuration keys of the map's structs, for the process that builds it; others read them with the map. The range is
// the robot's (robot.sensing_range_m).

#include "common/config/schema.hpp"
#include "common/mapping/compact_frame.hpp"
#include "common/mapping/integration.hpp"
#include "common/mapping/sensor_model.hpp"

namespace lapis::mapping {

template <class Field>
void describe(Field& field, IntegrationConfig& c) {
  field("min_range_m", c.min_range_m, config::in_range(0.0, 5.0), "measurements nearer than this say nothing [m]");
  field("min_height_m", c.min_height_m, config::in_range(-1000.0, 1000.0),
        "voxels whose centre is lower in the map frame get no votes [m]");
  field("max_height_m", c.max_height_m, config::in_range(-1000.0, 1000.0),
        "voxels whose centre is higher get no votes [m]");
  field("end_margin_voxels", c.end_margin_voxels, config::in_range(0.0, 3.0),
        "a voxel gets a miss only if the ray leaves it at least this far before the measured surface");
  field("depth_noise_per_m", c.depth_noise_per_m, config::in_range(0.0, 0.05),
        "standard deviation of depth z is this times z^2; a hit weighs less where it is not small against a voxel, and "
        "misses keep two of them away from the surface [1/m]");
}

template <class Field>
void describe(Field& field, CompactFrameConfig& c) {
  field("stride", c.stride, config::in_range(1, 16), "every stride-th pixel of every stride-th row is kept");
}

template <class Field>
void describe(Field& field, SensorModel& c) {
  field("hit_gain", c.hit_gain, config::in_range(0.01, 5.0), "log-odds gain of occupied by a first hit");
  field("miss_gain", c.miss_gain, config::in_range(0.01, 5.0), "log-odds loss of occupied by a miss");
  field("label_accuracy", c.label_accuracy, config::in_range(0.05, 0.999), "probability that a label is right");
  field("fusion", c.fusion, config::one_of({"log_odds", "dirichlet", "bki"}), "rule by which counts become beliefs");
  field("prior_votes", c.prior_votes, config::in_range(0.01, 1000.0),
        "of dirichlet and bki: so many votes weigh as much as the prior");
  field("prior_occupied", c.prior_occupied, config::in_range(0.001, 0.999), "of a voxel that was never observed");
}

}  // namespace lapis::mapping
