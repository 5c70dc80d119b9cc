#include "common/mapping/model/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::mapping {
namespace {

double votes(std::uint32_t fixed_point) { return static_cast<double>(fixed_point) / kOneVote; }

void require(bool is_good, const std::string& what) {
  if (!is_good) throw std::runtime_error("sensor_model: " + what);
}

void validate(const SensorModel& m) {
  config::check("sensor_model", m);
  require(m.class_count >= 1 && m.class_count <= 65535, "class_count must be in [1, 65535]");
  require(m.occupancy_limit > 0.0 && m.share_limit > 0.0, "limits must be positive");
  if (m.class_priors.empty()) return;
  require(m.class_priors.size() == static_cast<std::size_t>(m.class_count),
          "class_priors must have class_count entries");
  for (const double p : m.class_priors) require(p > 0.0 && p <= 1.0, "class_priors must be in (0, 1]");
  const double sum = std::accumulate(m.class_priors.begin(), m.class_priors.end(), 0.0);
  require(std::abs(sum - 1.0) < 1e-6, "class_priors must sum to 1");
}

}  // namespace

SensorModel paper_sensor_model(std::vector<double> class_priors) {
  SensorModel model;
  model.use_paper_increments = true;
  model.prior_occupied = 0.5;
  model.class_count = static_cast<int>(class_priors.size());
  model.class_priors = std::move(class_priors);
  return model;
}

BeliefReader::BeliefReader(const SensorModel& model) : model_(model), by_evidence_(model.fusion == "log_odds") {
  validate(model_);
  const auto count = static_cast<std::size_t>(model_.class_count);
  priors_ = model_.class_priors.empty() ? std::vector<double>(count, 1.0 / model_.class_count) : model_.class_priors;
  constexpr double kPaperPsi = 1.0, kPaperPhi = -0.1;
  unlabelled_gain_ = model_.use_paper_increments ? kPaperPsi : model_.hit_gain;
  miss_loss_ = model_.use_paper_increments ? -kPaperPhi : model_.miss_gain;
  prior_log_odds_ = std::log(model_.prior_occupied / (1.0 - model_.prior_occupied));
  for (const double pi : priors_) {
    double psi = kPaperPsi, phi = kPaperPhi;
    if (!model_.use_paper_increments) {
      // With a single class, a label carries no information: both increments are those of an unlabelled hit.
      const bool is_informative = count > 1;
      psi = model_.hit_gain + (is_informative ? std::log(model_.label_accuracy / pi) : 0.0);
      phi = model_.hit_gain + (is_informative ? std::log((1.0 - model_.label_accuracy) / (1.0 - pi)) : 0.0);
      require(psi >= phi, "label_accuracy must exceed the prior share of every class (1 / class_count)");
    }
    other_gain_.push_back(phi);
    own_surplus_.push_back(psi - phi);
  }
}

double BeliefReader::log_odds_by_evidence(const VoxelCounts& counts) const {
  double common = prior_log_odds_ - miss_loss_ * votes(counts.misses);
  for (const ClassCount& hit : counts.hits)
    common += votes(hit.count) * (is_class(hit.label) ? other_gain_[hit.label - 1u] : unlabelled_gain_);
  // ln sum_c pi_c exp(h_c surplus_c): classes without hits contribute their prior share as it is.
  double largest = 0.0, unhit_share = 1.0;
  for (const ClassCount& hit : counts.hits) {
    if (!is_class(hit.label)) continue;
    largest = std::max(largest, votes(hit.count) * own_surplus_[hit.label - 1u]);
    unhit_share -= prior(hit.label);
  }
  double sum = std::max(unhit_share, 0.0) * std::exp(-largest);
  for (const ClassCount& hit : counts.hits)
    if (is_class(hit.label))
      sum += prior(hit.label) * std::exp(votes(hit.count) * own_surplus_[hit.label - 1u] - largest);
  return common + largest + std::log(sum);
}

