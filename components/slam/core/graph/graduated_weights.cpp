#include "slam/core/graph/graduated_weights.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::slam {
namespace {

constexpr double kGrowth = 1.4;
// From here on the truncation is practically sharp.
constexpr double kLastMu = 1e3;

}  // namespace

double chi2_gate(int degrees_of_freedom) { return degrees_of_freedom == 3 ? 11.345 : 16.812; }

bool GraduatedWeights::update(const std::vector<double>& chi2, std::vector<double>& weights) {
  double worst = 0.0;
  for (const std::size_t i : edges_) worst = std::max(worst, chi2[i]);
  if (mu_ == 0.0) {
    if (worst <= gate_) return false;
    mu_ = gate_ / (2.0 * worst - gate_);
  } else {
    if (is_final_) return false;
    mu_ *= kGrowth;
  }
  is_final_ = true;
  for (const std::size_t i : edges_) {
    weights[i] = weight(chi2[i]);
    is_final_ = is_final_ && (weights[i] == 0.0 || weights[i] == 1.0);
  }
  return true;
}

// Equation 14 of the paper; from kLastMu on a step at the gate.
double GraduatedWeights::weight(double chi2) const {
  if (mu_ >= kLastMu) return chi2 <= gate_ ? 1.0 : 0.0;
  if (chi2 <= mu_ / (mu_ + 1.0) * gate_) return 1.0;
  if (chi2 >= (mu_ + 1.0) / mu_ * gate_) return 0.0;
  return std::clamp(std::sqrt(gate_ * mu_ * (mu_ + 1.0) / chi2) - mu_, 0.0, 1.0);
}

}  // namespace lapis::slam
