#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "common/mapping/votes/cell_hits.hpp"
#include "common/mapping/votes/integration.hpp"

namespace lapis::mapping::test {

/// A voxel's vote: weight per label [1/256 vote].
using Ballot = std::map<int, std::uint32_t>;

inline Ballot whole_vote(int label) { return {{label, kOneVote}}; }

/// Votes voxel by voxel.
struct PlainVotes {
  std::set<VoxelIndex> misses;
  std::map<VoxelIndex, Ballot> hits;
  bool operator==(const PlainVotes&) const = default;
};

/// compute_votes in its plainest form: sample by sample, wall by wall, with the same arithmetic, so that the result
/// must be the same to the last vote. Heights are not cut.
class PlainIntegration {
 public:
  PlainIntegration(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                   double resolution_m)
      : frame_(frame), config_(config), resolution_m_(resolution_m), max_range_(config.max_range_m / resolution_m),
        T_(T_map_camera) {
    // Coordinates relative to a corner of whole blocks near the camera: the numbers that compute_votes rounds.
    const auto [low, high] = reach();
    for (int axis = 0; axis < 3; ++axis) {
      const int margin = 1 + static_cast<int>(std::ceil(config.kernel_length_voxels));
      const auto first = static_cast<std::int32_t>(std::floor(low[axis])) - margin;
      corner_[axis] = floor_divide(first, kBlockEdge) * kBlockEdge;
    }
    camera_ = T_map_camera.translation() / resolution_m - corner_.cast<double>();
  }

  PlainVotes votes() const {
    struct Cell {
      std::vector<std::uint32_t> hits, beyond;
    };
    std::map<VoxelIndex, Cell> cells;
    for (std::uint32_t sample = 0; sample < frame_.samples(); ++sample) {
      Eigen::Vector3d ray = ray_of(sample);
      const double squared = ray.squaredNorm();
      const double min_range = config_.min_range_m / resolution_m_;
      if (frame_.depth_mm()[sample] == 0 || squared < min_range * min_range) continue;
      const bool is_beyond = squared > max_range_ * max_range_;
      if (is_beyond) ray *= max_range_ / std::sqrt(squared);
      Cell& cell = cells[voxel((camera_ + ray).cast<int>())];
      (is_beyond ? cell.beyond : cell.hits).push_back(sample);
    }
    PlainVotes votes;
    std::map<VoxelIndex, Eigen::Vector3d> points;
    for (const auto& [index, cell] : cells) {
      const bool is_hit = !cell.hits.empty();
      const auto& deciding = is_hit ? cell.hits : cell.beyond;
      const std::uint32_t middle = deciding[deciding.size() / 2];
      if (is_hit) votes.hits[index] = majority(cell.hits, weight_at(frame_.depth_mm()[middle] * 1e-3));
      if (is_hit) points[index] = camera_ + ray_of(middle);
      miss(middle, is_hit, votes.misses);
    }
    for (const auto& [index, ballot] : votes.hits) votes.misses.erase(index);
    if (config_.kernel_length_voxels > 0.0) smooth(points, votes);
    return votes;
  }

