#pragma once

#include <string>

#include "common/config/schema.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// What the process adds to the method's configuration.
struct SlamComponentConfig {
  SlamConfig method;
  double max_stamp_difference_s = 0.0;  ///< 0: 0.6 of the time between colour images, at most 0.12 s
  double graph_period_s = 0.5;
  double landmark_period_s = 2.0;
  std::string depth_calibration = "given";
  std::string publish_odom_frame = "auto";
  std::string output_dir;
  std::string resume_from;
  bool resume_session = false;
  double autosave_period_s = 60.0;
};

template <class Field>
void describe(Field& field, FeatureConfig& c) {
  field("max_features", c.max_features, config::in_range(100, 5000),
        "largest number of ORB features of a frame, all pyramid levels together");
  field("levels", c.levels, config::in_range(1, 12), "number of levels of the image pyramid");
  field("scale_factor", c.scale_factor, config::in_range(1.05, 2),
        "ratio of the image sizes of neighbouring pyramid levels; a map to resume must have been made with the same "
        "value");
  field("fast_threshold", c.fast_threshold, config::in_range(1, 100),
        "contrast of a FAST corner with the pixels around it; where a pyramid level has less than a third of its "
        "share, all count that "
        "stand out from the noise [grey levels]");
  field("min_corner_share", c.min_corner_share, config::in_range(0, 1),
        "smallest ratio of the smaller to the larger eigenvalue of a corner's structure tensor; a corner with less "
        "lies on an edge and is dropped");
}

template <class Field>
void describe(Field& field, NoiseConfig& c) {
  field("pixel_sigma_px", c.pixel_sigma_px, config::in_range(0.1, 5),
        "standard deviation of a feature's position at the finest pyramid level; larger on coarser levels, in "
        "proportion to their scale [px]");
  field("depth_sigma_m", c.depth_sigma_m, config::in_range(1e-4, 0.1),
        "constant part of the standard deviation of depth, depth_sigma_m + depth_sigma_per_m * z^2 [m]");
  field("depth_sigma_per_m", c.depth_sigma_per_m, config::in_range(0, 0.1),
        "quadratic part of the standard deviation of depth, depth_sigma_m + depth_sigma_per_m * z^2 [1/m]");
  field("max_depth_m", c.max_depth_m, config::in_range(0.5, 50),
        "largest depth that slam uses; a pixel with more counts as a pixel without depth [m]");
  field("min_depth_m", c.min_depth_m, config::in_range(0.01, 5),
        "smallest depth that slam uses; a pixel with less counts as a pixel without depth [m]");
}

template <class Field>
void describe(Field& field, MatcherConfig& c) {
  field("search_radius_px", c.search_radius_px, config::in_range(2, 100),
        "largest distance of a feature from a landmark's predicted pixel, in x and in y, at the finest pyramid level "
        "[px]");
  field("wide_search_radius_px", c.wide_search_radius_px, config::in_range(2, 300),
        "largest distance of a feature from a landmark's predicted pixel, in x and in y, in the second attempt and for "
        "loop candidates near in the map [px]");
  field("max_distance", c.max_distance, config::in_range(10, 128),
        "largest Hamming distance between the ORB descriptors (256 bits) of a match [bits]");
  field("max_ratio", c.max_ratio, config::in_range(0.3, 1),
        "largest ratio of the best to the second-best descriptor distance of a match");
}

template <class Field>
void describe(Field& field, SurfaceConfig& c) {
  field("enabled", c.enabled, config::anything(),
        "whether slam aligns surface samples of key-frames with the depth image (point to plane)");
  field("grid_step_px", c.grid_step_px, config::in_range(4, 64),
        "edge of a square cell of the depth image; the plane through a cell's pixels gives at most one surface sample "
        "[px]");
  field("keyframes", c.keyframes, config::in_range(1, 5),
        "number of key-frames whose surface samples support tracking by features: the reference and its most covisible "
        "key-frames");
  field("max_distance_m", c.max_distance_m, config::in_range(0.01, 1),
        "largest point-to-plane distance of a sample in the first round of alignment; more where depth is noisier, "
        "less in later rounds [m]");
  field("weight", c.weight, config::in_range(0.001, 1),
        "weight of a surface sample relative to an independent one; below 1, because the errors of neighbouring "
        "samples are correlated");
  field("near_keyframes", c.near_keyframes, config::in_range(1, 10),
        "number of key-frames that give a pose by surfaces where features are too few: the nearest of the newest and "
        "the covisible ones");
  field("min_matches", c.min_matches, config::in_range(10, 100000),
        "smallest number of matched surface samples for a pose by surfaces alone; also the fewest samples of a map or "
        "key-frame without features");
  field("min_share", c.min_share, config::in_range(0, 1),
        "smallest share of the surface samples in view that must be seen again for a pose by surfaces alone");
  field("least_cosine2", c.least_cosine2, config::in_range(1e-4, 0.3),
        "mean squared cosine between a direction and the surface normals below which a pose by surfaces follows "
        "odometry in this direction");
  field("max_disagreement", c.max_disagreement, config::in_range(1, 100),
        "largest disagreement between a pose by surfaces alone and odometry; with more, the pose is rejected [standard "
        "deviations]");
}

