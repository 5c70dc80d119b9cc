#pragma once

#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// A feature of a frame, and the landmark that it shows.
struct Match {
  int feature = 0;
  LandmarkId landmark = 0;
};

/// Number of differing bits.
int hamming_distance(const Descriptor& a, const Descriptor& b);

/// Distance [m] at which a feature seen at `distance_m` on level `octave` would show on the finest level.
double finest_distance(const FeatureConfig& config, double distance_m, int octave);

/// Projects landmarks with a predicted pose and looks for similar features within `radius_px` (at the finest level) of
/// each. A feature is matched with the most similar landmark; the matches are ascending by feature.
std::vector<Match> match_by_projection(const SlamConfig& config, const Map& map,
                                       const std::vector<LandmarkId>& landmarks, const Frame& frame,
                                       const geometry::Pose& T_map_camera, double radius_px);

/// Compares all features with all landmarks of a key-frame; returns the mutually best pairs that pass the ratio test.
std::vector<Match> match_brute_force(const MatcherConfig& config, const Keyframe& keyframe, const Frame& frame);

}  // namespace lapis::slam