 private:
  std::pair<Eigen::Vector3d, Eigen::Vector3d> reach() const {
    const geometry::PinholeCamera& camera = frame_.camera();
    Eigen::Vector3d low = T_.translation(), high = low;
    for (const double u : {0.0, camera.width - 1.0})
      for (const double v : {0.0, camera.height - 1.0}) {
        const Eigen::Vector3d p = T_ * camera.unproject(u, v, config_.max_range_m);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    const auto range = Eigen::Vector3d::Constant(config_.max_range_m);
    return {low.cwiseMax(T_.translation() - range) / resolution_m_,
            high.cwiseMin(T_.translation() + range) / resolution_m_};
  }

  Eigen::Vector3d ray_of(std::uint32_t sample) const {
    const geometry::PinholeCamera& camera = frame_.camera();
    const Eigen::Matrix3d R = T_.linear();
    const double per_mm = 1e-3 / resolution_m_;
    const int column = static_cast<int>(sample) % frame_.columns(), row = static_cast<int>(sample) / frame_.columns();
    const Eigen::Vector3d corner =
        (R.col(2) - R.col(0) * (camera.cx / camera.fx) - R.col(1) * (camera.cy / camera.fy)) * per_mm;
    const Eigen::Vector3d x_step = R.col(0) * (frame_.stride() / camera.fx * per_mm);
    const Eigen::Vector3d y_step = R.col(1) * (frame_.stride() / camera.fy * per_mm);
    return (corner + x_step * column + y_step * row) * frame_.depth_mm()[sample];
  }

  /// Noise of less than half a voxel to either side.
  std::uint32_t weight_at(double depth_m) const {
    const double sigma_m = config_.depth_noise_per_m * depth_m * depth_m;
    if (sigma_m == 0.0) return kOneVote;
    const auto below = [&](double offset_m) { return 0.5 * std::erfc(-offset_m / (sigma_m * std::sqrt(2.0))); };
    const double probability = below(resolution_m_ / 2) - below(-resolution_m_ / 2);
    return std::max(1u, static_cast<std::uint32_t>(std::floor(probability * kOneVote + 0.5)));
  }

  Ballot majority(const std::vector<std::uint32_t>& samples, std::uint32_t weight) const {
    std::map<int, std::pair<std::uint64_t, std::uint64_t>> tally;  // confidence, samples
    for (const std::uint32_t sample : samples) {
      if (!frame_.has_labels() || frame_.labels()[sample] == 0) continue;
      auto& [confidence, count] = tally[frame_.labels()[sample]];
      confidence += frame_.confidence().empty() ? 255u : frame_.confidence()[sample];
      ++count;
    }
    int label = 0;
    std::uint64_t most = 0, share = 0;
    for (const auto& [candidate, votes] : tally) {
      if (votes.first <= most) continue;
      label = candidate;
      most = votes.first;
      share = (votes.first * kOneVote + 127 * votes.second) / (255 * votes.second);
    }
    return split(label, weight * static_cast<std::uint32_t>(share) / kOneVote, weight);
  }

  static Ballot split(int label, std::uint32_t share, std::uint32_t weight) {
    Ballot ballot;
    if (share > 0) ballot[label] = share;
    if (share < weight) ballot[0] = weight - share;
    return ballot;
  }

  /// Every voxel with a hit asks the others.
  void smooth(const std::map<VoxelIndex, Eigen::Vector3d>& points, PlainVotes& votes) const {
    std::map<VoxelIndex, Ballot> smoothed;
    for (const auto& [voxel, own] : votes.hits) {
      const Eigen::Vector3d center =
          (Eigen::Vector3i(voxel.x, voxel.y, voxel.z) - corner_).cast<double>().array() + 0.5;
      std::map<int, std::uint32_t> tally;
      std::uint32_t sum = 0, labelled = 0;
      for (const auto& [hit, point] : points) {
        const double share = (center - point).norm() / config_.kernel_length_voxels;
        std::uint32_t worth = 0;
        for (const auto& [label, part] : votes.hits.at(hit)) worth += part;
        const auto weight = static_cast<std::uint32_t>(std::floor(sparse_kernel(share) * worth + 0.5));
        sum += weight;
        for (const auto& [label, part] : votes.hits.at(hit)) {
          if (label == 0) continue;
          tally[label] += weight * part / worth;
          labelled += weight * part / worth;
        }
      }
      int best = 0;
      std::uint32_t most = 0;
      for (const auto& [label, weight] : tally)
        if (weight > most) best = label, most = weight;
      const std::uint32_t weight = std::min(sum, kOneVote);
      smoothed[voxel] = split(best, weight * labelled / sum, weight);
    }
    votes.hits = std::move(smoothed);
  }

  void miss(std::uint32_t sample, bool is_hit, std::set<VoxelIndex>& misses) const {
    Eigen::Vector3d ray = ray_of(sample);
    const double range = ray.norm(), depth_m = frame_.depth_mm()[sample] * 1e-3;
    const double noise_m = config_.depth_noise_per_m * depth_m * depth_m;
    const double margin = config_.end_margin_voxels + 2.0 * noise_m / resolution_m_;
    const double t_end = is_hit ? 1.0 - margin / range : 1.0;
    if (!is_hit) ray *= max_range_ / range;
    const auto fixed = [](double t) { return static_cast<std::int64_t>(t * static_cast<double>(1ll << 44)); };
    Eigen::Vector3i cell = camera_.cast<int>();
    std::array<std::int64_t, 3> t_exit{}, t_cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<int>(axis);
      const double along = std::abs(ray[i]);
      const double to_wall = ray[i] > 0.0 ? cell[i] + 1 - camera_[i] : camera_[i] - cell[i];
      t_exit[axis] = along > 1e-3 ? fixed(to_wall / along) : 1ll << 60;
      t_cell[axis] = along > 1e-3 ? fixed(1.0 / along) : 1ll << 60;
    }
    while (true) {
      const auto first = std::min_element(t_exit.begin(), t_exit.end());  // the lowest axis of equals
      if (*first > fixed(t_end)) return;
      misses.insert(voxel(cell));
      const auto axis = static_cast<int>(first - t_exit.begin());
      cell[axis] += ray[axis] > 0.0 ? 1 : -1;
      *first += t_cell[static_cast<std::size_t>(axis)];
    }
  }

  VoxelIndex voxel(const Eigen::Vector3i& cell) const {
    return {corner_[0] + cell[0], corner_[1] + cell[1], corner_[2] + cell[2]};
  }

  const CompactFrame& frame_;
  const IntegrationConfig& config_;
  double resolution_m_;
  double max_range_;  ///< [voxels]
  geometry::Pose T_;
  Eigen::Vector3i corner_;
  Eigen::Vector3d camera_;  ///< from the corner [voxels]
};

}  // namespace lapis::mapping::test
