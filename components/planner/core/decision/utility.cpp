#include "planner/core/decision/utility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapis::planner {

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"paper", "fixed_n", "joint",   "ssmi",
                                              "tare",  "nearest", "mi_only", "dopt_only"};  // in the order of Method
  return names;
}

std::optional<Method> method_of(const std::string& name) {
  const auto& names = method_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Method>(found - names.begin());
}

bool has_hysteresis(Method method) { return method != Method::kPaper; }

bool counts_loops(Method method) {
  return method == Method::kPaper || method == Method::kFixedN || method == Method::kJoint ||
         method == Method::kDoptOnly;
}

double utility(Method method, const PathValue& value, const UtilityConfig& config) {
  const double cost_m = std::max(value.cost_m, config.least_cost_m);
  switch (method) {
    case Method::kPaper:
    case Method::kFixedN: return value.d_optimality * (1.0 + value.path_information / cost_m);
    case Method::kJoint:
      return (value.path_information + config.beta * 0.5 * kPoseDimensions * value.loop_gain) / cost_m;
    case Method::kSsmi: return value.goal_information;
    case Method::kTare: return value.tour_place > 0 ? 1.0 / value.tour_place : 0.0;
    case Method::kNearest: return 1.0 / cost_m;
    case Method::kMiOnly: return value.path_information / cost_m;
    case Method::kDoptOnly: return value.d_optimality;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace lapis::planner
