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
  std::vector<Keyframe> keyframes;  ///< sorted by id
  std::vector<KeyframeEdge> edges;
};

/// The pose projected to the floor. Refused when it is not valid or more than 10 km from the origin.
messages::Converted<Pose2> to_core(const geometry_msgs::msg::Pose& message);
/// A place to drive to; an orientation of zeros stands for any heading, that of the straight way there.
messages::Converted<Destination> to_destination(geometry_msgs::msg::Pose message, const Pose2& robot);
/// Mean variance of x, y and z [m^2] from a row-major 6x6 covariance; 0 when it is not published or not valid.
double position_variance_m2(const std::array<double, 36>& covariance);
/// Refused when the number of cells is not width x height, when the origin of the grid is not valid or more than 10 km
/// from that of the map, or when the grid is rotated.
messages::Converted<ObstacleGrid> to_core(const nav_msgs::msg::OccupancyGrid& message);
/// Refused when a pose is not valid or more than 10 km from the origin, or when an information matrix is not finite.
messages::Converted<GraphMessage> to_core(const lapis_msgs::msg::PoseGraph& message);
/// Refused when the resolution is not possible for a map.
messages::Converted<mapping::MapState> to_core(const lapis_msgs::msg::MapState& message);

nav_msgs::msg::Path to_message(const std::vector<Pose2>& path, const std_msgs::msg::Header& header);
lapis_msgs::msg::CandidateSet to_message(const Decision& decision, std::uint64_t id, const std::string& method,
                                         const std_msgs::msg::Header& header);
std::uint8_t to_message(State state);
/// Frontiers, and the paths of the candidates: the chosen one green, others blue, and rejected ones as red spheres at
/// their targets.
visualization_msgs::msg::MarkerArray to_markers(const FrontierMap& frontiers, const PlanningGrid& grid,
                                                const Decision& decision, const std_msgs::msg::Header& header);

}  // namespace lapis::planner
