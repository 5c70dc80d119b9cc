#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lapis::planner {

/// What decides between paths. The first three are forms of the paper's utility.
enum class Method {
  kPaper,     ///< D (1 + MI / Cost), all loops in D [Zhang, Bong & Beltrame 2024, eq. 24-25]
  kFixedN,    ///< the same, D from the expected change of the log-determinant at equal number of nodes
  kJoint,     ///< (MI + beta d / 2 expected change of the log-determinant by loops) / Cost, all in nats
  kSsmi,      ///< MI of the goal's view alone, every ray for itself, whatever the path costs
  kTare,      ///< the first stop of the tour that TARE would drive (tare.hpp)
  kNearest,   ///< the nearest frontier
  kMiOnly,    ///< MI / Cost
  kDoptOnly,  ///< D
};

/// Names as in configuration: "paper", "fixed_n", "joint", "ssmi", "tare", "nearest", "mi_only", "dopt_only".
const std::vector<std::string>& method_names();
/// Nothing for another name.
std::optional<Method> method_of(const std::string& name);

/// True for methods that keep the goal that is being driven to until another one is clearly better; the paper has none.
bool has_hysteresis(Method method);
/// True for methods that loop closures are worth something to.
bool counts_loops(Method method);

struct UtilityConfig {
  double beta = 1.0;           ///< what a nat about the trajectory counts against one about the map, in [0, 100]
  double least_cost_m = 0.25;  ///< shorter paths count as this long, > 0
};

/// Degrees of freedom of a pose.
inline constexpr double kPoseDimensions = 6.0;

/// What is known about a path. All information in nats.
struct PathValue {
  double cost_m = 0.0;
  double path_information = 0.0;  ///< of its views, each cell once
  double goal_information = 0.0;  ///< of the last view, every ray for itself
  double loop_gain = 0.0;         ///< expected change of the log-determinant by loops, saturated
  double d_optimality = 0.0;      ///< of the graph with the path, by the method's form of it; 1: no graph to judge
  int tour_place = 0;             ///< of the goal in TARE's tour, from 1
};

/// Larger is better. Without information kPaper and kFixedN give D, their limit.
double utility(Method method, const PathValue& value, const UtilityConfig& config);

}  // namespace lapis::planner
