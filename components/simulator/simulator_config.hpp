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
  double speed_error = 0.0, turn_error = 0.0, command_noise = 0.0;
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
  bool labels = true;
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
  field("depth", c.depth, config::one_of({"none", "kinect", "redwood", "realsense"}),
        "noise model of the depth camera; none: exact depth");
  field("depth_multiplier", c.depth_multiplier, config::in_range(0.0, 10.0),
        "factor on the standard deviations of depth noise");
  field("labels", c.labels, config::one_of({"none", "default"}),
        "error model of the semantic segmentation; none: true labels");
  field("color", c.color, config::anything(), "whether colour images have noise");
  field("contrast", c.contrast, config::in_range(0.0, 2.0), "factor on the contrast of colour images");
  field("shutter", c.shutter, config::in_range(0.0, 1.0),
        "exposure time of colour images as a share of the time between frames; turns of the camera blur the image");
  field("odometry", c.odometry, config::anything(), "whether wheel odometry has noise and systematic errors");
  field.moved("wheels", "simulator.noise.odometry");
  field("drift", c.drift, config::one_of({"nominal", "hard"}),
        "preset for how hard localisation is; hard: lower contrast, motion blur, noisier depth with dropouts, and "
        "noisier odometry");
}

template <class Field>
void describe(Field& field, WheelConfig& c) {
  field("odometry", c.odometry, config::anything(),
        "whether the simulator publishes /odom and the transform odom -> base_link");
  field("least_noise", c.least_noise, config::in_range(0.0, 10.0),
        "lower limit of the factor on the standard deviations of odometry's errors, which the seed draws once per run");
  field("most_noise", c.most_noise, config::in_range(0.0, 10.0),
        "upper limit of the factor on the standard deviations of odometry's errors, which the seed draws once per run");
  field("radius_error", c.radius_error, config::in_range(0.0, 0.2),
        "largest relative error of the wheel radius in odometry, drawn uniformly by the seed; 0: normal distribution "
        "with 1 % standard deviation");
  field("base_error", c.base_error, config::in_range(0.0, 0.2),
        "largest relative error of the wheel base in odometry, drawn uniformly by the seed; 0: normal distribution "
        "with 1 % standard deviation");
  field("turn_slip", c.turn_slip, config::in_range(0.0, 0.5),
        "largest share by which odometry overestimates a turn; the seed draws a share for each turn");
  field("speed_error", c.speed_error, config::in_range(0.0, 0.5),
        "largest relative error of the speed that the drives make of a command, drawn uniformly by the seed");
  field("turn_error", c.turn_error, config::in_range(0.0, 0.5),
        "largest relative error of the turn rate that the drives make of a command, drawn uniformly by the seed");
  field("command_noise", c.command_noise, config::in_range(0.0, 0.5),
        "relative standard deviation of speed and turn rate from one command to the next");
}

template <class Field>
void describe(Field& field, SceneConfig& c) {
  field("furniture_folder", c.furniture_folder, config::anything(),
        "folder with the furniture of the Debian package sweethome3d-furniture; without it, simple parametric shapes "
        "replace the furniture");
  field("jitter", c.jitter, config::anything(),
        "whether the seed displaces movable furniture (up to 5 cm and 10 deg) and pictures (up to 10 cm)");
  field("texture_richness", c.texture_richness, config::in_range(0.0, 2.0),
        "factor on the contrast of the textures of walls, floors, ceilings and pictures");
  field("picture_density", c.picture_density, config::in_range(0.0, 1.0),
        "share of the scene's pictures that hang on the walls; the seed draws which");
  field("passable_classes", c.passable_classes, config::anything(),
        "names of classes whose objects the robot can drive through, such as closed doors of a scan");
  field("light_folder", c.light_folder, config::anything(),
        "folder in which baked light of scenes is cached; empty: lapis/light in the user's cache folder");
}

template <class Field>
void describe(Field& field, SimulatorConfig& c) {
  field("scene", c.scene, config::anything(),
        "name of a bundled scene, KIND_SEED of a generated building, a scene file (.yaml), or a file or folder of "
        "another format (docs/scenes.md)");
  field("seed", c.seed, config::at_least(0),
        "seed of start pose, noise, systematic errors, label confusion, and jitter of furniture and pictures");
  field("mode", c.mode, config::one_of({"lockstep", "freerun"}),
        "pace of the run; lockstep: all participants answer a frame before the next one; freerun: wall-clock time, "
        "frames may be lost");
  field("max_real_time_factor", c.max_real_time_factor, config::in_range(0.0, 100.0),
        "upper limit of simulated time per wall-clock time in lock-step; 0: as fast as the machine allows",
        config::Change::kAtRunTime);
  field("duration_s", c.duration_s, config::in_range(0.0, 1e6),
        "simulated time after which the run ends; 0: no limit [s]");
  field("ends_when_explored", c.ends_when_explored, config::anything(),
        "whether the run also ends when /planner/status reports DONE, GAVE_UP or FAILED");
  field("tour", c.tour, config::anything(),
        "tour that the robot drives by itself: \"bundled\" (of the scene) or a file with waypoints; empty: the robot "
        "obeys /cmd_vel");
  field("tour_revisit_every_m", c.tour_revisit_every_m, config::in_range(0.0, 1000.0),
        "length of the tour's path after which the robot drives back to an old place and returns; 0: never [m]");
  field("start", c.start, config::anything(),
        "start pose in the scene as \"x y yaw_deg\"; empty: drawn by the seed [m, m, deg]");
  field("output_dir", c.output_dir, config::anything(),
        "run folder for simulation.yaml and ground_truth/; empty: the run leaves no files");
  field("wait_for_readers", c.wait_for_readers, config::in_range(0, 100),
        "number of readers that the depth topic must have before the simulator begins; only in mode freerun");
  field("render_threads", c.render_threads, config::in_range(1, 64),
        "number of threads for rendering, light and ground truth; results do not depend on it");
  field("imu", c.imu, config::anything(), "whether the simulator publishes /imu, at 200 Hz");
  field("labels", c.labels, config::anything(),
        "whether the simulator publishes labels; false: another process labels the images, such as segmenter");
  field("planner_margin_m", c.planner_margin_m, config::in_range(0.0, 1.0),
        "clearance that a planner keeps (planner.grid.margin_m), for the ground truth of what such a robot can see "
        "(with_margin.lapis) [m]");
  field("full_map", c.full_map, config::anything(),
        "whether ground truth has full.lapis, the whole building mapped from noise-free frames (the paper's "
        "reference); cached per building and start");
  field("world", c.world);
  field("noise", c.noise);
  field("wheels", c.wheels);
  field.moved("truth", "semantic_mapper", "ground truth is built as /semantic_mapper/map_description says");
}

}  // namespace lapis::simulator
