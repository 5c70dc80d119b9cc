#include "planner/core/information/cell_information.hpp"

#include <algorithm>
#include <cmath>
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

/// KL of "occupied or not" from one log-odds to another.
double occupancy_divergence(double after, double before) {
  return probability(after) * (after - before) - softplus(after) + softplus(before);
}

VoxelCounts with_hit(const VoxelCounts& counts, std::uint16_t label) {
  VoxelCounts after = counts;
  for (ClassCount& hit : after.hits) {
    if (hit.label != label) continue;
    hit.count += kOneVote;
    return after;
  }
  after.hits.push_back({label, kOneVote});
  return after;
}

VoxelCounts with_pass(const VoxelCounts& counts) { return {counts.passes + kOneVote, counts.hits}; }

double csqmi(double p_occupied) {
  const double o = p_occupied, e = 1.0 - p_occupied;
  return 3.0 * std::log(o * o + e * e) - 2.0 * std::log(o * o * o + e * e * e);
}

}  // namespace

CellMeasure::CellMeasure(const mapping::SensorModel& model, Measure measure) : reader_(model), measure_(measure) {
  group_priors();
  for (std::uint32_t votes = 0; votes < kVotesInTable; ++votes) by_passes_.push_back(compute({votes * kOneVote, {}}));
}

void CellMeasure::group_priors() {
  const auto& model = reader_.model();
  const auto count = static_cast<std::size_t>(model.class_count);
  std::map<double, std::size_t> group_of_prior;
  for (std::size_t c = 0; c < count; ++c) {
    const double prior = model.class_priors.empty() ? 1.0 / model.class_count : model.class_priors[c];
    const auto [it, is_new] = group_of_prior.emplace(prior, groups_.size());
    const auto label = static_cast<std::uint16_t>(c + 1);
    if (is_new) groups_.push_back({prior, 0.0, {}});
    groups_[it->second].labels.push_back(label);
    group_of_.push_back(it->second);
  }
  if (count == 1) return;  // a single class always has the whole share
  for (PriorGroup& group : groups_) {
    const std::size_t own = group.labels.front() - 1u, other = own == 0 ? 1 : 0;
    const std::vector<double> before = reader_.class_log_odds({});
    const std::vector<double> after = reader_.class_log_odds({0, {{group.labels.front(), kOneVote}}});
    group.surplus = (after[own] - after[other]) - (before[own] - before[other]);
  }
}

CellInformation CellMeasure::of(const VoxelCounts& counts) const {
  const bool is_in_table =
      counts.hits.empty() && counts.passes % kOneVote == 0 && counts.passes / kOneVote < kVotesInTable;
  return is_in_table ? by_passes_[counts.passes / kOneVote] : compute(counts);
}

CellInformation CellMeasure::compute(const VoxelCounts& counts) const {
  const double log_odds = reader_.occupancy_log_odds(counts);
  const double p_occupied = probability(log_odds);
  const double p_free = 1.0 - p_occupied;
  if (measure_ == Measure::kCsqmi) return {p_free, std::max(csqmi(p_occupied), 0.0)};
  const double pass = occupancy_divergence(reader_.occupancy_log_odds(with_pass(counts)), log_odds);
  const double hit = measure_ == Measure::kSemantic
                         ? semantic_gain(counts, log_odds)
                         : occupancy_divergence(reader_.occupancy_log_odds(with_hit(counts, 0)), log_odds);
  return {p_free, std::max(p_free * pass + p_occupied * hit, 0.0)};  // rounding may fall below 0
}

double CellMeasure::semantic_gain(const VoxelCounts& counts, double log_odds) const {
  const std::vector<Kind> kinds = kinds_of(counts);
  const auto largest =
      std::max_element(kinds.begin(), kinds.end(), [](auto& a, auto& b) { return a.log_share < b.log_share; });
  double sum = 0.0, shares = 0.0;
  for (const Kind& kind : kinds) {
    // Divergences chain: that of occupancy, and that of the classes given occupied.
    const double after = reader_.occupancy_log_odds(with_hit(counts, kind.label));
    const double divergence =
        occupancy_divergence(after, log_odds) + probability(after) * share_divergence(kinds, kind);
    const double share =
        kind.size * std::exp(std::max(kind.log_share - largest->log_share, -reader_.model().share_limit));
    sum += share * divergence;
    shares += share;
  }
  return sum / shares;
}

std::vector<CellMeasure::Kind> CellMeasure::kinds_of(const VoxelCounts& counts) const {
  std::vector<Kind> kinds;
  std::vector<std::size_t> hit_in_group(groups_.size());
  for (const ClassCount& hit : counts.hits) {
    if (hit.label < 1 || hit.label > group_of_.size()) continue;
    const std::size_t g = group_of_[hit.label - 1u];
    ++hit_in_group[g];
    kinds.push_back(kind_of(groups_[g], hit.label, 1.0, static_cast<double>(hit.count) / kOneVote));
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const auto& labels = groups_[g].labels;
    if (hit_in_group[g] == labels.size()) continue;
    const auto unhit = std::find_if(labels.begin(), labels.end(), [&](std::uint16_t label) {
      return std::none_of(counts.hits.begin(), counts.hits.end(), [&](auto& hit) { return hit.label == label; });
    });
    kinds.push_back(kind_of(groups_[g], *unhit, static_cast<double>(labels.size() - hit_in_group[g]), 0.0));
  }
  return kinds;
}

CellMeasure::Kind CellMeasure::kind_of(const PriorGroup& group, std::uint16_t label, double size, double votes) const {
  const auto& model = reader_.model();
  const auto log_share = [&](double n) {
    return model.fusion == "log_odds" ? std::log(group.prior) + n * group.surplus
                                      : std::log(group.prior + n / (model.prior_votes * model.prior_occupied));
  };
  return {label, size, log_share(votes), log_share(votes + 1.0)};
}

double CellMeasure::share_divergence(const std::vector<Kind>& kinds, const Kind& hit) const {
  const double limit = reader_.model().share_limit;
  double largest = hit.log_share;
  for (const Kind& kind : kinds) largest = std::max(largest, kind.log_share);
  const double largest_after = std::max(largest, hit.log_share_after);
  double sum_before = 0.0, sum_after = 0.0, change = 0.0;
  const auto add = [&](double count, double before, double after) {
    before = std::max(before - largest, -limit);
    after = std::max(after - largest_after, -limit);
    sum_before += count * std::exp(before);
    sum_after += count * std::exp(after);
    change += count * std::exp(after) * (after - before);
  };
  for (const Kind& kind : kinds)
    if (&kind != &hit) add(kind.size, kind.log_share, kind.log_share);
  add(hit.size - 1.0, hit.log_share, hit.log_share);
  add(1.0, hit.log_share, hit.log_share_after);
  return change / sum_after - std::log(sum_after / sum_before);
}

}  // namespace lapis::planner
