#include "planner/core/information/cell_information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace lapis::planner {
namespace {

using mapping::ClassCount;
using mapping::kOneVote;
using mapping::VoxelCounts;

constexpr std::uint32_t kVotesInTable = 256;

double probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

/// ln(1 + e^x)
double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

/// KL divergence KL(after || before) of occupancy, from log-odds.
double occupancy_divergence(double after, double before) {
  return probability(after) * (after - before) - softplus(after) + softplus(before);
}

double csqmi(double p_occupied) {
  const double o = p_occupied, e = 1.0 - p_occupied;
  return 3.0 * std::log(o * o + e * e) - 2.0 * std::log(o * o * o + e * e * e);
}

double votes(std::uint32_t fixed_point) { return static_cast<double>(fixed_point) / kOneVote; }

mapping::SensorModel without_occupancy_limit(mapping::SensorModel model) {
  model.occupancy_limit = std::numeric_limits<double>::infinity();
  return model;
}

/// KL divergence KL(after || before) of the shares of a voxel's classes by a hit; each share is read at most `limit`
/// below the largest one.
template <class Kind>
class ShareDivergence {
 public:
  ShareDivergence(const std::vector<Kind>& kinds, double limit) : kinds_(kinds), limit_(limit) {
    for (const Kind& kind : kinds) {
      sum_ += kind.size * std::exp(read(kind.log_share));
      lowest_ = std::min(lowest_, kind.log_share);
    }
  }

  double sum() const { return sum_; }
  double read(double log_share) const { return std::max(log_share, -limit_); }

  double operator()(const Kind& hit) const {
    const double log_share_after = hit.log_share + hit.own_surplus;
    const double rise = std::max(log_share_after, 0.0);  // rise of the largest share
    if (lowest_ < rise - limit_ && rise > 0.0) return with_new_floor(hit, rise);
    const double before = read(hit.log_share), after = rise > 0.0 ? log_share_after : read(log_share_after);
    const double sum_after = sum_ - std::exp(before) + std::exp(after);
    return std::exp(after) / sum_after * (after - before) - std::log(sum_after / sum_);
  }

 private:
  /// The case in which the hit class has the largest share afterwards and others fall so far below it that they are
  /// clamped.
  double with_new_floor(const Kind& hit, double rise) const {
    double sum_after = 1.0, change = -read(hit.log_share);
    for (const Kind& kind : kinds_) {
      const double size = kind.size - (&kind == &hit ? 1.0 : 0.0);
      const double after = read(kind.log_share - rise), share = size * std::exp(after);
      sum_after += share;
      change += share * (after - read(kind.log_share));
    }
    return change / sum_after - std::log(sum_after / sum_);
  }

  const std::vector<Kind>& kinds_;
  double limit_, sum_ = 0.0, lowest_ = 0.0;
};

}  // namespace

CellMeasure::CellMeasure(const mapping::SensorModel& model, const RayModel& ray)
    : reader_(model), unclamped_reader_(without_occupancy_limit(model)), ray_(ray) {
  group_priors();
  for (std::uint32_t n = 0; n < kVotesInTable; ++n) by_misses_.push_back(compute({n * kOneVote, {}}));
}

void CellMeasure::group_priors() {
  const auto& model = reader_.model();
  const std::vector<double> before = reader_.class_log_odds({});
  std::map<double, std::size_t> group_of_prior;
  for (std::size_t c = 0; c < before.size(); ++c) {
    const double prior = model.class_priors.empty() ? 1.0 / model.class_count : model.class_priors[c];
    const auto [it, is_new] = group_of_prior.emplace(prior, groups_.size());
    if (is_new) {
      const std::vector<double> after = reader_.class_log_odds({0, {{static_cast<std::uint16_t>(c + 1), kOneVote}}});
      const std::size_t other = before.size() == 1 ? c : (c + 1) % before.size();  // a single class has no surplus
      const double own_gain = after[c] - before[c], other_gain = after[other] - before[other];
      groups_.push_back({prior, other_gain, own_gain - other_gain});
    }
    ++groups_[it->second].size;
    group_of_.push_back(it->second);
  }
}

CellInformation CellMeasure::of(const VoxelCounts& counts) const {
  const bool is_in_table =
      counts.hits.empty() && counts.misses % kOneVote == 0 && counts.misses / kOneVote < kVotesInTable;
  CellInformation cell = is_in_table ? by_misses_[counts.misses / kOneVote] : compute(counts);
  if (ray_.unknown_occupied > 0.0 && !counts.is_observed()) cell.free = 1.0 - ray_.unknown_occupied;
  return cell;
}

