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
        "lowest part of what lies in between; a cell is free only where it has been seen [m]");
  field("margin_m", c.margin_m, config::in_range(0.0, 1.0), "kept between the robot's disc and obstacles [m]");
  field("max_clearance_m", c.max_clearance_m, config::in_range(0.1, 5.0), "clearance is known up to here [m]");
  field("obstacle_expiry_s", c.obstacle_expiry_s, config::in_range(0.1, 600.0),
        "an obstacle that no grid shows any more is forgotten [s]");
}

template <class Field>
void describe(Field& field, FrontierConfig& c) {
  field("max_extent_m", c.max_extent_m, config::in_range(0.5, 50.0), "longer frontiers are split [m]");
  field("representatives", c.representatives, config::in_range(1, 16), "cells that stand for a frontier");
}

template <class Field>
void describe(Field& field, PathConfig& c) {
  field("comfort_m", c.comfort_m, config::in_range(0.1, 5.0), "clearance from which on nearness costs nothing [m]");
  field("nearness_weight", c.nearness_weight, config::in_range(0.0, 100.0),
        "a metre at the least clearance costs 1 + this");
  field("escape_m", c.escape_m, config::in_range(0.0, 2.0),
        "the robot may leave a place where it should not stand within this [m]");
  field("max_detour", c.max_detour, config::in_range(1.0, 5.0), "an alternative's length over that of the best path");
  field("min_apart_m", c.min_apart_m, config::in_range(0.1, 20.0), "alternatives are so far apart somewhere [m]");
}

template <class Field>
void describe(Field& field, ViewpointConfig& c) {
  field("min_distance_m", c.min_distance_m, config::in_range(0.0, 10.0), "from the frontier [m]");
  field("max_distance_m", c.max_distance_m, config::in_range(0.25, 20.0), "from the frontier [m]");
  field("max_per_frontier", c.max_per_frontier, config::in_range(1, 64), "viewpoints");
  field("nearest_first", c.nearest_first, config::anything(),
        "of the places the nearest to the frontier's middle, as in the paper; false: any, drawn");
  field("seed", c.seed, config::anything(), "draws them");
}

template <class Field>
void describe(Field& field, GapConfig& c) {
  field("least_nats", c.least_nats, config::in_range(0.0, 1e6),
        "that a view has to promise when no frontier is left; 0: no such views");
  field("spacing_m", c.spacing_m, config::in_range(0.25, 10.0), "between places for such views [m]");
}

template <class Field>
void describe(Field& field, TareConfig& c) {
  field("horizon_m", c.horizon_m, config::in_range(1.0, 20.0), "half the edge of the local area [m]");
  field("lattice_m", c.lattice_m, config::in_range(0.1, 2.0), "between viewpoints [m]");
  field("range_m", c.range_m, config::in_range(0.5, 20.0), "to which a view covers frontiers [m]");
  field("min_reward_m", c.min_reward_m, config::in_range(0.05, 10.0),
        "of frontier that a viewpoint has to cover besides the others [m]");
  field("seed", c.seed, config::anything(), "draws the viewpoints");
}

template <class Field>
void describe(Field& field, CovisibilityConfig& c) {
  field("max_viewing_angle_rad", c.max_viewing_angle_rad, config::in_range(0.05, 3.2),
        "between the directions from which a landmark was and would be seen [rad]");
  field("max_range_ratio", c.max_range_ratio, config::in_range(1.0, 10.0), "between the distances, either way");
  field("min_visibility", c.min_visibility, config::in_range(0.0, 1.0),
        "probability that the ray to a landmark is free");
}