template <class Field>
void describe(Field& field, TrackerConfig& c) {
  field("min_matches", c.min_matches, config::in_range(6, 500),
        "number of inliers below which slam tries the next kind of matching; also the fewest features with depth that "
        "begin a map with odometry");
  field("min_inliers", c.min_inliers, config::in_range(6, 200),
        "smallest number of inliers of a pose by features; with fewer, the frame has no pose by features");
  field(
      "rival_sigmas", c.rival_sigmas, config::in_range(0.0, 20.0),
      "excess of the matches that agree with a pose (ransac_error_px) over those that agree with any other pose, or by "
      "chance, without which the pose is not believed [standard deviations, sqrt(sum of both)]");
  field("local_keyframes", c.local_keyframes, config::in_range(1, 50),
        "number of key-frames whose landmarks form the local map: the reference and its most covisible key-frames");
  field("ransac_iterations", c.ransac_iterations, config::in_range(10, 10000),
        "largest number of RANSAC iterations of PnP, which gives the first pose from brute-force matches");
  field("ransac_error_px", c.ransac_error_px, config::in_range(0.5, 20),
        "largest reprojection error of an inlier of PnP with RANSAC [px]");
  field("refine_iterations", c.refine_iterations, config::in_range(1, 50),
        "largest number of Levenberg-Marquardt steps in a round of the pose refinement");
  field("min_first_features", c.min_first_features, config::in_range(6, 5000),
        "smallest number of features with depth that begin a map without odometry; at most half of "
        "features.max_features is required");
  field("max_blind_frames", c.max_blind_frames, config::in_range(1, 1000),
        "number of frames in a row with enough features but no pose by features, after which a new key-frame continues "
        "the map (with odometry)");
  field("max_contradictions", c.max_contradictions, config::in_range(1, 1000),
        "number of frames in a row that contradict odometry, because they lack walls or landmarks that should be in "
        "view, until slam is lost");
  field(
      "max_prediction_s", c.max_prediction_s, config::in_range(0.01, 5),
      "longest time since the last pose over which slam predicts a pose with constant velocity, without odometry [s]");
}

template <class Field>
void describe(Field& field, KeyframeConfig& c) {
  field("min_tracked_share", c.min_tracked_share, config::in_range(0, 1),
        "share of the reference key-frame's landmarks that a frame must track; a frame that tracks less becomes a "
        "key-frame");
  field("max_translation_m", c.max_translation_m, config::in_range(0.01, 5),
        "distance from the reference key-frame beyond which a frame becomes a key-frame [m]");
  field("max_rotation_rad", c.max_rotation_rad, config::in_range(0.01, 3),
        "rotation relative to the reference key-frame beyond which a frame becomes a key-frame [rad]");
  field("min_frames", c.min_frames, config::in_range(1, 100),
        "smallest number of frames from one key-frame to the next");
}

template <class Field>
void describe(Field& field, BundleConfig& c) {
  field("window", c.window, config::in_range(1, 30),
        "number of key-frames that local bundle adjustment moves: the newest and its most covisible key-frames");
  field(
      "max_fixed", c.max_fixed, config::in_range(1, 50),
      "largest number of fixed key-frames in local bundle adjustment; they see the same landmarks as the moving ones");
  field("max_landmarks", c.max_landmarks, config::in_range(50, 20000),
        "largest number of landmarks in local bundle adjustment; the newest are used");
  field("max_iterations", c.max_iterations, config::in_range(1, 100),
        "largest number of Levenberg-Marquardt iterations of local bundle adjustment");
}

template <class Field>
void describe(Field& field, PoseGraphConfig& c) {
  field("information_share", c.information_share, config::in_range(1e-3, 1),
        "share of an alignment's information that its edge of the pose graph and the frame's covariance use (README)");
  field("min_information", c.min_information, config::in_range(1e-6, 1e6),
        "lower bound of the eigenvalues of an edge's information matrix [1/m^2, 1/rad^2]");
  field("max_information", c.max_information, config::in_range(1, 1e12),
        "upper bound of the eigenvalues of an edge's information matrix [1/m^2, 1/rad^2]");
}

