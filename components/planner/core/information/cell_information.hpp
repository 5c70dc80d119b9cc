#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_block.hpp"

namespace lapis::planner {

/// What it is worth to observe a cell. A ray that reaches a cell is a miss or a hit there; o = P(occupied).
enum class Measure {
  /// Semantic mutual information [Zhang, Bong & Beltrame 2024, eq. 13-14]: g = sum_z P(z) KL(b_z || b) over the
  /// outcomes z (miss, or a hit of class c); b is the belief about free space and all classes as BeliefReader gives it,
  /// b_z what it will give after one more whole vote. Where nothing is clamped this is the paper's h; a clamped belief
  /// that stays clamped gains nothing. By fusion rules other than log_odds it is the same with their own beliefs.
  kSemantic,
  /// Shannon information of occupancy [Zhang, Henderson, Karaman & Sze 2020, "FSMI"] with an exact range sensor: of
  /// r = o / (1 - o), g = o f(d_occ, r) + (1 - o) f(d_emp, r), f(d, r) = ln((r + 1) / (r + 1/d)) - ln d / (r d + 1),
  /// which is the divergence of kSemantic without classes: the same clamp holds. Exact along a ray.
  kShannon,
  /// Cauchy-Schwarz quadratic information of occupancy [Charrow et al. 2015] with an exact range sensor, of the cell
  /// alone: g = 3 ln(o^2 + (1 - o)^2) - 2 ln(o^3 + (1 - o)^3). It does not depend on how votes change beliefs. Exact
  /// for one cell; along a ray the sum of reach * g only stands for theirs, which couples all cells and grows faster
  /// through unknown space (o = 0.2: 0.32 instead of 0.27 after two cells, 1.85 instead of 0.63 after eight).
  kCsqmi,
};

/// What is expected of a ray. A single vote, by the beliefs alone, is the paper's.
struct RayModel {
  Measure measure = Measure::kSemantic;
  /// Whole votes that a ray stands for, all with the same outcome: a robot that passes looks many times, and what it
  /// has seen so often has nothing more to tell; in [1, 30]. Always 1 of kCsqmi.
  int votes = 1;
  /// Probability that a ray ends in a voxel that was never observed, in (0, 1); 0: the sensor model's prior. Voxels are
  /// not independent: free space lies behind free space.
  double unknown_occupied = 0.0;
  /// The same beside an occupied voxel, face to face: surfaces go on where nobody has looked, and without this, rays
  /// leave the building through holes of its floors, walls and ceilings, and promise what is behind; 0: no difference.
  double surface_occupied = 0.0;
};

/// All that rays have to know about a cell.
struct CellInformation {
  double free = 0.0;  ///< P(free): the ray continues
  double gain = 0.0;  ///< g, expected information for a ray that reaches the cell [nats], >= 0
};

/// Turns counts into what rays have to know.
class CellMeasure {
 public:
  /// Throws std::runtime_error naming the parameter of the sensor model that is out of range.
  CellMeasure(const mapping::SensorModel& model, const RayModel& ray);

  /// O(k), k = classes that were hit + distinct prior shares; O(k^2) at worst, where shares are clamped. A look-up
  /// where nothing was hit.
  CellInformation of(const mapping::VoxelCounts& counts) const;
  /// Observed, and more probably occupied than not.
  bool is_occupied(const mapping::VoxelCounts& counts) const { return reader_.is_occupied(counts); }
  const RayModel& ray() const { return ray_; }

 private:
  /// Classes of equal prior share; gains of one vote.
  struct PriorGroup {
    double prior;
    double other_gain;   ///< phi_c of BeliefReader
    double own_surplus;  ///< psi_c - phi_c
    std::size_t size = 0;
  };
  /// Classes of one voxel that nothing distinguishes: one that was hit, or those of a prior group that were not.
  struct Kind {
    double size;         ///< how many they are
    double log_share;    ///< of each, given occupied; 0 for the largest share of the voxel
    double own_surplus;  ///< what a ray that hits one of them adds to its log_share
    double other_gain;   ///< what it adds to the log-odds of all others
  };

  void group_priors();
  CellInformation compute(const mapping::VoxelCounts& counts) const;
  /// Mean divergence over the classes that a hit can be of.
  double mean_hit_divergence(const mapping::VoxelCounts& counts) const;
  std::vector<Kind> kinds_of(const mapping::VoxelCounts& counts) const;
  Kind kind_of(const PriorGroup& group, double size, double votes_of_class) const;
  double clamped(double log_odds) const;

  mapping::BeliefReader reader_;
  mapping::BeliefReader unclamped_reader_;
  RayModel ray_;
  std::vector<PriorGroup> groups_;
  std::vector<std::size_t> group_of_;       ///< index label - 1
  std::vector<CellInformation> by_misses_;  ///< of voxels without hits, by whole votes
};

}  // namespace lapis::planner