CellInformation CellMeasure::compute(const VoxelCounts& counts) const {
  const double log_odds = reader_.occupancy_log_odds(counts);
  const double p_occupied = probability(log_odds), p_free = 1.0 - p_occupied;
  if (ray_.measure == Measure::kCsqmi) return {p_free, std::max(csqmi(p_occupied), 0.0)};
  VoxelCounts after = counts;
  const auto view = static_cast<std::uint32_t>(ray_.votes) * kOneVote;
  after.misses += view;
  const double miss = occupancy_divergence(reader_.occupancy_log_odds(after), log_odds);
  double hit = 0.0;
  if (ray_.measure == Measure::kSemantic) {
    hit = mean_hit_divergence(counts);
  } else {
    after = counts;
    after.hits.push_back({0, view});
    hit = occupancy_divergence(reader_.occupancy_log_odds(after), log_odds);
  }
  return {p_free, std::max(p_free * miss + p_occupied * hit, 0.0)};  // rounding may give values below 0
}

double CellMeasure::clamped(double log_odds) const {
  const double limit = reader_.model().occupancy_limit;
  return std::clamp(log_odds, -limit, limit);
}

double CellMeasure::mean_hit_divergence(const VoxelCounts& counts) const {
  const auto& model = reader_.model();
  const double log_odds = unclamped_reader_.occupancy_log_odds(counts);
  const std::vector<Kind> kinds = kinds_of(counts);
  const ShareDivergence<Kind> share_divergence(kinds, model.share_limit);
  double occupied_votes = model.prior_votes * model.prior_occupied, unclamped_shares = 0.0, mean = 0.0;
  for (const ClassCount& hit : counts.hits) occupied_votes += votes(hit.count);
  for (const Kind& kind : kinds) unclamped_shares += kind.size * std::exp(kind.log_share);
  for (const Kind& kind : kinds) {
    // A hit multiplies the odds of its own class by e^psi and those of the others by e^phi; by Dirichlet rules it adds
    // a vote.
    const double share = std::exp(kind.log_share) / unclamped_shares;
    const double gain = model.fusion == "log_odds" ? kind.other_gain + std::log1p(share * std::expm1(kind.own_surplus))
                                                   : std::log1p(ray_.votes / occupied_votes);
    // Chain rule: the divergence of occupancy plus P(occupied) times that of the classes given occupied.
    const double after = clamped(log_odds + gain);
    const double divergence =
        occupancy_divergence(after, clamped(log_odds)) + probability(after) * share_divergence(kind);
    mean += kind.size * std::exp(share_divergence.read(kind.log_share)) / share_divergence.sum() * divergence;
  }
  return mean;
}

std::vector<CellMeasure::Kind> CellMeasure::kinds_of(const VoxelCounts& counts) const {
  std::vector<Kind> kinds;
  std::vector<std::size_t> hit_in_group(groups_.size());
  for (const ClassCount& hit : counts.hits) {
    if (hit.label < 1 || hit.label > group_of_.size()) continue;
    const std::size_t g = group_of_[hit.label - 1u];
    ++hit_in_group[g];
    kinds.push_back(kind_of(groups_[g], 1.0, votes(hit.count)));
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::size_t not_hit = groups_[g].size - hit_in_group[g];
    if (not_hit > 0) kinds.push_back(kind_of(groups_[g], static_cast<double>(not_hit), 0.0));
  }
  double largest = kinds.front().log_share;
  for (const Kind& kind : kinds) largest = std::max(largest, kind.log_share);
  for (Kind& kind : kinds) kind.log_share -= largest;
  return kinds;
}

CellMeasure::Kind CellMeasure::kind_of(const PriorGroup& group, double size, double votes_of_class) const {
  const auto& model = reader_.model();
  if (model.fusion == "log_odds")
    return {size, std::log(group.prior) + votes_of_class * group.own_surplus, ray_.votes * group.own_surplus,
            ray_.votes * group.other_gain};
  const double concentration = group.prior * model.prior_votes * model.prior_occupied + votes_of_class;
  return {size, std::log(concentration), std::log1p(ray_.votes / concentration), 0.0};
}

}  // namespace lapis::planner
