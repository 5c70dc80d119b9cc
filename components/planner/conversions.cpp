#include "planner/conversions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/messages/geometry.hpp"

namespace lapis::planner {
namespace {

using visualization_msgs::msg::Marker;

constexpr double kFarthest_m = 1e4;
constexpr double kSameAngle_rad = 1e-6;
constexpr double kGroundOffset_m = 0.05;  // markers are just above the floor

geometry_msgs::msg::Pose to_message(const Pose2& pose) {
  return messages::to_message(
      geometry::make_pose({pose.p_map.x(), pose.p_map.y(), 0.0},
                          Eigen::Quaterniond(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()))));
}

geometry_msgs::msg::Point to_point(const Eigen::Vector2d& p_map) {
  geometry_msgs::msg::Point point;
  point.x(p_map.x());
  point.y(p_map.y());
  point.z(kGroundOffset_m);
  return point;
}

Marker marker(const std::string& name_space, std::int32_t type, std::int32_t id, const std_msgs::msg::Header& header) {
  Marker result;
  result.header(header);
  result.ns(name_space);
  result.id(id);
  result.type(type);
  result.pose().orientation().w(1.0);
  result.color().a(1.0f);
  return result;
}

Marker frontier_marker(const FrontierMap& frontiers, const PlanningGrid& grid, const std_msgs::msg::Header& header) {
  Marker cells = marker("frontiers", visualization_msgs::msg::Marker_Constants::CUBE_LIST, 0, header);
  cells.scale().x(grid.resolution_m());
  cells.scale().y(grid.resolution_m());
  cells.scale().z(kGroundOffset_m);
  cells.color().r(1.0f);
  cells.color().g(0.7f);
  for (const auto& entry : frontiers.frontiers())
    for (const Cell& c : entry.second.cells) cells.points().push_back(to_point(grid.center_of(c)));
  return cells;
}

Marker candidate_marker(const Candidate& candidate, bool is_chosen, std::int32_t id,
                        const std_msgs::msg::Header& header) {
  using namespace visualization_msgs::msg::Marker_Constants;
  const bool is_rejected = !candidate.is_open();
  Marker result = marker("candidates", is_rejected ? SPHERE : LINE_STRIP, id, header);
  result.scale().x(is_rejected ? 0.2 : (is_chosen ? 0.08 : 0.03));
  result.scale().y(0.2);
  result.scale().z(0.2);
  if (is_rejected) {
    result.pose().position(to_point(candidate.target_map));
    result.color().r(1.0f);
    return result;
  }
  (is_chosen ? result.color().g(1.0f) : result.color().b(1.0f));
  for (const auto& p : candidate.points) result.points().push_back(to_point(p));
  return result;
}

geometry::Matrix6d symmetric(const std::array<double, 21>& upper_triangle) {
  geometry::Matrix6d upper = geometry::Matrix6d::Zero();
  std::size_t at = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) upper(row, column) = upper_triangle[at++];
  }
  return upper.selfadjointView<Eigen::Upper>();
}

messages::Converted<geometry::Pose> near_pose(const geometry_msgs::msg::Pose& message) {
  auto T = messages::from_message(message);
  if (T && !(T->translation().norm() <= kFarthest_m))
    return messages::Converted<geometry::Pose>::refused("pose is more than 10 km from the map's origin");
  return T;
}

geometry_msgs::msg::Point to_point(const Eigen::Vector3d& p_map) {
  geometry_msgs::msg::Point point;
  point.x(p_map.x());
  point.y(p_map.y());
  point.z(p_map.z());
  return point;
}

/// The key-frames that the chosen path would add to the pose graph.
Marker keyframe_marker(const Candidate& chosen, const std_msgs::msg::Header& header) {
  Marker nodes = marker("hallucinated_keyframes", visualization_msgs::msg::Marker_Constants::SPHERE_LIST, 0, header);
  nodes.scale().x(0.12);
  nodes.scale().y(0.12);
  nodes.scale().z(0.12);
  nodes.color().g(1.0f);
  for (const auto& p : chosen.nodes_map) nodes.points().push_back(to_point(p));
  return nodes;
}

