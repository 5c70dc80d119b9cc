#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace lapis::slam {

/// 99 % quantile of the chi2 of correct measurements with 6 (in space) or 3 (in the plane) degrees of freedom.
double chi2_gate(int degrees_of_freedom);

/// Weights of edges for truncated least squares by graduated non-convexity (Yang, Antonante, Tzoumas and Carlone, RA-L
/// 2020): at first all edges count; then, step by step, the cost flattens to a constant beyond the gate.
class GraduatedWeights {
 public:
  /// `edges`: indices of those that may be wrong. `gate`: chi2 at which the cost is truncated.
  GraduatedWeights(std::vector<std::size_t> edges, double gate) : edges_(std::move(edges)), gate_(gate) {}

  /// Computes the next weights from the chi2 of every edge after optimisation with the previous weights, which are all
  /// 1 before the first call. False when the previous ones are final: all edges fit, or each weight is 0 or 1.
  bool update(const std::vector<double>& chi2, std::vector<double>& weights);
  /// True when every weight is 0 or 1.
  bool is_final() const { return is_final_; }

 private:
  double weight(double chi2) const;

  std::vector<std::size_t> edges_;
  double gate_;
  double mu_ = 0.0;  // 0: not begun; small: nearly quadratic; large: truncated
  bool is_final_ = false;
};

}  // namespace lapis::slam
