#pragma once

#include <Eigen/Core>

#include "planner/core/spectral/laplacian_factor.hpp"

namespace lapis::planner {

struct LanczosConfig {
  double tolerance = 1e-10;  ///< of the residual, relative to the eigenvalue, > 0
  int basis = 60;            ///< vectors kept, 2..n: memory of n * basis numbers
  int max_solves = 2000;     ///< solves with the factor, >= 1
};

/// Second smallest eigenvalue of the Laplacian and its eigenvector.
struct FiedlerPair {
  double value = 0.0;      ///< algebraic connectivity
  Eigen::VectorXd vector;  ///< one element per node, of sum 0 and norm 1; the sign means nothing
  double residual = 0.0;   ///< |L^+ v - v / value| * value, L^+ the pseudo-inverse of the Laplacian
  bool has_converged = false;
};

/// Lanczos' method (1950) on the pseudo-inverse, whose largest eigenvalue is 1/value, restarted from its best vector.
/// For graphs of two nodes or more. `start`: a vector near the result, or none.
FiedlerPair algebraic_connectivity(const LaplacianFactor& factor, const LanczosConfig& config = {},
                                   const Eigen::VectorXd& start = {});

}  // namespace lapis::planner
