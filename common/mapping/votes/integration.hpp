#pragma once

#include "common/config/schema.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/votes/compact_frame.hpp"

namespace lapis::mapping {

struct IntegrationConfig {
  double min_range_m = 0.2;      ///< measurements nearer than this are ignored
  double max_range_m = 5.0;      ///< Euclidean; measurements beyond it give misses up to this range
  double min_height_m = -100.0;  ///< voxels whose centre is lower (z of the map frame) get no votes
  double max_height_m = 100.0;   ///< voxels whose centre is higher get no votes; above min_height_m
  /// A voxel gets a miss only if the ray leaves it at least this far before the measured surface.
  double end_margin_voxels = 0.0;
  /// Depth noise: standard deviation of depth z is this times z^2 [1/m]. The weight of a hit is the probability that
  /// the noise is less than half a voxel, and misses keep a distance of two standard deviations from the surface.
  double depth_noise_per_m = 0.0013;
  /// Length of the kernel with which hits vote for the voxels of other hits around them, in [1.5, 3]; 0: no kernel.
  double kernel_length_voxels = 0.0;

  bool operator==(const IntegrationConfig&) const = default;
};

/// All keys except the maximum range, which belongs to the robot (robot.sensing_range_m), and the kernel length, which
/// belongs to the fusion rule.
template <class Field>
void describe(Field& field, IntegrationConfig& c) {
  field("min_range_m", c.min_range_m, config::in_range(0.0, 5.0),
        "shortest range of measurements that give votes; nearer ones are ignored [m]");
  field("min_height_m", c.min_height_m, config::in_range(-1000.0, 1000.0),
        "lowest height of voxels that get votes: of their centre, z of the map frame [m]");
  field("max_height_m", c.max_height_m, config::in_range(-1000.0, 1000.0),
        "largest height of voxels that get votes: of their centre, z of the map frame [m]");
  field("end_margin_voxels", c.end_margin_voxels, config::in_range(0.0, 3.0),
        "least distance of a voxel with a miss from the measured surface along the ray, besides two standard "
        "deviations of depth noise [voxels]");
  field("depth_noise_per_m", c.depth_noise_per_m, config::in_range(0.0, 0.05),
        "depth noise: standard deviation of depth z over z^2; it lowers the weight of hits, and misses end two "
        "standard deviations before surfaces [1/m]");
}

/// The minimum makes every hit vote for its own voxel; the maximum bounds the size of a frame's box.
inline constexpr double kMinKernelLength_voxels = 1.5, kMaxKernelLength_voxels = 3.0;

/// Uncertainty of a frame's pose: standard deviations of the drift of odometry since vision or surfaces last
/// constrained the pose.
struct Drift {
  double position_m = 0.0;
  double rotation_rad = 0.0;

  bool operator==(const Drift&) const = default;
  bool is_none() const { return *this == Drift{}; }
  /// Distance [m] up to which the displacement is at most `limit_m`; 0 when it is larger everywhere, infinite when it
  /// is at most `limit_m` at any distance.
  double range_m(double limit_m) const;
};

/// With drift, a surface is assumed to be within this many displacements of its measured position.
inline constexpr double kDriftMargin_sigmas = 3.0;

/// Throws std::runtime_error naming the value that is out of range.
void validate(const IntegrationConfig& config);

/// Largest ratio of range to resolution that compute_votes accepts; bounds its working memory, which is one byte per
/// voxel of the box around the view: 3 MB at 100 voxels, about 0.5 GB at 500.
inline constexpr double kMaxRangeInVoxels = 500.0;

/// The votes of a frame at a pose for the map. Each voxel gets at most one vote:
/// - a hit if the point of a sampled pixel within range is in it. Its class is that of the majority of the voxel's
///   labelled pixels (never an average; ties go to the smaller id; unlabelled only when no pixel is labelled). Pixels
///   are weighted by the confidence of their labels; the mean confidence of the pixels of the class is the share of the
///   vote for the class, and the rest of the vote is unlabelled. Where depth noise is not small compared with a voxel,
///   the vote has less than the full weight;
/// - otherwise a miss if a ray passes through it. There is one ray per voxel that is seen (to a measured point in it,
///   the middle one in scan order), which is traversed exactly [Amanatides & Woo 1987]. The ray of a measurement beyond
///   max_range_m ends at that range without a hit. Pixels without depth give no votes.
/// With a kernel, each voxel with a hit also gets votes of the hits around it: the weight of a hit is multiplied by the
/// kernel at the distance from the end of its ray to the voxel's centre. The sum is limited to one vote, and its
/// labelled share goes to the class with the largest weight. Voxels without a measurement get no votes, because walls
/// would grow.
/// With drift, there are no votes beyond the range at which the displacement reaches half a voxel, and voxels within
/// kDriftMargin_sigmas displacements of a measured surface get no misses, so that a frame whose pose error is within
/// this margin removes no surface that it sees. For a surface beyond max_range_m, only its own ray keeps this distance.
///
/// Deterministic: the same frame, pose, configuration and resolution give the same votes. Throws std::runtime_error
/// when max_range_m / resolution_m exceeds kMaxRangeInVoxels.
FrameVotes compute_votes(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                         double resolution_m, const Drift& drift = {});

}  // namespace lapis::mapping