double BeliefReader::log_odds_by_concentration(const VoxelCounts& counts) const {
  double occupied = model_.prior_votes * model_.prior_occupied;
  for (const ClassCount& hit : counts.hits) occupied += votes(hit.count);
  const double free =
      model_.prior_votes * (1.0 - model_.prior_occupied) + votes(counts.misses) * model_.miss_gain / model_.hit_gain;
  return std::log(occupied / free);
}

double BeliefReader::unclamped_log_odds(const VoxelCounts& counts) const {
  return by_evidence_ ? log_odds_by_evidence(counts) : log_odds_by_concentration(counts);
}

double BeliefReader::occupancy_log_odds(const VoxelCounts& counts) const {
  return std::clamp(unclamped_log_odds(counts), -model_.occupancy_limit, model_.occupancy_limit);
}

double BeliefReader::occupied_probability(const VoxelCounts& counts) const {
  return 1.0 / (1.0 + std::exp(-occupancy_log_odds(counts)));
}

bool BeliefReader::is_occupied(const VoxelCounts& counts) const {
  return counts.is_observed() && occupancy_log_odds(counts) > 0.0;
}

std::uint16_t BeliefReader::label(const VoxelCounts& counts) const {
  const bool has_label =
      std::any_of(counts.hits.begin(), counts.hits.end(), [this](const ClassCount& h) { return is_class(h.label); });
  if (!has_label) return 0;
  std::uint16_t best = 0;
  double best_score = 0.0;
  if (model_.class_priors.empty()) {  // uniform priors: a class with hits is more probable than any class without
    for (const ClassCount& hit : counts.hits) {
      if (!is_class(hit.label) || (best != 0 && votes(hit.count) <= best_score)) continue;
      best = hit.label;
      best_score = votes(hit.count);
    }
    return best;
  }
  const std::vector<double> y = class_log_odds(counts);
  return static_cast<std::uint16_t>(std::max_element(y.begin(), y.end()) - y.begin() + 1);
}

std::vector<double> BeliefReader::class_log_odds(const VoxelCounts& counts) const {
  // First, the log shares of the classes given occupied, up to a common term.
  const double prior_votes = model_.prior_votes * model_.prior_occupied;
  std::vector<double> y(priors_.size());
  for (std::size_t c = 0; c < y.size(); ++c) y[c] = std::log(priors_[c]);
  for (const ClassCount& hit : counts.hits) {
    if (!is_class(hit.label)) continue;
    double& share = y[hit.label - 1u];
    if (by_evidence_) {
      share += votes(hit.count) * own_surplus_[hit.label - 1u];
    } else {
      share = std::log(prior(hit.label) + votes(hit.count) / prior_votes);
    }
  }
  const double largest = *std::max_element(y.begin(), y.end());
  const double sum = std::accumulate(y.begin(), y.end(), 0.0,
                                     [largest](double total, double v) { return total + std::exp(v - largest); });
  const double shift = unclamped_log_odds(counts) - largest - std::log(sum);
  for (double& value : y) value += shift;
  return y;
}

std::vector<double> BeliefReader::class_probabilities(const VoxelCounts& counts) const {
  const std::vector<double> y = class_log_odds(counts);
  const double largest = *std::max_element(y.begin(), y.end());
  const double p_occupied = occupied_probability(counts);
  std::vector<double> p(y.size() + 1);
  p[0] = 1.0 - p_occupied;
  double sum = 0.0;
  for (std::size_t c = 0; c < y.size(); ++c) sum += p[c + 1] = std::exp(std::max(y[c] - largest, -model_.share_limit));
  for (std::size_t c = 1; c < p.size(); ++c) p[c] *= p_occupied / sum;
  return p;
}

double BeliefReader::entropy(const VoxelCounts& counts) const {
  double h = 0.0;
  for (const double p : class_probabilities(counts))
    if (p > 0.0) h -= p * std::log(p);
  return h;
}

}  // namespace lapis::mapping
