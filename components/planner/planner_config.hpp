#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/config/schema.hpp"
#include "common/robot/robot_description.hpp"
#include "planner/core/exploration/explorer.hpp"
#include "planner/core/methods/methods.hpp"

namespace lapis::planner {

/// The configuration of the process. completed() resolves choices that are given by name.
struct PlannerComponentConfig {
  std::string method = "lapis";
  std::string then = "none";
  std::string measure = "semantic";
  std::string criterion = "d";
  std::string sparsifier = "none";
  bool autostart = true;
  SurroundingsConfig surroundings;
  MethodsConfig methods;
  std::vector<std::string> compared_methods;
  DecisionConfig decision;
  std::shared_ptr<const Method> consolidation;  ///< set by completed(); null: no consolidation
  ExplorerConfig explorer;
  int view_columns = 64, view_rows = 36;
  int decision_latency_frames = 3;
  std::string output_dir;
  int record_situations_every = 0;
  std::string replay;  ///< a situation file, from the command line
  robot::RobotDescription robot;
};

/// "lapis", which stands for one of the other names, and all other names.
std::vector<std::string> all_methods();
/// "none", and the rules that choose old places when nothing is left to explore.
std::vector<std::string> all_consolidations();
/// Methods that can judge the candidates of any other method; TARE judges only the stops of its own tour.
std::vector<std::string> comparable_methods();

/// The configuration with everything that the core needs from the robot's description and from names.
PlannerComponentConfig completed(PlannerComponentConfig config);
/// The rays of the planner's views through the robot's camera.
ViewConfig view_config(const PlannerComponentConfig& config);

template <class Field>
void describe(Field& field, GridConfig& c) {
  field.moved("min_height_m", "robot.obstacle_min_height_m");
  field.moved("max_height_m", "robot.obstacle_max_height_m");
  field("bottom_m", c.bottom_m, config::in_range(0.0, 10.0),
        "height of the lowest part of the obstacle band, in which a voxel has to be observed for a cell to count "
        "as free [m]");
  field("margin_m", c.margin_m, config::in_range(0.0, 1.0),
        "least clearance between the robot's disc and obstacles [m]");
  field("max_clearance_m", c.max_clearance_m, config::in_range(0.1, 5.0),
        "largest clearance that is computed; larger ones count as this [m]");
  field("obstacle_expiry_s", c.obstacle_expiry_s, config::in_range(0.1, 600.0),
        "time after which an obstacle that no message on /semantic_mapper/obstacles shows any more is forgotten [s]");
}

template <class Field>
void describe(Field& field, FrontierConfig& c) {
  field("max_extent_m", c.max_extent_m, config::in_range(0.5, 50.0),
        "largest diagonal of the box around a frontier; larger frontiers are split [m]");
  field("representatives", c.representatives, config::in_range(1, 16),
        "number of cells that represent a frontier: the one nearest to its centroid, then the farthest from "
        "those before");
}

template <class Field>
void describe(Field& field, PathConfig& c) {
  field("comfort_m", c.comfort_m, config::in_range(0.1, 5.0),
        "clearance from which on nearness to obstacles adds nothing to the cost of a path [m]");
  field("nearness_weight", c.nearness_weight, config::in_range(0.0, 100.0),
        "cost of nearness to obstacles: a metre of path at the least clearance costs 1 + this, at comfort_m 1",
        config::Change::kAtRunTime);
  field("escape_m", c.escape_m, config::in_range(0.0, 2.0),
        "distance within which a path may lead out of a place where the robot should not stand, such as beside a "
        "wall [m]");
  field("max_detour", c.max_detour, config::in_range(1.0, 5.0),
        "largest ratio of the length of an alternative path to that of the best path");
  field("min_apart_m", c.min_apart_m, config::in_range(0.1, 20.0),
        "least distance of an alternative path from every other path, at the place where they are farthest apart "
        "[m]");
}

template <class Field>
void describe(Field& field, ViewpointConfig& c) {
  field("min_distance_m", c.min_distance_m, config::in_range(0.0, 10.0),
        "shortest distance of a viewpoint from the cell of the frontier that it faces [m]");
  field("max_distance_m", c.max_distance_m, config::in_range(0.25, 20.0),
        "largest distance of a viewpoint from the cell of the frontier that it faces [m]");
  field("max_per_frontier", c.max_per_frontier, config::in_range(1, 64),
        "largest number of viewpoints of a frontier: one in each of this number of equal sectors around it");
  field("nearest_first", c.nearest_first, config::anything(),
        "whether each sector gets the viewpoint nearest to the viewed cell, as in the paper; false: a random one");
  field("seed", c.seed, config::anything(), "seed of the random choice of viewpoints (nearest_first: false)");
}

template <class Field>
void describe(Field& field, GapConfig& c) {
  field("least_nats", c.least_nats, config::in_range(0.0, 1e6),
        "least information of a view of a gap in the map, proposed when no frontier is left; 0: no such views "
        "[nats]");
  field("spacing_m", c.spacing_m, config::in_range(0.25, 10.0),
        "edge of the squares of the floor plan that get one place each for views of gaps in the map [m]");
}

template <class Field>
void describe(Field& field, TareConfig& c) {
  field("horizon_m", c.horizon_m, config::in_range(1.0, 20.0),
        "half the edge of the square local area around the robot, for method tare [m]");
  field("lattice_m", c.lattice_m, config::in_range(0.1, 2.0),
        "distance between neighbouring viewpoints of the lattice in the local area, for method tare [m]");
  field("range_m", c.range_m, config::in_range(0.5, 20.0),
        "largest distance at which a view covers a frontier, for method tare [m]");
  field("min_reward_m", c.min_reward_m, config::in_range(0.05, 10.0),
        "least length of frontier that a viewpoint has to cover beyond what other viewpoints cover, for method "
        "tare [m]");
  field("seed", c.seed, config::anything(), "seed of the random choice of viewpoints, for method tare");
}

template <class Field>
void describe(Field& field, CovisibilityConfig& c) {
  field("max_viewing_angle_rad", c.max_viewing_angle_rad, config::in_range(0.05, 3.2),
        "largest angle between the directions from which a landmark was seen and would be seen again [rad]");
  field("max_range_ratio", c.max_range_ratio, config::in_range(1.0, 10.0),
        "largest ratio, either way, of the distances from which a landmark was seen and would be seen again");
  field("min_visibility", c.min_visibility, config::in_range(0.0, 1.0),
        "least probability that the ray to a landmark is free, for the landmark to be seen again");
}

template <class Field>
void describe(Field& field, HallucinationConfig& c) {
  field("covisibility", c.covisibility);
  field("impossible_landmarks", c.impossible_landmarks, config::in_range(1, 10'000),
        "number of landmarks seen again up to which the probability of a loop closure is 0");
  field("certain_landmarks", c.certain_landmarks, config::in_range(2, 10'000),
        "number of landmarks seen again from which on a loop closure has max_probability; linear from "
        "impossible_landmarks on");
  field("max_probability", c.max_probability, config::in_range(0.05, 1.0),
        "largest probability of a loop closure, however many landmarks are seen again");
  field("min_loop_path_m", c.min_loop_path_m, config::in_range(0.0, 100.0),
        "least path along the pose graph between key-frames that may close a loop; a radian of turning counts "
        "0.5 m [m]");
  field.moved("min_loop_way_m", "planner.hallucination.min_loop_path_m");
  field("place_radius_m", c.place_radius_m, config::in_range(0.1, 20.0),
        "distance below which two key-frames count as one place [m]");
  field("revisit_spacing_m", c.revisit_spacing_m, config::in_range(0.0, 1000.0),
        "length of path after a loop closure from which on its place may close a loop again [m]");
  field("max_places", c.max_places, config::in_range(1, 8),
        "largest number of old places with which a path may close loops: the most probable ones");
  field("loop_weight", c.loop_weight, config::in_range(0.0, 1000.0),
        "weight of a loop edge before its probability, in weights of 1 m of odometry; 0: median weight of the "
        "loops closed so far");
}

template <class Field>
void describe(Field& field, GoalMemoryConfig& c) {
  field("radius_m", c.radius_m, config::in_range(0.1, 10.0), "distance up to which two targets count as one [m]");
  field("expiry_s", c.expiry_s, config::in_range(0.0, 3600.0),
        "time for which a failed target, or a place that stopped the robot, is left alone [s]");
  field("max_failures", c.max_failures, config::in_range(1, 100),
        "number of failures after which a target is left alone for good (README)");
}

/// Keys that decide which candidates there are and what their views tell.
template <class Field>
void describe_views(Field& field, PlannerComponentConfig& c) {
  field("max_candidates", c.decision.max_candidates, config::in_range(1, 1000),
        "largest number of candidates that are judged: those with the shortest paths, but the nearest of every "
        "frontier first",
        config::Change::kAtRunTime);
  field("view_spacing_m", c.decision.view_spacing_m, config::in_range(0.1, 10.0),
        "distance between the views along a path from which its information is computed [m]");
  field("view_votes", c.surroundings.ray.votes, config::in_range(1, 30),
        "number of frames with the same outcome that a ray stands for, as of a robot that drives past; 1: a "
        "single frame, as in the paper");
  field("unknown_occupied", c.surroundings.ray.unknown_occupied, config::in_range(0.0, 0.99),
        "probability that a ray ends in a voxel never observed; 0: the sensor model's prior, as in the paper");
  field("surface_occupied", c.surroundings.ray.surface_occupied, config::in_range(0.0, 0.99),
        "probability that a ray ends in a voxel never observed that shares a face with an occupied one; 0: no "
        "difference, as in the paper");
  field("view_columns", c.view_columns, config::in_range(1, 4096),
        "number of columns of rays that represent a view, over the width of the image");
  field("view_rows", c.view_rows, config::in_range(1, 4096),
        "number of rows of rays that represent a view, over the height of the image");
}

/// Keys that decide what candidates cost and how they are judged.
template <class Field>
void describe_judgement(Field& field, PlannerComponentConfig& c) {
  field("node_spacing_m", c.decision.node_spacing_m, config::in_range(0.2, 10.0),
        "distance between the hallucinated key-frames along a path [m]");
  field("turn_cost_m_per_rad", c.decision.turn_cost_m_per_rad, config::in_range(0.0, 10.0),
        "cost of turning at the ends of a path, as metres of path per radian [m/rad]", config::Change::kAtRunTime);
  field("alternatives", c.decision.alternatives, config::in_range(0, 3),
        "largest number of additional paths to the nearest goal of each frontier; 0: none", config::Change::kAtRunTime);
  field("revisit_sigma_m", c.decision.revisit_sigma_m, config::in_range(0.0, 100.0),
        "standard deviation of the newest key-frame's position above which old key-frames are goals, too; 0: "
        "never (README) [m]",
        config::Change::kAtRunTime);
  field("information_discount_sigma_m", c.decision.information_discount_sigma_m, config::in_range(0.0, 100.0),
        "standard deviation of the position at which the information of a view counts half; 0: all information "
        "counts fully [m]",
        config::Change::kAtRunTime);
  field("criterion", c.criterion, config::one_of({"d", "a", "t", "e"}),
        "optimality criterion of the pose graph and its edges: geometric (d), harmonic (a), arithmetic (t) mean "
        "or least (e) of eigenvalues (README)");
  field("sparsifier", c.sparsifier, config::one_of({"none", "mac", "log_det"}),
        "rule by which a large pose graph is thinned out: for algebraic connectivity (mac) or log-determinant "
        "(log_det); none: never (README)");
  field("max_graph_edges", c.decision.graph.max_edges, config::in_range(1, 10'000'000),
        "number of edges above which the sparsifier thins the pose graph out, down to this number; a spanning "
        "tree always stays");
  field("closer_look_length_m", c.decision.closer_look_length_m, config::in_range(0.1, 1000.0),
        "least length of frontiers that the robot approaches, when no other is left, although something seems to "
        "hide them [m]",
        config::Change::kAtRunTime);
  field("keep_factor", c.decision.keep_factor, config::in_range(1.0, 10.0),
        "factor by which another goal has to be better than the current one; without effect with paper and "
        "placed (README)",
        config::Change::kAtRunTime);
}

/// Keys that say when a goal is reached and when it has failed.
template <class Field>
void describe_goals(Field& field, PlannerComponentConfig& c) {
  field("replan_period_s", c.explorer.replan_period_s, config::in_range(0.0, 60.0),
        "time between decisions while the robot drives to a goal, at least 0.5; 0: no such decisions, as in the "
        "paper [s]",
        config::Change::kAtRunTime);
  field("goal_tolerance_m", c.explorer.goal_tolerance_m, config::in_range(0.05, 2.0),
        "largest distance of the robot from a goal at which the goal counts as reached [m]");
  field("goal_tolerance_rad", c.explorer.goal_tolerance_rad, config::in_range(0.05, 3.2),
        "largest heading error at which a goal counts as reached; at most 0.3 for turns on the spot and revisits "
        "[rad]");
  field("progress_timeout_s", c.explorer.progress_timeout_s, config::in_range(1.0, 600.0),
        "time without a motion of 0.3 m or 0.3 rad after which a goal has failed [s]", config::Change::kAtRunTime);
  field("slowest_m_s", c.explorer.slowest_m_s, config::in_range(0.01, 5.0),
        "lowest mean speed on a path: a goal has failed when reaching it takes progress_timeout_s longer than at "
        "this speed [m/s]");
  field("stall_m", c.explorer.stall.metres, config::in_range(1.0, 1000.0),
        "distance driven without seeing anything new, beyond twice the longest path begun meanwhile, after which "
        "a goal has failed [m]");
  field("stall_s", c.explorer.stall.seconds, config::in_range(1.0, 3600.0),
        "time without seeing anything new, beyond that of twice the longest path begun meanwhile at 0.25 m/s, "
        "after which a goal has failed [s]");
  field("settle_s", c.explorer.settle_s, config::in_range(0.0, 60.0),
        "time from arrival at a goal until the map is checked: the view has failed if its target is still a "
        "frontier [s]");
}

/// Keys of the mission around decisions.
template <class Field>
void describe_mission(Field& field, PlannerComponentConfig& c) {
  field("max_drift_m", c.explorer.max_drift_m, config::in_range(0.0, 100.0),
        "largest standard deviation of the position at a path's end in dead reckoning; beyond it the robot "
        "drives to where slam tracked [m]",
        config::Change::kAtRunTime);
  field.moved("dead_reckoning_s", "planner.max_drift_m", "slam says how far a pose by odometry alone has drifted");
  field("lost_timeout_s", c.explorer.lost_timeout_s, config::in_range(1.0, 3600.0),
        "time without a pose after which exploration has failed; also the time allowed for driving back to where "
        "slam tracked [s]",
        config::Change::kAtRunTime);
  field("path_spacing_m", c.explorer.path_spacing_m, config::in_range(0.02, 1.0),
        "largest distance between neighbouring poses on /planner/path [m]");
  field("confirmations", c.explorer.confirmations, config::in_range(2, 12),
        "number of looks around, together a full turn, that have to find nothing before exploration ends");
  field("patience_s", c.explorer.patience_s, config::in_range(0.0, 600.0),
        "time to wait for obstacles that may go away, and for corrections of the map, before exploration ends [s]",
        config::Change::kAtRunTime);
  field("max_left_share", c.explorer.max_left_share, config::in_range(0.0, 1.0),
        "largest share (by length) of remaining frontiers, as wide as the robot but tried in vain, with which "
        "exploration is DONE; above it GAVE_UP (README)",
        config::Change::kAtRunTime);
  field("returns_home", c.explorer.returns_home, config::anything(),
        "whether the robot drives back to where it started when nothing is left to explore",
        config::Change::kAtRunTime);
}

/// Keys of what is written beside the decision itself, and those that have moved.
template <class Field>
void describe_records(Field& field, PlannerComponentConfig& c) {
  field.moved("sensor_model.pass_gain", "semantic_mapper.sensor_model.miss_gain",
              "the planner reads it on /semantic_mapper/map_description");
  field.moved("sensor_model", "semantic_mapper.sensor_model",
              "the planner reads it on /semantic_mapper/map_description");
  field("compared_methods", c.compared_methods,
        config::one_of(comparable_methods(), "see Method in components/planner/README.md"),
        "other methods, whose choices among the candidates of each decision are written to decisions.csv");
  field("compared_priors", c.surroundings.compared_priors, config::in_range(0.001, 0.999),
        "other values for the prior of occupancy of the mapper's sensor model; the choice with each of them is "
        "written to decisions.csv");
  field("decision_latency_frames", c.decision_latency_frames, config::in_range(1, 100),
        "number of frames from the one on which a decision is based to the one at which it takes effect");
  field("output_dir", c.output_dir, config::anything(),
        "folder for decisions.csv, decision.json and situations/; empty: no files are written");
  field("record_situations_every", c.record_situations_every, config::in_range(0, 1'000'000),
        "interval, in decisions, at which the input of a decision is written to situations/ in output_dir for "
        "--replay; 0: never");
}

template <class Field>
void describe(Field& field, PlannerComponentConfig& c) {
  field("method", c.method, config::one_of(all_methods(), "see Method in components/planner/README.md"),
        "method that chooses between the candidate paths (README)");
  field("then", c.then, config::one_of(all_consolidations()),
        "rule that chooses old places to drive through, to close loops, when nothing is left to explore; none: "
        "no old places");
  field("measure", c.measure, config::one_of({"semantic", "shannon", "csqmi"}),
        "measure of the map's information: about space and classes (semantic), or about space alone (shannon, "
        "csqmi) (README)");
  field("autostart", c.autostart, config::anything(),
        "whether exploration starts with the process; false: it waits for the service /planner/start");
  field("beta", c.methods.joint.beta, config::in_range(0.0, 100.0),
        "weight of a nat about the trajectory relative to a nat about the map, for the methods joint and lapis",
        config::Change::kAtRunTime);
  field("sigma_limit_voxels", c.decision.sigma_limit_voxels, config::in_range(0.01, 10.0),
        "standard deviation of the position at a path's end down to which loop closures count, for the methods "
        "joint and lapis [voxels]",
        config::Change::kAtRunTime);
  describe_views(field, c);
  describe_judgement(field, c);
  field("grid", c.surroundings.grid);
  field("frontiers", c.surroundings.frontiers);
  field("path", c.decision.path);
  field("viewpoints", c.decision.viewpoints);
  field("gaps", c.decision.gaps);
  field("tare", c.methods.tare);
  field("hallucination", c.decision.hallucination);
  field("memory", c.explorer.memory);
  describe_goals(field, c);
  describe_mission(field, c);
  describe_records(field, c);
}

}  // namespace lapis::planner
