#include "planner/core/uncertainty/surviving_share.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapis::planner {

double surviving_share(double sigma_m, double edge_m) {
  if (sigma_m == 0.0) return 1.0;
  const double edges = edge_m / sigma_m;
  if (edges == 0.0) return 0.0;
  const double share = std::erf(edges / std::numbers::sqrt2) +
                       std::sqrt(2.0 / std::numbers::pi) / edges * std::expm1(-0.5 * edges * edges);
  return std::clamp(share, 0.0, 1.0);
}

double surface_sigma_m(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& forward, double range_m) {
  const Eigen::Vector2d ahead = forward.head<2>().normalized();
  Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Identity();
  J.col(2) = range_m * Eigen::Vector2d(-ahead.y(), ahead.x());
  return std::sqrt(std::max(0.5 * (J * covariance * J.transpose()).trace(), 0.0));
}

/// With q = |d| / h, the mean of max(0, 1 - q |cos phi|) over a quarter turn; it is zero for phi below acos(1 / q).
double surviving_share_of(const Eigen::Vector2d& displacement_m, double edge_m) {
  const double edges = displacement_m.norm() / edge_m;
  const double first = edges > 1.0 ? std::acos(1.0 / edges) : 0.0;
  return std::clamp((std::numbers::pi / 2.0 - first - edges * (1.0 - std::sin(first))) * 2.0 / std::numbers::pi, 0.0,
                    1.0);
}

}  // namespace lapis::planner