template <class Field>
void describe(Field& field, LoopConfig& c) {
  field("enabled", c.enabled, config::anything(),
        "whether slam recognises places that it has seen before and closes loops");
  field("candidates", c.candidates, config::in_range(1, 20),
        "number of most similar key-frames that slam verifies to close a loop or to relocalise");
  field("min_gap", c.min_gap, config::in_range(1, 1000),
        "number of newest key-frames that are not candidates for a loop");
  field("near_m", c.near_m, config::in_range(0, 10),
        "distance limit of the loop candidate that is nearest in the map: distance / near_m + angle / near_rad must be "
        "below 1 [m]");
  field("near_rad", c.near_rad, config::in_range(0, 3.2),
        "angle limit of the loop candidate that is nearest in the map: distance / near_m + angle / near_rad must be "
        "below 1 [rad]");
  field("min_inliers", c.min_inliers, config::in_range(10, 1000),
        "smallest number of inliers of the alignment with the older key-frame of a loop");
  field("max_sigma_m", c.max_sigma_m, config::in_range(1e-3, 1),
        "largest standard deviation of a loop's translation in any direction; a less certain alignment makes no loop "
        "[m]");
  field("max_sigma_rad", c.max_sigma_rad, config::in_range(1e-3, 1),
        "largest standard deviation of a loop's rotation about any axis; a less certain alignment makes no loop [rad]");
  field("confirm_within", c.confirm_within, config::in_range(1, 100),
        "number of key-frames after a loop within which another key-frame must find the same loop to confirm it");
  field("max_disagreement_m", c.max_disagreement_m, config::in_range(0.01, 2),
        "largest difference in position between a loop and the one that confirms it [m]");
  field("max_disagreement_rad", c.max_disagreement_rad, config::in_range(0.01, 1),
        "largest difference in rotation between a loop and the one that confirms it [rad]");
  field("spacing_m", c.spacing_m, config::in_range(0, 100),
        "shortest path between confirmed pairs of loops that become edges of the pose graph [m]");
  field("latency_frames", c.latency_frames, config::in_range(1, 1000),
        "number of frames from the start of an optimisation of the pose graph until its result takes effect");
}

template <class Field>
void describe(Field& field, RelocalizationConfig& c) {
  field("min_inliers", c.min_inliers, config::in_range(10, 1000),
        "smallest number of inliers of the alignment with a recognised key-frame for slam to relocalise there");
  field("max_sigma_m", c.max_sigma_m, config::in_range(1e-3, 1.0),
        "largest standard deviation of the position, in any direction, that a pose away from the prediction may have "
        "[m]");
  field("confirmations", c.confirmations, config::in_range(0, 100),
        "number of further frames in a row that must find a pose away from the prediction again before slam accepts "
        "it; 0: at once");
  field("near_m", c.near_m, config::in_range(0.01, 5),
        "largest distance between poses that count as the same; relative to a predicted pose, 3 standard deviations "
        "more [m]");
  field("near_rad", c.near_rad, config::in_range(0.01, 3),
        "largest angle between poses that count as the same; relative to a predicted pose, 3 standard deviations more "
        "[rad]");
  field("speed_m_s", c.speed_m_s, config::in_range(0, 10),
        "assumed speed without odometry: with the time between two frames, near_m grows by it, and near_rad in "
        "proportion [m/s]");
  field("patience_s", c.patience_s, config::in_range(0, 10),
        "time since the last pose within which slam, without a predicted pose, accepts at once a recognised pose that "
        "the robot can have reached [s]");
  field("memory_s", c.memory_s, config::in_range(0.01, 10),
        "longest time between two frames that confirm the same recognised pose [s]");
  field("slip_share", c.slip_share, config::in_range(0, 1),
        "largest deviation from odometry that wheel slip explains, as a share of path and turn since the last pose (at "
        "most 1 m, 0.5 rad); beyond it: evidence_m");
  field("evidence_m", c.evidence_m, config::in_range(0.5, 100),
        "length of path on which views must agree with a place that wheel slip does not explain, before slam accepts "
        "it (README) [m]");
  field("evidence_views", c.evidence_views, config::in_range(1, 20),
        "number of views without common landmarks that must agree with a place that wheel slip does not explain, "
        "before slam accepts it");
}

template <class Field>
void describe(Field& field, SubMapConfig& c) {
  field("after_frames", c.after_frames, config::in_range(0, 1000),
        "number of frames in a row, without odometry, that show enough but no place of the map, after which a sub-map "
        "begins; 0: never");
  field("evidence_m", c.evidence_m, config::in_range(0.5, 100),
        "distance over which key-frames must agree on where a sub-map is, before slam joins it to the map [m]");
  field("room_m", c.room_m, config::in_range(0.5, 100),
        "distance that must lie between what these key-frames show; more than in a room of which there are copies [m]");
  field("evidence_views", c.evidence_views, config::in_range(1, 20),
        "number of these key-frames that share no landmarks");
}

