#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/mapping/wire/map_mirror.hpp"
#include "common/messages/converted.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/visualization_msgs.hpp"
#include "planner/core/exploration/explorer.hpp"

namespace lapis::planner {

/// slam's pose graph as the planner reads it.
struct GraphMessage {
  std::int64_t session = 0;
  std::uint64_t version = 0;
  std::vector<Keyframe> keyframes;  ///< by id
  std::vector<KeyframeEdge> edges;
};

/// A pose seen from above; refused when it is not valid or more than 10 km from the origin.
messages::Converted<Pose2> to_core(const geometry_msgs::msg::Pose& message);
/// Mean variance of x, y and z [m^2] of a row-major covariance; 0 when it is not published, or is none.
double position_variance_m2(const std::array<double, 36>& covariance);
/// Refused when cells, size and resolution do not fit each other, or when the grid is turned.
messages::Converted<ObstacleGrid> to_core(const nav_msgs::msg::OccupancyGrid& message);
/// Refused when a pose is not valid or more than 10 km from the origin, or when an information matrix is not finite.
messages::Converted<GraphMessage> to_core(const lapis_msgs::msg::PoseGraph& message);
/// Refused when no map has voxels of that size.
messages::Converted<mapping::MapState> to_core(const lapis_msgs::msg::MapState& message);

nav_msgs::msg::Path to_message(const std::vector<Pose2>& path, const std_msgs::msg::Header& header);
lapis_msgs::msg::CandidateSet to_message(const Decision& decision, std::uint64_t id, const std::string& method,
                                         const std_msgs::msg::Header& header);
std::uint8_t to_message(State state);
/// Frontiers, and the paths of the candidates: the chosen one green, others blue, rejected ones red at their targets.
visualization_msgs::msg::MarkerArray to_markers(const FrontierMap& frontiers, const PlanningGrid& grid,
                                                const Decision& decision, const std_msgs::msg::Header& header);

}  // namespace lapis::planner
