#pragma once

#include <string>

#include "common/config/schema.hpp"
#include "slam/core/config.hpp"
#include "slam/frame_input.hpp"

namespace lapis::slam {

/// What the process adds to the method's configuration.
struct SlamComponentConfig {
  SlamConfig method;
  FrameInputConfig input;
  double graph_period_s = 0.5;
  double landmark_period_s = 2.0;
  std::string publish_odom_frame = "auto";
  std::string output_dir;
  std::string resume_from;
  double autosave_period_s = 60.0;
};

template <class Field>
void describe(Field& field, FeatureConfig& c) {
  field("max_features", c.max_features, config::in_range(100, 5000), "features per frame, all levels together");
  field("levels", c.levels, config::in_range(1, 12), "pyramid levels");
  field("scale_factor", c.scale_factor, config::in_range(1.05, 2), "size ratio of neighbouring levels");
  field("fast_threshold", c.fast_threshold, config::in_range(1, 100), "least FAST contrast, grey levels");
  field("min_corner_share", c.min_corner_share, config::in_range(0, 1),
        "of a corner's structure tensor the smaller eigenvalue over the larger one; less is an edge, along which it "
        "slides");
}

template <class Field>
void describe(Field& field, NoiseConfig& c) {
  field("pixel_sigma_px", c.pixel_sigma_px, config::in_range(0.1, 5), "corner position at the finest level");
  field("depth_sigma_m", c.depth_sigma_m, config::in_range(1e-4, 0.1), "constant part of the depth noise");
  field("depth_sigma_per_m", c.depth_sigma_per_m, config::in_range(0, 0.1),
        "quadratic part: sigma = depth_sigma_m + depth_sigma_per_m * z^2 [1/m]");
  field("max_depth_m", c.max_depth_m, config::in_range(0.5, 50), "measurements beyond this are ignored");
  field("min_depth_m", c.min_depth_m, config::in_range(0.01, 5), "measurements nearer than this are ignored");
}

template <class Field>
void describe(Field& field, MatcherConfig& c) {
  field("search_radius_px", c.search_radius_px, config::in_range(2, 100),
        "around a predicted pixel, at the finest level");
  field("wide_search_radius_px", c.wide_search_radius_px, config::in_range(2, 300), "second try");
  field("max_distance", c.max_distance, config::in_range(10, 128), "Hamming bits of 256");
  field("max_ratio", c.max_ratio, config::in_range(0.3, 1), "best / second best distance");
}

template <class Field>
void describe(Field& field, SurfaceConfig& c) {
  field("enabled", c.enabled, config::anything(), "align surface patches of key-frames with the depth image");
  field("grid_step_px", c.grid_step_px, config::in_range(4, 64),
        "spacing of the samples of a key-frame, and size of what each is a plane of");
  field("keyframes", c.keyframes, config::in_range(1, 5), "newest key-frames whose samples are aligned");
  field("max_distance_m", c.max_distance_m, config::in_range(0.01, 1),
        "gate of a plane distance in the first round; wider where depth errs more");
  field("weight", c.weight, config::in_range(0.001, 1),
        "neighbouring samples err together: share of a sample that counts");
  field("near_keyframes", c.near_keyframes, config::in_range(1, 10),
        "where features are too few: nearest of the newest and covisible key-frames whose samples are aligned");
  field("min_matches", c.min_matches, config::in_range(10, 100000), "there: samples that have to find their surface");
  field("min_share", c.min_share, config::in_range(0, 1), "there: of the samples in view have to be seen again");
  field("least_cosine2", c.least_cosine2, config::in_range(1e-4, 0.3),
        "there: below this mean squared cosine with the normals a direction is left to motion");
  field("max_disagreement", c.max_disagreement, config::in_range(1, 100),
        "there: with motion, in sigmas, above which surfaces are not believed");
}

template <class Field>
void describe(Field& field, TrackerConfig& c) {
  field("min_matches", c.min_matches, config::in_range(6, 500),
        "projection matches below which the next kind of matching is tried");
  field("min_inliers", c.min_inliers, config::in_range(6, 200), "fewer after the refinement is lost");
  field("min_inlier_share", c.min_inlier_share, config::in_range(0.0, 1.0),
        "of the matches; with fewer the view repeats itself or is noise");
  field("local_keyframes", c.local_keyframes, config::in_range(1, 50), "key-frames whose landmarks form the local map");
  field("recovery_keyframes", c.recovery_keyframes, config::in_range(1, 50),
        "newest key-frames tried by brute force when all else fails");
  field("ransac_iterations", c.ransac_iterations, config::in_range(10, 10000), "rounds of PnP with RANSAC");
  field("ransac_error_px", c.ransac_error_px, config::in_range(0.5, 20), "PnP inlier threshold");
  field("refine_iterations", c.refine_iterations, config::in_range(1, 50), "Levenberg-Marquardt steps per round");
  field("min_first_features", c.min_first_features, config::in_range(6, 5000),
        "features with depth that a map begins with where there is no odometry; half of max_features is always enough");
  field("max_blind_frames", c.max_blind_frames, config::in_range(1, 1000),
        "frames in a row with enough features but no pose, before the map continues where odometry says");
  field("max_contradictions", c.max_contradictions, config::in_range(1, 1000),
        "frames in a row that see through surfaces of the map where odometry says, before slam is lost");
  field("max_prediction_s", c.max_prediction_s, config::in_range(0.01, 5), "longest gap that the motion model bridges");
}

template <class Field>
void describe(Field& field, KeyframeConfig& c) {
  field("min_tracked_share", c.min_tracked_share, config::in_range(0, 1),
        "new key-frame when a smaller share of the reference's landmarks is tracked");
  field("max_translation_m", c.max_translation_m, config::in_range(0.01, 5),
        "new key-frame when further from the reference [m]");
  field("max_rotation_rad", c.max_rotation_rad, config::in_range(0.01, 3),
        "new key-frame when turned further from the reference [rad]");
  field("min_frames", c.min_frames, config::in_range(1, 100), "least number of frames between key-frames");
}

template <class Field>
void describe(Field& field, BundleConfig& c) {
  field("window", c.window, config::in_range(1, 30), "free key-frames");
  field("max_fixed", c.max_fixed, config::in_range(1, 50), "fixed key-frames that also see the landmarks");
  field("max_landmarks", c.max_landmarks, config::in_range(50, 20000), "newest kept");
  field("max_iterations", c.max_iterations, config::in_range(1, 100), "Levenberg-Marquardt");
}

template <class Field>
void describe(Field& field, PoseGraphConfig& c) {
  field("information_share", c.information_share, config::in_range(1e-3, 1),
        "share of an alignment's information that its edge gets");
  field("min_information", c.min_information, config::in_range(1e-6, 1e6), "[1/m^2, 1/rad^2]");
  field("max_information", c.max_information, config::in_range(1, 1e12), "[1/m^2, 1/rad^2]");
}

template <class Field>
void describe(Field& field, LoopConfig& c) {
  field("enabled", c.enabled, config::anything(), "recognise places seen before and close loops");
  field("candidates", c.candidates, config::in_range(1, 20), "most similar key-frames that are verified");
  field("min_gap", c.min_gap, config::in_range(1, 1000), "the newest key-frames, which make no loop");
  field("near_m", c.near_m, config::in_range(0, 10), "a key-frame this near in the map is tried too [m]");
  field("near_rad", c.near_rad, config::in_range(0, 3.2), "the same for the direction of view [rad]");
  field("min_inliers", c.min_inliers, config::in_range(10, 1000), "of the alignment with the older key-frame");
  field("max_sigma_m", c.max_sigma_m, config::in_range(1e-3, 1),
        "an alignment less sure in any direction makes no loop [m]");
  field("max_sigma_rad", c.max_sigma_rad, config::in_range(1e-3, 1), "the same for the rotation [rad]");
  field("confirm_within", c.confirm_within, config::in_range(1, 100),
        "key-frames within which a second one has to say the same");
  field("max_disagreement_m", c.max_disagreement_m, config::in_range(0.01, 2), "between the two [m]");
  field("max_disagreement_rad", c.max_disagreement_rad, config::in_range(0.01, 1), "between the two [rad]");
  field("spacing_m", c.spacing_m, config::in_range(0, 100), "path between pairs of loops [m]");
  field("latency_frames", c.latency_frames, config::in_range(1, 1000), "from a loop to the corrected map");
}

template <class Field>
void describe(Field& field, RelocalizationConfig& c) {
  field("min_inliers", c.min_inliers, config::in_range(10, 1000), "of the alignment with a recognised key-frame");
  field("majority_sigmas", c.majority_sigmas, config::in_range(0.0, 20.0),
        "where motion does not lead, more than half of the matches agree by so many standard deviations of chance");
  field("max_sigma_m", c.max_sigma_m, config::in_range(1e-3, 1.0),
        "a pose that is less sure of any direction is not believed where motion does not lead [m]");
  field("confirmations", c.confirmations, config::in_range(0, 100),
        "frames that have to find the same pose again, unless motion leads there");
  field("near_m", c.near_m, config::in_range(0.01, 5), "distance of poses that are the same [m]");
  field("near_rad", c.near_rad, config::in_range(0.01, 3), "angle of poses that are the same [rad]");
  field("speed_m_s", c.speed_m_s, config::in_range(0, 10), "between such frames, without odometry [m/s]");
  field("patience_s", c.patience_s, config::in_range(0, 10),
        "without a pose, after which one that can be reached from the last is still believed at once [s]");
  field("memory_s", c.memory_s, config::in_range(0.01, 10), "longest time between such frames [s]");
  field(
      "slip_share", c.slip_share, config::in_range(0, 1),
      "a place that odometry contradicts by more than this share of path and turn since the last pose needs evidence");
  field("evidence_m", c.evidence_m, config::in_range(0.5, 100), "path along which views have to agree with it [m]");
  field("evidence_views", c.evidence_views, config::in_range(1, 20), "number of these views; they share no landmarks");
}

template <class Field>
void describe(Field& field, OdometryConfig& c) {
  field("distance_sigma", c.distance_sigma, config::in_range(0, 1), "of wheel odometry along the path, after 1 m [m]");
  field("turn_sigma", c.turn_sigma, config::in_range(0, 1), "of its heading, after a turn of 1 rad [rad]");
  field("turn_sigma_per_m", c.turn_sigma_per_m, config::in_range(0, 1), "of its heading, after 1 m [rad]");
  field("scale_sigma", c.scale_sigma, config::in_range(0, 0.5),
        "share of path and turn by which odometry always errs, before its scales are learnt");
  field("vertical_sigma", c.vertical_sigma, config::in_range(0, 1), "how far the floor rises or sinks in 1 m [m]");
  field("tilt_sigma", c.tilt_sigma, config::in_range(0, 1), "change of roll and pitch in 1 m [rad]");
  field("least_sigma", c.least_sigma, config::in_range(1e-6, 0.1), "of every motion [m], [rad]");
  field("max_gap_s", c.max_gap_s, config::in_range(0.01, 5), "between readings that belong together [s]");
  field("max_speed_m_s", c.max_speed_m_s, config::in_range(0.1, 50), "faster steps are no motion of the robot [m/s]");
  field("max_turn_rate_rad_s", c.max_turn_rate_rad_s, config::in_range(0.1, 100), "the same [rad/s]");
  field("max_disagreement", c.max_disagreement, config::in_range(1, 100),
        "with vision between key-frames, in sigmas; odometry that disagrees more counts as slip and is left out");
  field("max_drift_m", c.max_drift_m, config::in_range(0.01, 1000),
        "sigma of the position by odometry alone, beyond which slam is lost [m]");
}

template <class Field>
void describe(Field& field, FrameInputConfig& c) {
  field("color", c.color, config::one_of({"raw", "compressed"}),
        "colour from /camera/color/image_raw or from /camera/color/image_raw/compressed");
}

template <class Field>
void describe(Field& field, SlamComponentConfig& c) {
  field("input", c.input);
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
  field("odometry", c.method.odometry);
  field(
      "max_stamp_difference_s", c.input.max_stamp_difference_s, config::in_range(0.0, 0.5),
      "between colour, depth and camera info of one frame; 0: 0.6 of the time between colour images, at most 0.12 [s]");
  field("graph_period_s", c.graph_period_s, config::in_range(0.0, 60.0),
        "least time between publications of the pose graph, by the frames' stamps [s]");
  field("landmark_period_s", c.landmark_period_s, config::in_range(0, 60),
        "least time between published versions of the landmarks, by the frames' stamps [s]");
  field("publish_odom_frame", c.publish_odom_frame, config::one_of({"auto", "always", "never"}),
        "whether slam is the one who publishes odom -> base_link; auto: while nobody publishes /odom");
  field("output_dir", c.output_dir, config::anything(),
        "folder for slam.lapis, pose_graph.g2o and keyframes.txt; empty: none");
  field("resume_from", c.resume_from, config::anything(),
        "slam.lapis of an earlier run, whose map is resumed; empty: none");
  field("autosave_period_s", c.autosave_period_s, config::in_range(0.0, 86400.0),
        "time between saves of slam.lapis, by the frames' stamps; 0: only at the end [s]");
}

}  // namespace lapis::slam
