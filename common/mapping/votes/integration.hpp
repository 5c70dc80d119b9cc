#pragma once

#include "common/config/schema.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/votes/compact_frame.hpp"

namespace lapis::mapping {

struct IntegrationConfig {
  double min_range_m = 0.2;      ///< measurements nearer than this say nothing
  double max_range_m = 5.0;      ///< Euclidean; returns beyond carve free space up to here
  double min_height_m = -100.0;  ///< voxels whose centre is lower (z of the map frame) get no votes
  double max_height_m = 100.0;   ///< voxels whose centre is higher get no votes; above min_height_m
  /// A voxel gets a miss only if the ray leaves it at least so far before the measured surface.
  double end_margin_voxels = 0.0;
  /// Depth noise: standard deviation of depth z is this times z^2 [1/m]. A hit is worth the probability
  /// that the noise is less than half a voxel, and misses keep two standard deviations away from the surface.
  double depth_noise_per_m = 0.0013;
  /// Length of the kernel by which hits vote for the voxels of other hits around them, in [1.5, 3]; 0: not at all.
  double kernel_length_voxels = 0.0;

  bool operator==(const IntegrationConfig&) const = default;
};

/// But for the range, which is the robot's (robot.sensing_range_m), and the kernel, which is that of a rule of fusion.
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

/// So long that every hit votes for its own voxel, and so short that a frame's box stays bounded.
inline constexpr double kMinKernelLength_voxels = 1.5, kMaxKernelLength_voxels = 3.0;

/// By how much the pose of a frame may be off: sigmas of what odometry alone has added since vision or surfaces held
/// it.
struct Drift {
  double position_m = 0.0;
  double rotation_rad = 0.0;

  bool operator==(const Drift&) const = default;
  bool is_none() const { return *this == Drift{}; }
  /// Distance up to which the displacement is at most `limit_m`; 0 when it is more everywhere, else possibly infinite.
  double range_m(double limit_m) const;
};

/// A surface that drifts is taken to be within so many displacements of where it was measured.
inline constexpr double kDriftMargin_sigmas = 3.0;

/// Throws std::runtime_error naming the value that is out of range.
void validate(const IntegrationConfig& config);

/// Largest ratio of range to resolution that compute_votes accepts; bounds its scratch memory, one byte per voxel of
/// the box around the view: 3 MB at 100 voxels, about 0.5 GB at 500.
inline constexpr double kMaxRangeInVoxels = 500.0;

/// What a frame, seen from a pose, says about the map. Each voxel gets at most one vote:
/// - a hit where a sampled pixel's point within range falls into it; its class is the majority of the voxel's labelled
///   pixels (never an average; ties go to the smaller id; unlabelled only when no pixel is labelled). Pixels weigh as
///   much as their labels are certain; the mean confidence of the class' pixels is its share of the vote, the rest is
///   an unlabelled one. Where depth noise is not small against a voxel the vote is worth less than a whole one;
/// - otherwise a miss when a ray goes through it. There is one ray per voxel that is seen (to a measured point in it,
///   the middle one in scan order), traversed exactly [Amanatides & Woo 1987]. Returns beyond max_range_m end rays
///   there without a hit. Pixels without depth say nothing.
/// With a kernel each voxel with a hit asks the hits around it, too: a hit is worth, at the point at which its ray
/// ends, what the kernel is worth at the distance to the voxel's centre. The sum, at most one vote, goes to the class
/// with most of it. Voxels in which nothing was measured get no votes: walls would grow.
/// With drift nothing is said beyond the range at which the displacement reaches half a voxel, and voxels within
/// kDriftMargin_sigmas displacements of a measured surface get no misses, so that a frame that is off by no more than
/// that takes away no surface that it sees. Of a surface beyond max_range_m only its own ray keeps that distance.
///
/// Deterministic: the same frame, pose, configuration and resolution give the same votes. Throws std::runtime_error
/// when max_range_m / resolution_m exceeds kMaxRangeInVoxels.
FrameVotes compute_votes(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                         double resolution_m, const Drift& drift = {});

}  // namespace lapis::mapping
