#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace lapis::slam {

/// chi2 that 99 % of right measurements stay below; of 6 (in space) or 3 (in the plane) degrees of freedom.
double chi2_gate(int degrees_of_freedom);

/// Weights of edges for truncated least squares by graduated non-convexity (Yang, Antonante, Tzoumas and Carlone,
/// RA-L 2020): first all count, then the cost bends towards a constant beyond the gate.
class GraduatedWeights {
 public:
  /// `edges`: those that may be wrong.
  GraduatedWeights(std::vector<std::size_t> edges, double gate) : edges_(std::move(edges)), gate_(gate) {}

  /// Next weights from the chi2 of every edge after optimisation with the last ones, all 1 before the first call. False
  /// when the last ones are final: all fit, or each is in or out.
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
