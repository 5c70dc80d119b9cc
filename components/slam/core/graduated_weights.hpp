#pragma once

#include <cstddef>
#include <vector>

#include "slam/core/pose_graph.hpp"

namespace lapis::slam {

/// Weights of loop closures for truncated least squares by graduated non-convexity (Yang, Antonante, Tzoumas and
/// Carlone, RA-L 2020): first all count, then the cost bends towards a constant beyond the 99 % quantile of chi2.
class GraduatedWeights {
 public:
  /// `degrees_of_freedom`: 6 in space, 3 in the plane.
  GraduatedWeights(const std::vector<PoseGraphEdge>& edges, int degrees_of_freedom);

  /// Next weights from the chi2 of each edge after optimisation with the last ones. False when these were the last:
  /// all loop closures fit, or each is in or out and was so before.
  bool update(const std::vector<double>& edge_chi2, std::vector<double>& weights);
  /// True when every weight is 0 or 1.
  bool is_final() const { return is_final_; }

 private:
  double weight(double chi2) const;

  std::vector<std::size_t> loops_;
  double gate_;
  double mu_ = 0.0;  // 0: not begun; small: nearly quadratic; large: truncated
  bool is_final_ = false;
};

}  // namespace lapis::slam
