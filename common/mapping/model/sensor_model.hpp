#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/config/schema.hpp"
#include "common/mapping/model/voxel_block.hpp"

namespace lapis::mapping {

/// How a frame's votes change the belief about a voxel. Class ids are 1..class_count; a hit of class 0 (unlabelled) or
/// of an id above the list supports "occupied", but no class.
struct SensorModel {
  double hit_gain = 0.85;       ///< l: log-odds gain of "occupied" by a first hit
  double miss_gain = 0.4;       ///< m: log-odds loss of "occupied" by a miss
  double label_accuracy = 0.7;  ///< a: probability that a label is right, above 1/class_count
  double prior_occupied = 0.2;  ///< P0 of a voxel that was never observed
  int class_count = 40;         ///< C
  /// Prior share of each class given occupied, size C and sum 1; empty = uniform.
  std::vector<double> class_priors;
  /// Uses the paper's own increments (psi = 1, phi = -0.1 for other classes and for misses) instead of those derived
  /// from l, m and a. One hit then lowers P(occupied) when there are more than 19 classes of equal prior.
  bool use_paper_increments = false;

  /// How counts become beliefs:
  /// - "log_odds": multi-class log-odds, eq. 9-11 of the paper;
  /// - "dirichlet": counts are concentrations of a Dirichlet distribution over free space and the classes;
  /// - "bki": like "dirichlet", for votes that a kernel has smoothed (IntegrationConfig) [Gan et al. 2019].
  std::string fusion = "log_odds";
  /// s: weight of the Dirichlet prior [vote], which prior_occupied and the class priors divide among free space and the
  /// classes.
  double prior_votes = 2.0;

  double occupancy_limit = 9.21034;  ///< occupancy log-odds are read clamped to +-this; ln(0.9999 / 0.0001)
  double share_limit = 9.21034;      ///< a class's log share is read at most this far below the largest one

  bool operator==(const SensorModel&) const = default;
};

template <class Field>
void describe(Field& field, SensorModel& c) {
  field("hit_gain", c.hit_gain, config::in_range(0.01, 5.0),
        "increase of a voxel's log-odds of occupancy by a first hit");
  field("miss_gain", c.miss_gain, config::in_range(0.01, 5.0), "decrease of a voxel's log-odds of occupancy by a miss");
  field("label_accuracy", c.label_accuracy, config::in_range(0.05, 0.999),
        "probability that the label of a hit is right, for fusion log_odds; more than 1 / number of classes");
  field("fusion", c.fusion, config::one_of({"log_odds", "dirichlet", "bki"}),
        "rule by which the counts of a voxel become beliefs: multi-class log-odds, Dirichlet, or Dirichlet with "
        "a kernel (bki)");
  field("prior_votes", c.prior_votes, config::in_range(0.01, 1000.0),
        "number of votes that weigh as much as the prior, for fusion dirichlet and bki [votes]");
  field("paper_increments", c.use_paper_increments, config::anything(),
        "whether log-odds change as in the paper: +1 for the class of a hit, -0.1 for all other classes and for "
        "a miss");
  field("prior_occupied", c.prior_occupied, config::in_range(1e-4, 0.9999),
        "prior probability that a voxel is occupied, before it is observed");
}

/// The released system's parameters: psi = 1, phi = -0.1, P0 = 0.5, three named classes of prior share 0.1 and
/// "others" with the rest (reference values in tests).
SensorModel paper_sensor_model(std::vector<double> class_priors = {0.1, 0.1, 0.1, 0.7});

/// Multi-class belief of a voxel from its counts: eq. 9-11 of the paper with one prior everywhere and the three
/// increments psi_c = l + ln(a / pi_c) (hit, its class), phi_c = l + ln((1 - a) / (1 - pi_c)) (hit of c, other classes)
/// and -m (miss, all classes), so that a first hit multiplies the odds of "occupied" by exp(l) for any number of
/// classes. With h_c hits of class c, u unlabelled hits and n misses, and the free class as reference (y_0 = 0):
///   y_c = logit P0 + ln pi_c + u l - n m + sum_j h_j phi_j + h_c (psi_c - phi_c).
/// With the Dirichlet rules and a prior of s votes, the odds are those of the concentrations, where a miss counts m / l
/// votes:
///   y_c = ln (s P0 + u + sum_j h_j) - ln (s (1 - P0) + n m / l) + ln ((s P0 pi_c + h_c) / (s P0 + sum_j h_j)).
class BeliefReader {
 public:
  /// Throws std::runtime_error naming the parameter that is out of range.
  explicit BeliefReader(const SensorModel& model);

  const SensorModel& model() const { return model_; }

  /// ln sum_c exp y_c, clamped to +-occupancy_limit. Unknown voxels give the prior. O(classes hit).
  double occupancy_log_odds(const VoxelCounts& counts) const;
  double occupied_probability(const VoxelCounts& counts) const;
  /// True for observed voxels with P(occupied) > 0.5.
  bool is_occupied(const VoxelCounts& counts) const;
  /// Most probable class given occupied; ties go to the smaller id; 0 when no labelled hit distinguishes classes.
  std::uint16_t label(const VoxelCounts& counts) const;

  /// P(free), P(class 1), ..., P(class C): sums to 1. O(C).
  std::vector<double> class_probabilities(const VoxelCounts& counts) const;
  /// Shannon entropy of class_probabilities [nats]. O(C).
  double entropy(const VoxelCounts& counts) const;
  /// y_1 ... y_C before any clamp; index 0 is class 1. O(C).
  std::vector<double> class_log_odds(const VoxelCounts& counts) const;

 private:
  bool is_class(std::uint16_t label) const { return label >= 1 && label <= model_.class_count; }
  double prior(std::uint16_t label) const { return priors_[label - 1u]; }
  /// ln sum_c exp y_c, for every rule.
  double unclamped_log_odds(const VoxelCounts& counts) const;
  double log_odds_by_evidence(const VoxelCounts& counts) const;
  double log_odds_by_concentration(const VoxelCounts& counts) const;

  SensorModel model_;
  bool by_evidence_ = true;          ///< true: fusion is "log_odds"
  std::vector<double> priors_;       ///< pi_c, index c - 1
  std::vector<double> other_gain_;   ///< phi_c, index c - 1
  std::vector<double> own_surplus_;  ///< psi_c - phi_c, index c - 1
  double unlabelled_gain_ = 0.0;
  double miss_loss_ = 0.0;
  double prior_log_odds_ = 0.0;
};

}  // namespace lapis::mapping
