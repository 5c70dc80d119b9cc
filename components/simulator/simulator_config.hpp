#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/config/schema.hpp"
#include "common/robot/robot_description.hpp"
#include "common/runtime/lockstep_driver.hpp"

namespace lapis::simulator {

struct NoiseConfig {
  std::string depth = "kinect";
  double depth_multiplier = 1.0;
  std::string labels = "default";
  bool color = true;
  double contrast = 1.0;
  double shutter = 0.0;
  bool odometry = true;
  std::string drift = "nominal";
};

struct WheelConfig {
  bool odometry = true;
  double least_noise = 1.0, most_noise = 1.0;
  double radius_error = 0.0, base_error = 0.0;
  double turn_slip = 0.0;
};

struct SceneConfig {
  std::string furniture_folder = "/usr/share/sweethome3d/furniture";
  bool jitter = true;
  double texture_richness = 1.0;
  double picture_density = 1.0;
  config::Words passable_classes;
  std::string light_folder;
};

struct SimulatorConfig {
  std::string scene;
  std::int64_t seed = 1;
  std::string mode = "lockstep";
  double max_real_time_factor = 0.0;
  double duration_s = 0.0;
  bool ends_when_explored = false;
  std::string tour;
  double tour_revisit_every_m = 0.0;
  std::string start;
  std::string output_dir;
  int wait_for_readers = 0;
  int render_threads = 1;
  bool imu = false;
  double planner_margin_m = 0.05;
  bool full_map = false;
  SceneConfig world;
  NoiseConfig noise;
  WheelConfig wheels;
  robot::RobotDescription robot;
  runtime::LockstepConfig lockstep{.stages = {"slam", "semantic_mapper", "evaluator"}};
  // Set on the command line only:
  bool validate = false;
  bool credits = false;
  std::optional<std::uint64_t> generated_seed;
  std::string generated_kind = "flat";
  bool generates_panes = false;
  std::string snapshot_dir;
  std::string export_dir;
  std::string truth_dir;
};

template <class Field>
void describe(Field& field, NoiseConfig& c) {
  field("depth", c.depth, config::one_of({"none", "kinect", "redwood", "realsense"}), "model of the depth camera");
  field("depth_multiplier", c.depth_multiplier, config::in_range(0.0, 10.0), "scales its standard deviations");
  field("labels", c.labels, config::one_of({"none", "default"}), "model of the segmentation");
  field("color", c.color, config::anything(), "noise of the colour camera");
  field("contrast", c.contrast, config::in_range(0.0, 2.0), "factor on the contrast of colour images");
  field("shutter", c.shutter, config::in_range(0.0, 1.0),
        "share of the time between frames that the shutter is open: blurs what moves");
  field("odometry", c.odometry, config::anything(), "noise and systematic errors of wheel odometry");
  field.moved("wheels", "simulator.noise.odometry");
  field("drift", c.drift, config::one_of({"nominal", "hard"}),
        "how hard localisation is: texture, blur, noise and dropouts of depth, and noise of odometry together");
}

template <class Field>
void describe(Field& field, WheelConfig& c) {
  field("odometry", c.odometry, config::anything(), "publish /odom and the transform odom -> base_link");
  field("least_noise", c.least_noise, config::in_range(0.0, 10.0),
        "the seed draws a factor on the standard deviations of odometry's noise: from here");
  field("most_noise", c.most_noise, config::in_range(0.0, 10.0), "to here");
  field("radius_error", c.radius_error, config::in_range(0.0, 0.2),
        "the wheels' radius is wrong by up to this share, as the seed draws; 0: by 1 % (standard deviation)");
  field("base_error", c.base_error, config::in_range(0.0, 0.2), "the same for the wheel base");
  field("turn_slip", c.turn_slip, config::in_range(0.0, 0.5),
        "odometry counts up to this share more of a turn than was turned, as the seed draws for each turn");
}

template <class Field>
void describe(Field& field, SceneConfig& c) {
  field("furniture_folder", c.furniture_folder, config::anything(),
        "libraries of the Debian package sweethome3d-furniture; without them parametric furniture stands in");
  field("jitter", c.jitter, config::anything(), "the seed moves what is movable, and pictures, a little");
  field("texture_richness", c.texture_richness, config::in_range(0.0, 2.0), "scales the contrast of textures");
  field("picture_density", c.picture_density, config::in_range(0.0, 1.0), "share of the pictures that hang");
  field("passable_classes", c.passable_classes, config::anything(),
        "names of classes that the robot drives through, such as closed doors of a scan");
  field("light_folder", c.light_folder, config::anything(),
        "where baked light is kept; empty: lapis/light in the user's cache folder");
}

template <class Field>
void describe(Field& field, SimulatorConfig& c) {
  field("scene", c.scene, config::anything(),
        "name of a bundled scene, KIND_SEED of a generated building, a scene file (.yaml), or a file or folder of "
        "another "
        "format (docs/scenes.md)");
  field("seed", c.seed, config::at_least(0), "draws start, noise, systematic errors, label confusion, jitter");
  field("mode", c.mode, config::one_of({"lockstep", "freerun"}),
        "lockstep: every frame is answered by all before the next; freerun: by the wall clock, frames may be lost");
  field("max_real_time_factor", c.max_real_time_factor, config::in_range(0.0, 100.0),
        "lock-step is not faster than this; 0: as fast as the machine");
  field("duration_s", c.duration_s, config::in_range(0.0, 1e6),
        "simulated time after which the run ends [s]; 0: never");
  field("ends_when_explored", c.ends_when_explored, config::anything(),
        "the run ends, too, when /planner/status says DONE, GAVE_UP or FAILED");
  field("tour", c.tour, config::anything(),
        "\"bundled\", or a file with waypoints, that the robot drives by itself; empty: it obeys /cmd_vel");
  field("tour_revisit_every_m", c.tour_revisit_every_m, config::in_range(0.0, 1000.0),
        "after a path of this length each, the tour goes back to an old place and comes back; 0: never [m]");
  field("start", c.start, config::anything(), "\"x y yaw_deg\" [m, m, deg]; empty: drawn by the seed");
  field("output_dir", c.output_dir, config::anything(),
        "run folder for simulation.yaml and ground_truth/; empty: none");
  field("wait_for_readers", c.wait_for_readers, config::in_range(0, 100),
        "freerun: begin when the depth topic has this many readers");
  field("render_threads", c.render_threads, config::in_range(1, 64), "images do not depend on it");
  field("imu", c.imu, config::anything(), "publish /imu at 200 Hz");
  field("planner_margin_m", c.planner_margin_m, config::in_range(0.0, 1.0),
        "that a planner keeps around the robot (planner.grid.margin_m): ground truth says what can be seen then, too "
        "[m]");
  field("full_map", c.full_map, config::anything(),
        "ground truth has a map of the whole building, too, from frames without noise (full.lapis): the paper's "
        "reference. It is made once for a building and start, and kept in the user's cache folder");
  field("world", c.world);
  field("noise", c.noise);
  field("wheels", c.wheels);
  field.moved("truth", "semantic_mapper", "ground truth is built as /semantic_mapper/map_description says");
}

}  // namespace lapis::simulator
