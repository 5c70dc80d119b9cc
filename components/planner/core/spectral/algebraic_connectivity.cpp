#include "planner/core/spectral/algebraic_connectivity.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

namespace lapis::planner {
namespace {

// A pseudo-random vector: it has no symmetry, so it has a component along every eigenvector.
Eigen::VectorXd scattered_vector(int size) {
  std::mt19937 random(1);
  Eigen::VectorXd vector(size);
  for (double& element : vector) element = static_cast<double>(random()) / 4294967296.0 - 0.5;
  return vector;
}

Eigen::VectorXd without_mean(const Eigen::VectorXd& vector) { return vector.array() - vector.mean(); }

struct LargestRitz {
  double value = 0.0;
  Eigen::VectorXd coordinates;
};

LargestRitz largest_ritz(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off_diagonal) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off_diagonal);
  return {solver.eigenvalues().tail<1>()[0], solver.eigenvectors().rightCols<1>()};
}

// One run of at most `steps` steps from a unit vector with sum 0; adds its solves to `solves`.
FiedlerPair lanczos(const LaplacianFactor& factor, const Eigen::VectorXd& start, int steps, double tolerance,
                    int& solves) {
  Eigen::MatrixXd basis(factor.node_count(), steps);
  Eigen::VectorXd diagonal(steps), off_diagonal(steps);
  basis.col(0) = start;
  for (int j = 0;; ++j) {
    Eigen::VectorXd next = without_mean(factor.solve(basis.col(j)));
    ++solves;
    diagonal[j] = basis.col(j).dot(next);
    const auto known = basis.leftCols(j + 1);
    for (int pass = 0; pass < 2; ++pass) next -= known * (known.transpose() * next);
    off_diagonal[j] = next.norm();
    const LargestRitz ritz = largest_ritz(diagonal.head(j + 1), off_diagonal.head(j));
    const double residual = off_diagonal[j] * std::abs(ritz.coordinates[j]) / ritz.value;
    if (residual <= tolerance || j + 1 == steps) {
      const Eigen::VectorXd vector = without_mean(known * ritz.coordinates).normalized();
      return {1.0 / ritz.value, vector, residual, residual <= tolerance};
    }
    basis.col(j + 1) = next / off_diagonal[j];
  }
}

}  // namespace

FiedlerPair algebraic_connectivity(const LaplacianFactor& factor, const LanczosConfig& config,
                                   const Eigen::VectorXd& start) {
  const int n = factor.node_count();
  FiedlerPair pair;
  pair.vector = without_mean(start.size() == n ? start : scattered_vector(n)).normalized();
  for (int solves = 0; !pair.has_converged && solves < config.max_solves;) {
    const int steps = std::min({config.basis, n - 1, config.max_solves - solves});
    pair = lanczos(factor, pair.vector, steps, config.tolerance, solves);
  }
  return pair;
}

}  // namespace lapis::planner