/// The loops that the chosen path may close; the less probable a loop, the more transparent it is.
Marker loop_marker(const Candidate& chosen, const std_msgs::msg::Header& header) {
  Marker loops = marker("hallucinated_loops", visualization_msgs::msg::Marker_Constants::LINE_LIST, 0, header);
  loops.scale().x(0.03);
  loops.color().r(1.0f);
  loops.color().b(1.0f);
  for (const ExpectedLoop& loop : chosen.loops) {
    auto color = loops.color();
    color.a(static_cast<float>(loop.probability));
    for (const auto& p : {loop.node_map, loop.keyframe_map}) {
      loops.points().push_back(to_point(p));
      loops.colors().push_back(color);
    }
  }
  return loops;
}

}  // namespace

messages::Converted<Pose2> to_core(const geometry_msgs::msg::Pose& message) {
  const auto T = near_pose(message);
  if (!T) return messages::Converted<Pose2>::refused(T.reason);
  const Eigen::Vector3d forward = T->linear().col(0);
  return Pose2{T->translation().head<2>(), std::atan2(forward.y(), forward.x())};
}

messages::Converted<Destination> to_destination(geometry_msgs::msg::Pose message, const Pose2& robot) {
  auto& q = message.orientation();
  const bool has_heading = q.x() != 0.0 || q.y() != 0.0 || q.z() != 0.0 || q.w() != 0.0;
  if (!has_heading) q.w(1.0);
  const auto pose = to_core(message);
  if (!pose) return messages::Converted<Destination>::refused(pose.reason);
  Destination place{*pose, has_heading};
  const Eigen::Vector2d way_map = pose->p_map - robot.p_map;
  if (!has_heading) place.pose.yaw_rad = std::atan2(way_map.y(), way_map.x());
  return place;
}

double position_variance_m2(const std::array<double, 36>& covariance) {
  const double mean = (covariance[0] + covariance[7] + covariance[14]) / 3.0;
  return std::isfinite(mean) ? std::max(mean, 0.0) : 0.0;
}

messages::Converted<ObstacleGrid> to_core(const nav_msgs::msg::OccupancyGrid& message) {
  using Result = messages::Converted<ObstacleGrid>;
  ObstacleGrid grid;
  grid.resolution_m = static_cast<double>(message.info().resolution());
  const std::size_t cells = static_cast<std::size_t>(message.info().width()) * message.info().height();
  if (message.data().size() != cells) return Result::refused("grid has not width x height cells");
  const auto origin = near_pose(message.info().origin());
  if (!origin) return Result::refused("origin of the grid: " + origin.reason);
  if (geometry::rotation_angle(origin->linear()) > kSameAngle_rad) return Result::refused("grid is turned");
  grid.origin = origin->translation().head<2>();
  grid.width = static_cast<int>(message.info().width());
  grid.height = static_cast<int>(message.info().height());
  grid.cells.assign(message.data().begin(), message.data().end());
  return grid;
}

messages::Converted<GraphMessage> to_core(const lapis_msgs::msg::PoseGraph& message) {
  using Result = messages::Converted<GraphMessage>;
  GraphMessage graph;
  graph.session = message.session();
  graph.version = message.version();
  for (const auto& node : message.nodes()) {
    const auto T = near_pose(node.pose());
    if (!T) return Result::refused("a key-frame's " + T.reason);
    graph.keyframes.push_back({node.id(), *T});
  }
  std::sort(graph.keyframes.begin(), graph.keyframes.end(),
            [](const Keyframe& a, const Keyframe& b) { return a.id < b.id; });
  for (const auto& edge : message.edges()) {
    const geometry::Matrix6d information = symmetric(edge.information());
    if (!information.allFinite()) return Result::refused("the information of an edge is not finite");
    graph.edges.push_back({edge.from_id(), edge.to_id(), information,
                           edge.type() == lapis_msgs::msg::PoseGraphEdge_Constants::TYPE_LOOP_CLOSURE});
  }
  return graph;
}

