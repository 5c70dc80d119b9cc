#pragma once

namespace lapis::slam {

/// ORB features spread over the image.
struct FeatureConfig {
  int max_features = 600;     ///< features per frame, all levels together [100, 5000]
  int levels = 4;             ///< pyramid levels [1, 12]
  double scale_factor = 1.3;  ///< size ratio of neighbouring levels [1.05, 2]
  int fast_threshold = 10;    ///< least FAST contrast, grey levels [1, 100]
  /// The smaller eigenvalue of a corner's structure tensor, as a share of the larger one; below it is an edge [0, 1].
  double min_corner_share = 0.2;
};

/// Standard deviations of the measurements. Depth noise of structured light and stereo grows with z^2.
struct NoiseConfig {
  double pixel_sigma_px = 0.7;       ///< corner position at the finest level [0.1, 5]
  double depth_sigma_m = 0.003;      ///< constant part of the depth noise [1e-4, 0.1]
  double depth_sigma_per_m = 0.002;  ///< quadratic part: sigma = depth_sigma_m + depth_sigma_per_m * z^2 [1/m] [0, 0.1]
  double max_depth_m = 10.0;         ///< measurements beyond this are ignored [0.5, 50]
  double min_depth_m = 0.1;          ///< measurements nearer than this are ignored [0.01, 5]
};

/// Matching of features with landmarks.
struct MatcherConfig {
  double search_radius_px = 12.0;       ///< around a predicted pixel, at the finest level [2, 100]
  double wide_search_radius_px = 40.0;  ///< second try [2, 300]
  int max_distance = 70;                ///< Hamming bits of 256 [10, 128]
  double max_ratio = 0.85;              ///< best / second best distance [0.3, 1]
};

/// Surface patches of key-frames, aligned with the depth image (point to plane).
struct SurfaceConfig {
  bool enabled = true;
  int grid_step_px = 12;         ///< spacing of the samples of a key-frame, and size of what each is a plane of [4, 64]
  int keyframes = 2;             ///< newest key-frames whose samples are aligned [1, 5]
  double max_distance_m = 0.10;  ///< gate of a plane distance in the first round; wider where depth errs more [0.01, 1]
  double weight = 0.2;           ///< neighbouring samples err together: share of a sample that counts [0.001, 1]
  // Where features are too few:
  int near_keyframes = 3;         ///< nearest of the newest and covisible ones whose samples are aligned [1, 10]
  int min_matches = 150;          ///< samples that have to find their surface [10, 100000]
  double min_share = 0.6;         ///< of the samples in view have to be seen again [0, 1]
  double least_cosine2 = 0.02;    ///< a direction is open below this mean squared cosine with the normals [1e-4, 0.3]
  double max_disagreement = 4.0;  ///< with motion, in sigmas, above which the surfaces are not believed [1, 100]
};

struct TrackerConfig {
  int min_matches = 30;            ///< projection matches below which the next kind of matching is tried [6, 500]
  int min_inliers = 15;            ///< fewer after the refinement is lost [6, 200]
  double min_inlier_share = 0.45;  ///< of the matches; with fewer the view repeats itself, or is noise [0, 1]
  int local_keyframes = 5;         ///< key-frames whose landmarks form the local map [1, 50]
  int recovery_keyframes = 5;      ///< newest key-frames tried by brute force when all else fails [1, 50]
  int ransac_iterations = 200;     ///< PnP [10, 10000]
  double ransac_error_px = 4.0;    ///< PnP inlier threshold [0.5, 20]
  int refine_iterations = 4;       ///< Levenberg-Marquardt steps per round [1, 50]
  int min_first_features = 100;   ///< with depth, to begin a map without odometry; max_features / 2 is enough [6, 5000]
  int max_blind_frames = 8;       ///< in a row with enough features, before the map continues by odometry [1, 1000]
  int max_contradictions = 5;     ///< frames in a row that see through what was mapped, before slam is lost [1, 1000]
  double max_prediction_s = 0.5;  ///< longest gap that the motion model bridges [0.01, 5]
};

/// A frame becomes a key-frame when any of the reasons holds and the last one is far enough back.
struct KeyframeConfig {
  double min_tracked_share = 0.25;  ///< of the reference key-frame's landmarks [0, 1]
  double max_translation_m = 0.40;  ///< from the reference key-frame [0.01, 5]
  double max_rotation_rad = 0.30;   ///< from the reference key-frame [0.01, 3]
  int min_frames = 3;               ///< between key-frames [1, 100]
};

struct BundleConfig {
  int window = 6;            ///< free key-frames [1, 30]
  int max_fixed = 6;         ///< fixed key-frames that also see the landmarks [1, 50]
  int max_landmarks = 1000;  ///< newest kept [50, 20000]
  int max_iterations = 5;    ///< Levenberg-Marquardt [1, 100]
};

/// From the Hessian of an alignment to the information of an edge: docs/decisions/0025. The bounds keep an edge from
/// being blind or too sure.
struct PoseGraphConfig {
  double information_share = 0.5;  ///< of an alignment's information that its edge gets [1e-3, 1]
  double min_information = 1.0;    ///< [1/m^2, 1/rad^2] [1e-6, 1e6]
  double max_information = 1e8;    ///< [1/m^2, 1/rad^2] [1, 1e12]
};

/// Recognition of places that were seen before, at key-frames.
struct LoopConfig {
  bool enabled = true;
  int candidates = 3;                  ///< most similar key-frames that are verified [1, 20]
  int min_gap = 10;                    ///< younger key-frames are no loops [1, 1000]
  double near_m = 1.5;                 ///< a key-frame this near in the map is tried too [0, 10]
  double near_rad = 0.7;               ///< the same, at the same place [0, 3.2]
  int min_inliers = 30;                ///< of the alignment [10, 1000]
  double max_sigma_m = 0.06;           ///< an alignment that is less sure of any direction is refused [1e-3, 1]
  double max_sigma_rad = 0.03;         ///< the same [1e-3, 1]
  int confirm_within = 3;              ///< key-frames, in which a second one has to say the same [1, 100]
  double max_disagreement_m = 0.1;     ///< between the two [0.01, 2]
  double max_disagreement_rad = 0.05;  ///< between the two [0.01, 1]
  double spacing_m = 5.0;              ///< path between pairs of loops along one passage [0, 100]
  int latency_frames = 15;             ///< from a loop to the corrected map [1, 1000]
};

/// When a pose that was found by recognising a place is believed.
struct RelocalizationConfig {
  int min_inliers = 25;          ///< of the alignment with the recognised key-frame [10, 1000]
  double majority_sigmas = 2.3;  ///< where motion does not lead: more agree than half of the matches [0, 20]
  double max_sigma_m = 0.06;     ///< a pose that is less sure of any direction is not believed there [1e-3, 1]
  int confirmations = 2;         ///< frames that have to find the same again, unless motion leads there [0, 100]
  double near_m = 0.25;          ///< what "the same" is, and where motion leads [0.01, 5]
  double near_rad = 0.2;         ///< the same [0.01, 3]
  double speed_m_s = 1.0;        ///< between frames, without odometry [0, 10]
  double patience_s = 2.0;       ///< without a pose, after which one within reach of the last is still believed [0, 10]
  double memory_s = 0.5;         ///< longest time between frames that confirm each other [0.01, 10]
  // Where odometry contradicts the place:
  double slip_share = 0.3;  ///< of path and turn by which odometry may have erred since the last pose [0, 1]
  double evidence_m = 4.0;  ///< path along which views have to agree with a place beyond that [0.5, 100]
  int evidence_views = 3;   ///< that share no landmarks, along this path [1, 20]
};

/// Wheel odometry. Standard deviations of a random walk are those after the first metre or radian: they grow with its
/// square root. Right for a robot with wheels on floors without steps; a robot that climbs wants a larger
/// vertical_sigma and tilt_sigma.
struct OdometryConfig {
  double distance_sigma = 0.02;       ///< along the path [m] after 1 m [0, 1]
  double turn_sigma = 0.02;           ///< of the heading [rad] after a turn of 1 rad [0, 1]
  double turn_sigma_per_m = 0.01;     ///< of the heading [rad] after 1 m [0, 1]
  double scale_sigma = 0.02;          ///< share of path and turn by which it errs always, before it is learnt [0, 0.5]
  double vertical_sigma = 0.001;      ///< [m] after 1 m [0, 1]
  double tilt_sigma = 0.0005;         ///< of roll and pitch [rad] after 1 m [0, 1]
  double least_sigma = 1e-4;          ///< of every motion [m], [rad] [1e-6, 0.1]
  double max_gap_s = 0.2;             ///< between readings that belong together [0.01, 5]
  double max_speed_m_s = 5.0;         ///< faster steps are no motion of the robot [0.1, 50]
  double max_turn_rate_rad_s = 15.0;  ///< the same [0.1, 100]
  double max_disagreement = 8.0;      ///< with vision, in sigmas; odometry that disagrees more is slip [1, 100]
  double max_drift_m = 3.0;  ///< sigma of the position by odometry alone, beyond which slam is lost [0.01, 1000]
};

struct SlamConfig {
  FeatureConfig features;
  NoiseConfig noise;
  MatcherConfig matcher;
  SurfaceConfig surface;
  TrackerConfig tracker;
  KeyframeConfig keyframe;
  BundleConfig bundle;
  PoseGraphConfig pose_graph;
  LoopConfig loop;
  RelocalizationConfig relocalization;
  OdometryConfig odometry;
};

}  // namespace lapis::slam