template <class Field>
void describe(Field& field, HallucinationConfig& c) {
  field("covisibility", c.covisibility);
  field("impossible_landmarks", c.impossible_landmarks, config::in_range(1, 10'000),
        "seen again, of which a loop closure is impossible, or fewer");
  field("certain_landmarks", c.certain_landmarks, config::in_range(2, 10'000),
        "seen again, of which it is as sure as it gets, or more; linear in between");
  field("max_probability", c.max_probability, config::in_range(0.05, 1.0),
        "of a loop closure, however many landmarks are seen again");
  field("min_loop_path_m", c.min_loop_path_m, config::in_range(0.0, 100.0),
        "along the pose graph; nearer key-frames make no loop [m]");
  field.moved("min_loop_way_m", "planner.hallucination.min_loop_path_m");
  field("place_radius_m", c.place_radius_m, config::in_range(0.1, 20.0), "key-frames of one place [m]");
  field("revisit_spacing_m", c.revisit_spacing_m, config::in_range(0.0, 1000.0),
        "path after a loop closure before its place counts again [m]");
  field("max_places", c.max_places, config::in_range(1, 8), "of a path; the most probable ones");
  field("loop_weight", c.loop_weight, config::in_range(0.0, 1000.0),
        "of a loop's edge, probability apart, in weights of a metre of odometry; 0: as the loops that were closed");
}

template <class Field>
void describe(Field& field, GoalMemoryConfig& c) {
  field("radius_m", c.radius_m, config::in_range(0.1, 10.0), "targets nearer to each other are one [m]");
  field("expiry_s", c.expiry_s, config::in_range(0.0, 3600.0), "a target that failed is left alone for so long [s]");
  field("max_failures", c.max_failures, config::in_range(1, 100), "after so many it is left alone for good");
}

/// Keys that decide which candidates there are and how they are judged.
template <class Field>
void describe_decisions(Field& field, PlannerComponentConfig& c) {
  field("max_candidates", c.decision.max_candidates, config::in_range(1, 1000),
        "that are judged; the ones with the shortest paths");
  field("view_spacing_m", c.decision.view_spacing_m, config::in_range(0.1, 10.0), "between views along a path [m]");
  field("view_votes", c.surroundings.ray.votes, config::in_range(1, 30),
        "that a voxel gets from a robot that passes; 1: a single frame, as in the paper");
  field("unknown_occupied", c.surroundings.ray.unknown_occupied, config::in_range(0.0, 0.99),
        "probability that a ray ends in a voxel never observed; 0: the sensor model's prior, as in the paper");
  field("surface_occupied", c.surroundings.ray.surface_occupied, config::in_range(0.0, 0.99),
        "the same beside an occupied voxel: surfaces go on where nobody has looked; 0: no difference, as in the paper");
  field("view_columns", c.view_columns, config::in_range(1, 4096), "rays of a view, over the width of the image");
  field("view_rows", c.view_rows, config::in_range(1, 4096), "rays of a view, over its height");
  field("node_spacing_m", c.decision.node_spacing_m, config::in_range(0.2, 10.0),
        "between hallucinated key-frames [m]");
  field("turn_cost_m_per_rad", c.decision.turn_cost_m_per_rad, config::in_range(0.0, 10.0),
        "of turning at the ends of a path [m/rad]");
  field("alternatives", c.decision.alternatives, config::in_range(0, 3),
        "other paths to the nearest goal of each frontier, at most");
  field("revisit_sigma_m", c.decision.revisit_sigma_m, config::in_range(0.0, 100.0),
        "when the position is less sure, old key-frames are goals, too; 0: never [m]");
  field("information_discount_sigma_m", c.decision.information_discount_sigma_m, config::in_range(0.0, 100.0),
        "information from a position with this sigma counts half; 0: all counts [m]");
  field("criterion", c.criterion, config::one_of({"d", "a", "t", "e"}),
        "optimality of the pose graph: mean of its eigenvalues, and of those of an edge's information (README)");
  field("sparsifier", c.sparsifier, config::one_of({"none", "mac", "log_det"}),
        "what thins a large pose graph out: for connectivity, or for its log-determinant (README)");
  field("max_graph_edges", c.decision.graph.max_edges, config::in_range(1, 10'000'000),
        "what the sparsifier leaves, but for a spanning tree");
  field("closer_look_length_m", c.decision.closer_look_length_m, config::in_range(0.1, 1000.0),
        "when nothing else is left, frontiers so long are looked at from nearby, whatever seems to hide them [m]");
  field("keep_factor", c.decision.keep_factor, config::in_range(1.0, 10.0),
        "another goal must be so much better than the one being driven to");
}

/// Keys of the mission around decisions.
template <class Field>
void describe_mission(Field& field, PlannerComponentConfig& c) {
  field("replan_period_s", c.explorer.replan_period_s, config::in_range(0.0, 60.0),
        "between decisions while a goal is being driven to, at least 0.5; 0: none, as in the paper [s]");
  field("goal_tolerance_m", c.explorer.goal_tolerance_m, config::in_range(0.05, 2.0), "at a goal [m]");
  field("goal_tolerance_rad", c.explorer.goal_tolerance_rad, config::in_range(0.05, 3.2), "at a goal [rad]");
  field("progress_timeout_s", c.explorer.progress_timeout_s, config::in_range(1.0, 600.0),
        "without moving a goal has failed [s]");
  field("slowest_m_s", c.explorer.slowest_m_s, config::in_range(0.01, 5.0),
        "a path that takes longer than at this speed has failed [m/s]");
  field("stall_m", c.explorer.stall.metres, config::in_range(1.0, 1000.0),
        "driven without seeing anything new, besides twice the longest path meanwhile, before a goal has failed [m]");
  field("stall_s", c.explorer.stall.seconds, config::in_range(1.0, 3600.0),
        "the same in time, besides that of twice the longest path at 0.25 m/s [s]");
  field("settle_s", c.explorer.settle_s, config::in_range(0.0, 60.0),
        "after arriving, until the map shows whether the view has failed [s]");
  field("max_drift_m", c.explorer.max_drift_m, config::in_range(0.0, 100.0),
        "sigma of the position by odometry alone that a path may end with; beyond it the robot drives to where slam "
        "tracked [m]");
  field.moved("dead_reckoning_s", "planner.max_drift_m", "slam says how far a pose by odometry alone has drifted");
  field("lost_timeout_s", c.explorer.lost_timeout_s, config::in_range(1.0, 3600.0),
        "without a pose, exploration has failed; so long it also tries to get back to where slam tracked [s]");
  field("path_spacing_m", c.explorer.path_spacing_m, config::in_range(0.02, 1.0), "between poses of /planner/path [m]");
  field("confirmations", c.explorer.confirmations, config::in_range(2, 12),
        "looks around, a full turn in all, that find nothing before exploration is over");
  field("patience_s", c.explorer.patience_s, config::in_range(0.0, 600.0),
        "for obstacles that may go away before exploration is over [s]");
  field("max_left_share", c.explorer.max_left_share, config::in_range(0.0, 1.0),
        "of the frontiers left, what was tried in vain though the robot would fit through: with more it has given up");
  field("returns_home", c.explorer.returns_home, config::anything(), "drives to where it started when nothing is left");
}

template <class Field>
void describe(Field& field, PlannerComponentConfig& c) {
  field("method", c.method, config::one_of(all_methods(), "see Method in components/planner/README.md"),
        "what decides between paths");
  field("then", c.then, config::one_of(all_consolidations()),
        "old places to drive through when nothing is left to explore, so that loops are closed; none: it is over");
  field("measure", c.measure, config::one_of({"semantic", "shannon", "csqmi"}),
        "information of the map: about space and classes, or about space alone (README)");
  field("autostart", c.autostart, config::anything(), "explore at once; false: wait for /planner/start");
  field("beta", c.methods.joint.beta, config::in_range(0.0, 100.0),
        "method joint: what a nat about the trajectory counts against one about the map");
  field("sigma_limit_voxels", c.decision.sigma_limit_voxels, config::in_range(0.01, 10.0),
        "loops count until the position at a path's end is so exact [voxels]");
  describe_decisions(field, c);
  field("grid", c.surroundings.grid);
  field("frontiers", c.surroundings.frontiers);
  field("path", c.decision.path);
  field("viewpoints", c.decision.viewpoints);
  field("gaps", c.decision.gaps);
  field("tare", c.methods.tare);
  field("hallucination", c.decision.hallucination);
  field("memory", c.explorer.memory);
  describe_mission(field, c);
  field.moved("sensor_model.pass_gain", "semantic_mapper.sensor_model.miss_gain",
              "the planner reads it on /semantic_mapper/map_description");
  field.moved("sensor_model", "semantic_mapper.sensor_model",
              "the planner reads it on /semantic_mapper/map_description");
  field("compared_methods", c.compared_methods,
        config::one_of(comparable_methods(), "see Method in components/planner/README.md"),
        "decisions.csv says what each of these would have chosen among the same candidates");
  field("compared_priors", c.surroundings.compared_priors, config::in_range(0.001, 0.999),
        "instead of the prior of the mapper's sensor model: decisions.csv says what would have been chosen with each");
  field("decision_latency_frames", c.decision_latency_frames, config::in_range(1, 100),
        "from the frame that a decision is made from to the one at which it takes effect");
  field("output_dir", c.output_dir, config::anything(), "folder for decisions.csv and decision.json; empty: none");
  field("record_situations_every", c.record_situations_every, config::in_range(0, 1'000'000),
        "so many decisions what one is made from goes to situations/ in output_dir, for --replay; 0: never");
}

}  // namespace lapis::planner
