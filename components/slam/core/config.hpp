#pragma once

namespace lapis::slam {

/// ORB features spread over the image.
struct FeatureConfig {
  int max_features = 600;     ///< features per frame, all levels together [100, 5000]
  int levels = 4;             ///< pyramid levels [1, 12]
  double scale_factor = 1.3;  ///< size ratio of neighbouring levels [1.05, 2]
  int fast_threshold = 10;    ///< FAST contrast, grey levels; less where corners are few [1, 100]
  /// Least ratio of the smaller to the larger eigenvalue of a corner's structure tensor [0, 1]; below it is an edge.
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
  double wide_search_radius_px = 40.0;  ///< the same for the second attempt [2, 300]
  int max_distance = 70;                ///< Hamming distance of two descriptors of 256 bits [10, 128]
  double max_ratio = 0.85;              ///< of the best to the second best distance [0.3, 1]
};

/// Surface patches of key-frames, aligned with the depth image (point to plane).
struct SurfaceConfig {
  bool enabled = true;
  int grid_step_px = 12;         ///< edge of a cell of the depth image; each cell gives at most one sample [4, 64]
  int keyframes = 2;             ///< whose samples are aligned: the reference and its most covisible ones [1, 5]
  double max_distance_m = 0.10;  ///< gate on plane distances in the first round; wider where depth is noisier [0.01, 1]
  double weight = 0.2;           ///< below 1, because the errors of neighbouring samples are correlated [0.001, 1]
  // The rest applies where features are too few:
  int near_keyframes = 3;         ///< nearest of the newest and covisible ones, whose samples are aligned [1, 10]
  int min_matches = 150;          ///< least number of samples that find their surface again [10, 100000]
  double min_share = 0.6;         ///< least share of the samples in view that are seen again [0, 1]
  double least_cosine2 = 0.02;    ///< mean squared cosine with the normals, below which a direction is open [1e-4, 0.3]
  double max_disagreement = 4.0;  ///< of surfaces and motion, in sigmas; above it surfaces are not believed [1, 100]
};

struct TrackerConfig {
  int min_matches = 30;          ///< an attempt with fewer inliers is followed by the next kind of matching [6, 500]
  int min_inliers = 15;          ///< a frame with fewer after the refinement has no pose [6, 200]
  double rival_sigmas = 2.3;     ///< inliers beyond those of any other pose and of chance, in sigmas [0, 20]
  int local_keyframes = 5;       ///< key-frames whose landmarks form the local map [1, 50]
  int ransac_iterations = 200;   ///< rounds of PnP with RANSAC [10, 10000]
  double ransac_error_px = 4.0;  ///< PnP inlier threshold [0.5, 20]
  int refine_iterations = 4;     ///< Levenberg-Marquardt steps per round [1, 50]
  int min_first_features = 100;  ///< features with depth to begin without odometry; max_features / 2 suffice [6, 5000]
  /// Frames in a row with enough features but no pose, after which the map continues at the pose of odometry [1, 1000].
  int max_blind_frames = 8;
  int max_contradictions = 5;     ///< frames in a row that contradict odometry, before slam is lost [1, 1000]
  double max_prediction_s = 0.5;  ///< longest gap that the motion model bridges [0.01, 5]
};

/// A frame becomes a key-frame when min_frames have passed since the last one and it violates one of the other limits.
struct KeyframeConfig {
  double min_tracked_share = 0.25;  ///< least share of the reference key-frame's landmarks that is tracked [0, 1]
  double max_translation_m = 0.40;  ///< distance from the reference key-frame [0.01, 5]
  double max_rotation_rad = 0.30;   ///< angle to the reference key-frame [0.01, 3]
  int min_frames = 3;               ///< least number of frames between key-frames [1, 100]
};

struct BundleConfig {
  int window = 6;            ///< free key-frames [1, 30]
  int max_fixed = 6;         ///< fixed key-frames that see the same landmarks [1, 50]
  int max_landmarks = 1000;  ///< the newest ones are kept [50, 20000]
  int max_iterations = 5;    ///< Levenberg-Marquardt steps [1, 100]
};

/// How the Hessian of an alignment becomes the information of an edge: docs/decisions/0025. The bounds on the
/// eigenvalues keep an edge from having no information in a direction, or too much.
struct PoseGraphConfig {
  double information_share = 0.5;  ///< share of an alignment's information that its edge gets [1e-3, 1]
  double min_information = 1.0;    ///< [1/m^2, 1/rad^2] [1e-6, 1e6]
  double max_information = 1e8;    ///< [1/m^2, 1/rad^2] [1, 1e12]
};

/// Recognition of places that were seen before, at key-frames.
struct LoopConfig {
  bool enabled = true;
  int candidates = 3;  ///< most similar key-frames that are verified [1, 20]
  int min_gap = 10;    ///< this many of the newest key-frames are no candidates [1, 1000]
  /// The nearest key-frame in the map is tried, too, if distance / near_m + angle / near_rad < 1.
  double near_m = 1.5;                 ///< [0, 10]
  double near_rad = 0.7;               ///< [0, 3.2]
  int min_inliers = 30;                ///< of the alignment with the older key-frame [10, 1000]
  double max_sigma_m = 0.06;           ///< largest position sigma of an alignment, in any direction [1e-3, 1]
  double max_sigma_rad = 0.03;         ///< the same for the rotation [1e-3, 1]
  int confirm_within = 3;              ///< key-frames within which a second one has to find the same loop [1, 100]
  double max_disagreement_m = 0.1;     ///< between these two loops [0.01, 2]
  double max_disagreement_rad = 0.05;  ///< between these two loops [0.01, 1]
  double spacing_m = 5.0;              ///< least path between two pairs of loops [0, 100]
  int latency_frames = 15;             ///< from the start of an optimisation until it corrects the map [1, 1000]
};

/// Conditions under which a pose that was found by recognising a place is believed.
struct RelocalizationConfig {
  int min_inliers = 25;       ///< of the alignment with the recognised key-frame [10, 1000]
  double max_sigma_m = 0.06;  ///< largest position sigma of a pose there, in any direction [1e-3, 1]
  int confirmations = 2;      ///< further frames that have to find the same pose there [0, 100]
  double near_m = 0.25;       ///< distance of poses that count as the same, and from the prediction [0.01, 5]
  double near_rad = 0.2;      ///< the same for the angle [0.01, 3]
  double speed_m_s = 1.0;     ///< assumed speed between frames, without odometry [0, 10]
  double patience_s = 2.0;    ///< after the last pose, while one within reach of it is believed at once [0, 10]
  double memory_s = 0.5;      ///< longest time between frames that confirm each other [0.01, 10]
  // Where odometry contradicts the place:
  double slip_share = 0.3;  ///< share of path and turn since the last pose that slip may explain [0, 1]
  double evidence_m = 4.0;  ///< path along which views have to agree with a place that slip does not explain [0.5, 100]
  int evidence_views = 3;   ///< number of these views; they share no landmarks [1, 20]
};

/// Sub-maps: without odometry, mapping goes on where no place is recognised, and the parts are joined later. Buildings
/// repeat themselves, so that one recognised place says little: a room may be the copy of another one.
struct SubMapConfig {
  int after_frames = 30;    ///< lost frames in a row with enough features, before a sub-map begins; 0: never [0, 1000]
  double evidence_m = 3.0;  ///< distance over which key-frames have to agree [0.5, 100]
  double room_m = 7.0;      ///< distance between what they show; more than in a room that has copies [0.5, 100]
  int evidence_views = 3;   ///< number of them that share no landmarks [1, 20]
};

/// Wheel odometry. The standard deviations of a random walk are those after 1 m or 1 rad; they grow with the square
/// root of path and turn. The defaults suit a robot with wheels on floors without steps; a robot that climbs needs a
/// larger vertical_sigma and tilt_sigma.
struct OdometryConfig {
  double distance_sigma = 0.02;       ///< along the path [m] after 1 m [0, 1]
  double turn_sigma = 0.02;           ///< of the heading [rad] after a turn of 1 rad [0, 1]
  double turn_sigma_per_m = 0.01;     ///< of the heading [rad] after 1 m [0, 1]
  double scale_sigma = 0.02;          ///< of the scales of path and turn, before they are learnt [0, 0.5]
  double vertical_sigma = 0.001;      ///< [m] after 1 m [0, 1]
  double tilt_sigma = 0.0005;         ///< of roll and pitch [rad] after 1 m [0, 1]
  double least_sigma = 1e-4;          ///< of every motion, however short [m], [rad] [1e-6, 0.1]
  double max_gap_s = 0.2;             ///< longest time between readings of one track [0.01, 5]
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
  SubMapConfig sub_map;
  OdometryConfig odometry;
};

}  // namespace lapis::slam
