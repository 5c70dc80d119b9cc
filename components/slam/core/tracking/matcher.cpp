#include "slam/core/tracking/matcher.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include <opencv2/core.hpp>

#include "slam/core/frame/noise_model.hpp"

namespace lapis::slam {
namespace {

struct Candidate {
  int feature = 0;
  int distance = 0;
};

// Where, and on which level, a landmark should show.
struct Projection {
  Eigen::Vector2d pixel;
  double depth_m = 0.0;
  int octave = 0;
};

std::optional<Projection> project(const SlamConfig& config, const geometry::PinholeCamera& camera,
                                  const geometry::Pose& T_camera_map, const Landmark& landmark) {
  const Eigen::Vector3d p = T_camera_map.linear() * landmark.p_map + T_camera_map.translation();
  if (p.z() < config.noise.min_depth_m) return std::nullopt;
  Projection projection{camera.project(p), p.z(), 0};
  if (!camera.contains(projection.pixel)) return std::nullopt;
  const double level = std::log(landmark.finest_distance_m / p.norm()) / std::log(config.features.scale_factor);
  // A landmark far outside the pyramid's range of scales cannot look like its descriptor.
  if (level < -2.0 || level > config.features.levels + 1.0) return std::nullopt;
  projection.octave = std::clamp(static_cast<int>(std::lround(level)), 0, config.features.levels - 1);
  return projection;
}

// The gate is wide, because the prediction is uncertain: it only keeps features of other surfaces out.
bool depth_agrees(const Feature& feature, double predicted_m) {
  return feature.depth_m <= 0.0 || std::abs(feature.depth_m - predicted_m) < 0.2 + 0.1 * predicted_m;
}

std::optional<Candidate> most_similar(const SlamConfig& config, const Landmark& landmark, const Frame& frame,
                                      const Projection& projection, const std::vector<int>& nearby) {
  constexpr int kWorst = 257;
  Candidate best{-1, kWorst};
  int second = kWorst;
  for (const int i : nearby) {
    const Feature& feature = frame.features[static_cast<std::size_t>(i)];
    if (std::abs(feature.octave - projection.octave) > 1 || !depth_agrees(feature, projection.depth_m)) continue;
    const int distance = hamming_distance(feature.descriptor, landmark.descriptor);
    if (distance < best.distance) {
      second = best.distance;
      best = {i, distance};
    } else {
      second = std::min(second, distance);
    }
  }
  if (best.distance > config.matcher.max_distance) return std::nullopt;
  if (best.distance > config.matcher.max_ratio * second) return std::nullopt;
  return best;
}

cv::Mat descriptor_matrix(const std::vector<const Descriptor*>& descriptors) {
  cv::Mat matrix(static_cast<int>(descriptors.size()), sizeof(Descriptor), CV_8UC1);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    std::memcpy(matrix.ptr(static_cast<int>(i)), descriptors[i]->data(), sizeof(Descriptor));
  }
  return matrix;
}

// The most similar of the descriptors offered, and how similar the second best is.
struct Partner {
  int index = -1;
  int distance = 257, second = 257;

  void offer(int other, int with_distance) {
    if (with_distance < distance) {
      second = distance;
      distance = with_distance;
      index = other;
    } else {
      second = std::min(second, with_distance);
    }
  }
  bool is_clear(const MatcherConfig& config) const {
    return distance <= config.max_distance &&
           static_cast<float>(distance) <= static_cast<float>(config.max_ratio) * static_cast<float>(second);
  }
};

}  // namespace

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::popcount(a[i] ^ b[i]);
  return distance;
}

double finest_distance(const FeatureConfig& config, double distance_m, int octave) {
  return distance_m * std::pow(config.scale_factor, octave);
}

std::vector<Match> match_by_projection(const SlamConfig& config, const Map& map,
                                       const std::vector<LandmarkId>& landmarks, const Frame& frame,
                                       const geometry::Pose& T_map_camera, double radius_px) {
  const geometry::Pose T_camera_map = T_map_camera.inverse();
  struct Claim {
    LandmarkId landmark = kNoLandmark;
    int distance = 257;
  };
  std::vector<Claim> claims(frame.features.size());
  std::vector<int> nearby;
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = map.landmark(id);
    const auto projection = project(config, frame.input->camera, T_camera_map, landmark);
    if (!projection) continue;
    nearby.clear();
    frame.index.find(projection->pixel, radius_px * std::pow(config.features.scale_factor, projection->octave), nearby);
    const auto best = most_similar(config, landmark, frame, *projection, nearby);
    if (!best) continue;
    Claim& claim = claims[static_cast<std::size_t>(best->feature)];
    if (best->distance < claim.distance) claim = {id, best->distance};
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    if (claims[i].landmark != kNoLandmark) matches.push_back({static_cast<int>(i), claims[i].landmark});
  }
  return matches;
}

std::vector<Match> match_brute_force(const MatcherConfig& config, const Keyframe& keyframe, const Frame& frame) {
  std::vector<const Descriptor*> seen;
  std::vector<const Descriptor*> known;
  std::vector<LandmarkId> ids;
  for (const Feature& feature : frame.features) seen.push_back(&feature.descriptor);
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (keyframe.landmarks[i] == kNoLandmark) continue;
    known.push_back(&keyframe.features[i].descriptor);
    ids.push_back(keyframe.landmarks[i]);
  }
  if (seen.size() < 2 || known.size() < 2) return {};
  cv::Mat distances;
  cv::batchDistance(descriptor_matrix(seen), descriptor_matrix(known), distances, CV_32S, cv::noArray(),
                    cv::NORM_HAMMING);
  std::vector<Partner> of_seen(seen.size()), of_known(known.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const int* row = distances.ptr<int>(static_cast<int>(i));
    for (std::size_t j = 0; j < known.size(); ++j) {
      of_seen[i].offer(static_cast<int>(j), row[j]);
      of_known[j].offer(static_cast<int>(i), row[j]);
    }
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < of_seen.size(); ++i) {
    if (!of_seen[i].is_clear(config)) continue;
    const auto j = static_cast<std::size_t>(of_seen[i].index);
    if (of_known[j].is_clear(config) && of_known[j].index == static_cast<int>(i)) {
      matches.push_back({static_cast<int>(i), ids[j]});
    }
  }
  return matches;
}

}  // namespace lapis::slam