template <class Field>
void describe(Field& field, OdometryConfig& c) {
  field("distance_sigma", c.distance_sigma, config::in_range(0, 1),
        "standard deviation of odometry along a path of 1 m; it grows with the square root of the path [m]");
  field("turn_sigma", c.turn_sigma, config::in_range(0, 1),
        "standard deviation of odometry's heading after a turn of 1 rad; it grows with the square root of the turn "
        "[rad]");
  field(
      "turn_sigma_per_m", c.turn_sigma_per_m, config::in_range(0, 1),
      "standard deviation of odometry's heading after a path of 1 m; it grows with the square root of the path [rad]");
  field("scale_sigma", c.scale_sigma, config::in_range(0, 0.5),
        "standard deviation of the scale of odometry's distances and turns before slam has calibrated it; 0.02: 2 %");
  field("vertical_sigma", c.vertical_sigma, config::in_range(0, 1),
        "standard deviation of the height after a path of 1 m, for floors that are not level; it grows with the square "
        "root of the path [m]");
  field("tilt_sigma", c.tilt_sigma, config::in_range(0, 1),
        "standard deviation of roll and of pitch after a path of 1 m; it grows with the square root of the path [rad]");
  field("least_sigma", c.least_sigma, config::in_range(1e-6, 0.1),
        "smallest standard deviation of a motion by odometry on each axis, however short the motion is [m, rad]");
  field("max_gap_s", c.max_gap_s, config::in_range(0.01, 5),
        "longest time between odometry readings over which motion is known; beyond the newest reading slam "
        "extrapolates for half of it [s]");
  field("max_speed_m_s", c.max_speed_m_s, config::in_range(0.1, 50),
        "largest speed between two odometry readings; a faster step is a reset of odometry, not a motion of the robot "
        "[m/s]");
  field("max_turn_rate_rad_s", c.max_turn_rate_rad_s, config::in_range(0.1, 100),
        "largest turn rate between two odometry readings; a faster step is a reset of odometry, not a motion of the "
        "robot [rad/s]");
  field("max_disagreement", c.max_disagreement, config::in_range(1, 100),
        "largest disagreement of odometry and vision between successive key-frames; with more, the wheels have slipped "
        "and odometry is left out [standard deviations]");
  field("max_drift_m", c.max_drift_m, config::in_range(0.01, 1000),
        "standard deviation of the position by odometry alone, in any direction, beyond which slam is lost [m]");
}

template <class Field>
void describe(Field& field, SlamComponentConfig& c) {
  field.moved("input.color", "dds.color_transport");
  field("features", c.method.features);
  field("noise", c.method.noise);
  field("matcher", c.method.matcher);
  field("surface", c.method.surface);
  field("tracker", c.method.tracker);
  field("keyframe", c.method.keyframe);
  field("bundle", c.method.bundle);
  field("pose_graph", c.method.pose_graph);
  field("loop", c.method.loop);
  field("relocalization", c.method.relocalization);
  field("sub_map", c.method.sub_map);
  field("odometry", c.method.odometry);
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.5),
        "largest difference between the stamps of colour, depth and camera info of a frame; 0: 0.6 of the camera's "
        "period, at most 0.12 s [s]");
  field("depth_calibration", c.depth_calibration, config::one_of({"given", "estimate"}),
        "calibration of the cameras; given: as camera infos and /tf_static say, and slam reports what contradicts it; "
        "estimate: slam corrects where the depth camera is beside that of colour, the focal length of both, and the "
        "delay of depth, and publishes what it has found of the cameras on /slam/depth_camera_info");
  field("graph_period_s", c.graph_period_s, config::in_range(0.0, 60.0),
        "shortest time between publications of the pose graph, by the frames' time stamps [s]");
  field("landmark_period_s", c.landmark_period_s, config::in_range(0, 60),
        "shortest time between published versions of the landmarks, by the frames' time stamps [s]");
  field("publish_odom_frame", c.publish_odom_frame, config::one_of({"auto", "always", "never"}),
        "whether slam publishes the transform odom -> base_link; auto: as long as slam has received nothing on /odom");
  field("output_dir", c.output_dir, config::anything(),
        "folder for slam.lapis, pose_graph.g2o and keyframes.txt; empty: slam writes no files");
  field("resume_from", c.resume_from, config::anything(),
        "slam.lapis of an earlier run, whose map slam resumes; empty: slam begins a new map");
  field("resume_session", c.resume_session, config::anything(),
        "whether the map of resume_from continues in its own session, because slam died in this run: odometry leads on "
        "from the saved pose, and no id is used twice; false: a new session begins");
  field("autosave_period_s", c.autosave_period_s, config::in_range(0.0, 86400.0),
        "time between saves of slam.lapis during the run, by the frames' time stamps; 0: only at the end [s]");
}

}  // namespace lapis::slam
