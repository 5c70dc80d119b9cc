#pragma once

#include <Eigen/Core>

#include "planner/core/spectral/laplacian_factor.hpp"

namespace lapis::planner {

struct LanczosConfig {
  double tolerance = 1e-10;  ///< of the residual, relative to the eigenvalue, > 0
  int basis = 60;            ///< number of vectors kept, 2..n: memory for n * basis numbers
  int max_solves = 2000;     ///< largest number of solves with the factor, >= 1
};

/// Second smallest eigenvalue of the Laplacian and its eigenvector.
struct FiedlerPair {
  double value = 0.0;      ///< algebraic connectivity
  Eigen::VectorXd vector;  ///< one element per node, with sum 0 and norm 1; the sign has no meaning
  double residual = 0.0;   ///< |L^+ v - v / value| * value, where L^+ is the pseudo-inverse of the Laplacian
  bool has_converged = false;
};

/// Lanczos' method (1950) on the pseudo-inverse, whose largest eigenvalue is 1/value, restarted from its best vector.
/// The graph has at least two nodes.
/// @param start a vector near the result; may be empty
FiedlerPair algebraic_connectivity(const LaplacianFactor& factor, const LanczosConfig& config = {},
                                   const Eigen::VectorXd& start = {});

}  // namespace lapis::planner
