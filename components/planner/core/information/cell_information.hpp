#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_block.hpp"

namespace lapis::planner {

/// Value of observing a cell. A ray that reaches a cell is a miss or a hit there; o = P(occupied).
enum class Measure {
  /// Semantic mutual information [Zhang, Bong & Beltrame 2024, eq. 13-14]: g = sum_z P(z) KL(b_z || b) over the
  /// outcomes z (miss, or a hit of class c). b is the belief about free space and all classes as BeliefReader gives it;
  /// b_z is the belief after one more whole vote. Where nothing is clamped this is the paper's h; a clamped belief that
  /// stays clamped gains nothing. For fusion rules other than log_odds the definition is the same, with their own
  /// beliefs.
  kSemantic,
  /// Shannon information of occupancy [Zhang, Henderson, Karaman & Sze 2020, "FSMI"] with an exact range sensor:
  /// with r = o / (1 - o), g = o f(d_occ, r) + (1 - o) f(d_emp, r), where f(d, r) = ln((r + 1) / (r + 1/d))
  /// - ln d / (r d + 1). This is the divergence of kSemantic without classes, with the same clamp. Exact along a ray.
  kShannon,
  /// Cauchy-Schwarz quadratic information of occupancy [Charrow et al. 2015] with an exact range sensor, of a single
  /// cell: g = 3 ln(o^2 + (1 - o)^2) - 2 ln(o^3 + (1 - o)^3). It does not depend on how votes change beliefs. Exact for
  /// one cell. Along a ray, the sum of reach * g only approximates the ray's quadratic information, which couples all
  /// cells and grows faster through unknown space (o = 0.2: 0.32, not 0.27, after two cells; 1.85, not 0.63, after
  /// eight).
  kCsqmi,
};

/// The model of a ray's observations. One vote, with the beliefs alone, is the paper's model.
struct RayModel {
  Measure measure = Measure::kSemantic;
  /// Number of whole votes that a ray stands for, all with the same outcome: a robot that passes looks many times, and
  /// what it has seen this often has nothing more to tell; in [1, 30]. kCsqmi always uses 1.
  int votes = 1;
  /// Probability that a ray ends in a voxel that was never observed, in (0, 1); 0: the sensor model's prior. Voxels are
  /// not independent: behind free space there is mostly free space.
  double unknown_occupied = 0.0;
  /// The same for such a voxel that shares a face with an occupied one: surfaces continue where nobody has looked.
  /// Without this, rays leave the building through holes in its floors, walls and ceilings and promise what is behind;
  /// 0: no difference.
  double surface_occupied = 0.0;
};

/// What rays need to know about a cell.
struct CellInformation {
  double free = 0.0;  ///< P(free), with which the ray continues
  double gain = 0.0;  ///< g, expected information for a ray that reaches the cell [nats], >= 0
};

/// Converts the counts of a voxel to CellInformation.
class CellMeasure {
 public:
  /// Throws std::runtime_error naming the parameter of the sensor model that is out of range.
  CellMeasure(const mapping::SensorModel& model, const RayModel& ray);

  /// O(k), where k is the number of classes hit plus the number of distinct prior shares; O(k^2) at worst, where shares
  /// are clamped. A table look-up where nothing was hit.
  CellInformation of(const mapping::VoxelCounts& counts) const;
  /// True when the voxel was observed and is more probably occupied than not.
  bool is_occupied(const mapping::VoxelCounts& counts) const { return reader_.is_occupied(counts); }
  const RayModel& ray() const { return ray_; }

 private:
  /// Classes with equal prior share, and the gains of one vote.
  struct PriorGroup {
    double prior;
    double other_gain;   ///< phi_c of BeliefReader
    double own_surplus;  ///< psi_c - phi_c
    std::size_t size = 0;
  };
  /// Classes of one voxel that do not differ: a class that was hit, or all classes of a prior group that were not hit.
  struct Kind {
    double size;         ///< number of classes
    double log_share;    ///< log of each class's share, given occupied, minus that of the voxel's largest share
    double own_surplus;  ///< what a ray that hits one of the classes adds to its log_share
    double other_gain;   ///< what the same ray adds to the log-odds of all other classes
  };

  void group_priors();
  CellInformation compute(const mapping::VoxelCounts& counts) const;
  /// Mean of the divergence over the classes that a hit may have.
  double mean_hit_divergence(const mapping::VoxelCounts& counts) const;
  std::vector<Kind> kinds_of(const mapping::VoxelCounts& counts) const;
  Kind kind_of(const PriorGroup& group, double size, double votes_of_class) const;
  double clamped(double log_odds) const;

  mapping::BeliefReader reader_;
  mapping::BeliefReader unclamped_reader_;
  RayModel ray_;
  std::vector<PriorGroup> groups_;
  std::vector<std::size_t> group_of_;       ///< by label - 1
  std::vector<CellInformation> by_misses_;  ///< voxels without hits, by whole votes
};

}  // namespace lapis::planner