messages::Converted<mapping::MapState> to_core(const lapis_msgs::msg::MapState& message) {
  mapping::MapState state;
  state.epoch = message.epoch();
  state.version = message.version();
  state.tiles = message.tiles();
  state.checksum = message.checksum();
  state.resolution_m = message.resolution_m();
  state.session = message.session();
  state.frames_off = message.frames_off();
  if (!(state.resolution_m >= mapping::kMinResolution_m && state.resolution_m <= mapping::kMaxResolution_m))
    return messages::Converted<mapping::MapState>::refused("no map has voxels of that size");
  return state;
}

nav_msgs::msg::Path to_message(const std::vector<Pose2>& path, const std_msgs::msg::Header& header) {
  nav_msgs::msg::Path message;
  message.header(header);
  for (const Pose2& pose : path) {
    geometry_msgs::msg::PoseStamped stamped;
    stamped.header(header);
    stamped.pose(to_message(pose));
    message.poses().push_back(stamped);
  }
  return message;
}

lapis_msgs::msg::CandidateSet to_message(const Decision& decision, std::uint64_t id, const std::string& method,
                                         const std_msgs::msg::Header& header) {
  lapis_msgs::msg::CandidateSet message;
  message.header(header);
  message.decision_id(id);
  message.method(method);
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    const Candidate& candidate = decision.candidates[i];
    lapis_msgs::msg::Candidate item;
    item.id(static_cast<std::uint32_t>(i));
    item.goal(to_message(candidate.goal));
    item.is_selected(decision.chosen == i);
    item.is_rejected(!candidate.is_open());
    item.reason(text_of(candidate.rejection));
    item.cost_m(candidate.value.cost_m);
    item.mutual_information_nats(candidate.value.path_information);
    item.d_optimality(candidate.value.optimality);
    item.utility(candidate.utility);
    message.candidates().push_back(item);
  }
  return message;
}

std::uint8_t to_message(State state) {
  using namespace lapis_msgs::msg::PlannerStatus_Constants;
  switch (state) {
    case State::kIdle: return STATE_IDLE;
    case State::kExploring: return STATE_EXPLORING;
    case State::kPaused: return STATE_PAUSED;
    case State::kRecovering: return STATE_RECOVERING;
    case State::kReturning: return STATE_RETURNING;
    case State::kDone: return STATE_DONE;
    case State::kGaveUp: return STATE_GAVE_UP;
    case State::kFailed: return STATE_FAILED;
    case State::kConsolidating: return STATE_CONSOLIDATING;
  }
  return STATE_FAILED;
}

visualization_msgs::msg::MarkerArray to_markers(const FrontierMap& frontiers, const PlanningGrid& grid,
                                                const Decision& decision, const std_msgs::msg::Header& header) {
  visualization_msgs::msg::MarkerArray message;
  Marker clear = marker("", 0, 0, header);
  clear.action(visualization_msgs::msg::Marker_Constants::DELETEALL);
  message.markers().push_back(clear);
  message.markers().push_back(frontier_marker(frontiers, grid, header));
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    const auto id = static_cast<std::int32_t>(i);
    message.markers().push_back(candidate_marker(decision.candidates[i], decision.chosen == i, id, header));
  }
  if (!decision.chosen) return message;
  const Candidate& chosen = decision.candidates[*decision.chosen];
  if (!chosen.nodes_map.empty()) message.markers().push_back(keyframe_marker(chosen, header));
  if (!chosen.loops.empty()) message.markers().push_back(loop_marker(chosen, header));
  return message;
}

}  // namespace lapis::planner
