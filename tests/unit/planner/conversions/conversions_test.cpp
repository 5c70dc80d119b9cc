#include "planner/conversions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using ::testing::HasSubstr;
namespace Edges = lapis_msgs::msg::PoseGraphEdge_Constants;
namespace Markers = visualization_msgs::msg::Marker_Constants;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

geometry_msgs::msg::Pose pose(double x, double y, double yaw_rad) {
  return messages::to_message(
      geometry::make_pose({x, y, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))));
}

nav_msgs::msg::OccupancyGrid grid() {
  nav_msgs::msg::OccupancyGrid message;
  message.info().resolution(0.25f);
  message.info().width(3);
  message.info().height(2);
  message.info().origin(pose(-1.0, 2.0, 0.0));
  message.data({-1, 0, 100, 0, 100, -1});
  return message;
}

// Two key-frames, the newer one first, and an edge with the upper triangle 1, 2, ... 21 by rows.
lapis_msgs::msg::PoseGraph graph() {
  lapis_msgs::msg::PoseGraph message;
  message.session(3);
  message.version(8);
  message.nodes().resize(2);
  message.nodes()[0].id(7);
  message.nodes()[0].pose(pose(1.0, 2.0, 0.5));
  message.nodes()[1].id(4);
  message.nodes()[1].pose(pose(0.0, 0.0, 0.0));
  lapis_msgs::msg::PoseGraphEdge edge;
  edge.from_id(4);
  edge.to_id(7);
  edge.type(Edges::TYPE_LOOP_CLOSURE);
  for (std::size_t i = 0; i < 21; ++i) edge.information()[i] = static_cast<double>(i + 1);
  message.edges().push_back(edge);
  return message;
}

lapis_msgs::msg::MapState map_state() {
  lapis_msgs::msg::MapState message;
  message.epoch(5);
  message.version(6);
  message.tiles(7);
  message.checksum(8);
  message.resolution_m(0.25);
  return message;
}

// A candidate that was chosen, one that was not, and one that was rejected.
Decision decision() {
  Decision decision;
  decision.candidates.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    Candidate& candidate = decision.candidates[i];
    const auto k = static_cast<double>(i);
    candidate.goal = {{k, -k}, 0.1 * k};
    candidate.target_map = {k + 0.5, 2.0};
    candidate.points = {{0.0, 0.0}, {k, -k}};
    candidate.value.cost_m = 1.0 + k;
    candidate.value.path_information = 10.0 + k;
    candidate.value.optimality = 20.0 + k;
    candidate.utility = 30.0 + k;
  }
  decision.candidates[2].rejection = Rejection::kUnreachable;
  decision.chosen = 1;
  return decision;
}

TEST(PlannerConversions, PoseIsSeenFromAbove) {
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()));
  const auto core = to_core(messages::to_message(geometry::make_pose({1.0, -2.0, 0.3}, tilted)));
  ASSERT_TRUE(core) << core.reason;
  EXPECT_EQ(core->p_map, Eigen::Vector2d(1.0, -2.0));
  EXPECT_NEAR(core->yaw_rad, 0.7, 1e-9);
}

TEST(PlannerConversions, PosesThatAreNoneAreRefused) {
  auto message = pose(0.0, 0.0, 0.0);
  message.position().x(kNaN);
  EXPECT_THAT(to_core(message).reason, HasSubstr("not finite"));
  message = pose(0.0, 0.0, 0.0);
  message.orientation().z(std::numeric_limits<double>::infinity());
  EXPECT_THAT(to_core(message).reason, HasSubstr("not finite"));
  EXPECT_THAT(to_core(geometry_msgs::msg::Pose()).reason, HasSubstr("quaternion")) << "all zero: unknown";
  for (const double far : {1.1e4, 1e300}) EXPECT_THAT(to_core(pose(0.0, far, 0.0)).reason, HasSubstr("10 km"));
}

TEST(PlannerConversions, PositionVarianceIsTheMeanOfTheAxesOrNotPublished) {
  std::array<double, 36> covariance{};
  EXPECT_EQ(position_variance_m2(covariance), 0.0);
  covariance[0] = 0.01;
  covariance[7] = 0.04;
  covariance[14] = 0.01;
  covariance[21] = 7.0;
  EXPECT_NEAR(position_variance_m2(covariance), 0.02, 1e-12);
  for (const double wrong : {-1.0, kNaN, std::numeric_limits<double>::infinity()}) {
    covariance[7] = wrong;
    EXPECT_EQ(position_variance_m2(covariance), 0.0) << wrong;
  }
}

TEST(PlannerConversions, PathComesBackAsItWas) {
  const std::vector<Pose2> path{{{0.0, 0.0}, 0.1}, {{1.0, 2.0}, -3.0}};
  const auto header = messages::header(time::Time{5'000'000'007}, "robot1/map");
  const auto message = to_message(path, header);
  EXPECT_EQ(message.header(), header);
  ASSERT_EQ(message.poses().size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(message.poses()[i].header(), header);
    const auto back = to_core(message.poses()[i].pose());
    ASSERT_TRUE(back) << back.reason;
    EXPECT_TRUE(back->p_map.isApprox(path[i].p_map, 1e-12));
    EXPECT_NEAR(back->yaw_rad, path[i].yaw_rad, 1e-12);
  }
}

TEST(PlannerConversions, GridKeepsItsCells) {
  const auto core = to_core(grid());
  ASSERT_TRUE(core) << core.reason;
  EXPECT_EQ(core->origin, Eigen::Vector2d(-1.0, 2.0));
  EXPECT_EQ(core->resolution_m, 0.25);
  EXPECT_EQ(core->width, 3);
  EXPECT_EQ(core->height, 2);
  EXPECT_EQ(core->at(2, 0), 100);
  EXPECT_EQ(core->at(0, 1), 0);
  EXPECT_EQ(core->at(2, 1), -1);
}

TEST(PlannerConversions, GridsThatDoNotFitOrAreTurnedAreRefused) {
  auto message = grid();
  message.info().width(4);
  EXPECT_THAT(to_core(message).reason, HasSubstr("width x height"));
  message = grid();
  message.info().height(0xffffffffU);
  message.info().width(0xffffffffU);
  EXPECT_THAT(to_core(message).reason, HasSubstr("width x height"));
  message = grid();
  message.info().origin().position().y(kNaN);
  EXPECT_THAT(to_core(message).reason, HasSubstr("origin of the grid"));
  message.info().origin(geometry_msgs::msg::Pose());
  EXPECT_THAT(to_core(message).reason, HasSubstr("origin of the grid"));
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d::UnitX().eval(), Eigen::Vector3d::UnitY().eval(), Eigen::Vector3d::UnitZ().eval()}) {
    for (const double angle : {0.01, std::numbers::pi}) {
      message.info().origin(messages::to_message(
          geometry::make_pose({0.0, 0.0, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)))));
      EXPECT_THAT(to_core(message).reason, HasSubstr("turned")) << axis.transpose() << " " << angle;
    }
  }
}

TEST(PlannerConversions, GraphIsInTheOrderOfIds) {
  const auto core = to_core(graph());
  ASSERT_TRUE(core) << core.reason;
  EXPECT_EQ(core->session, 3);
  EXPECT_EQ(core->version, 8U);
  ASSERT_EQ(core->keyframes.size(), 2U);
  EXPECT_EQ(core->keyframes[0].id, 4U);
  EXPECT_EQ(core->keyframes[1].id, 7U);
  EXPECT_TRUE(core->keyframes[1].T_map_camera.isApprox(*messages::from_message(pose(1.0, 2.0, 0.5))));
  ASSERT_EQ(core->edges.size(), 1U);
  EXPECT_EQ(core->edges[0].from, 4U);
  EXPECT_EQ(core->edges[0].to, 7U);
  EXPECT_TRUE(core->edges[0].is_loop_closure);
  const geometry::Matrix6d& information = core->edges[0].information;
  EXPECT_EQ(information, information.transpose());
  EXPECT_EQ(information(0, 5), 6.0);
  EXPECT_EQ(information(1, 1), 7.0);
  EXPECT_EQ(information(5, 5), 21.0);
}

TEST(PlannerConversions, OnlyLoopClosuresAreLoops) {
  for (const std::uint8_t type : {Edges::TYPE_ODOMETRY, Edges::TYPE_COVISIBILITY, Edges::TYPE_WHEEL_ODOMETRY}) {
    auto message = graph();
    message.edges()[0].type(type);
    EXPECT_FALSE(to_core(message)->edges[0].is_loop_closure) << static_cast<int>(type);
  }
}

TEST(PlannerConversions, GraphsWithNumbersThatAreNoneAreRefused) {
  auto message = graph();
  message.nodes()[0].pose().position().z(kNaN);
  EXPECT_THAT(to_core(message).reason, HasSubstr("a key-frame's pose has numbers that are not finite"));
  message.nodes()[0].pose(pose(1e300, 0.0, 0.0));
  EXPECT_THAT(to_core(message).reason, HasSubstr("10 km"));
  message.nodes()[0].pose(geometry_msgs::msg::Pose());
  EXPECT_THAT(to_core(message).reason, HasSubstr("a key-frame's quaternion"));
  message = graph();
  message.edges()[0].information()[20] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(to_core(message).reason, HasSubstr("information of an edge is not finite"));
}

TEST(PlannerConversions, MapStateIsThatOfTheMirrorOrRefused) {
  const auto core = to_core(map_state());
  ASSERT_TRUE(core) << core.reason;
  EXPECT_EQ(core->epoch, 5);
  EXPECT_EQ(core->version, 6U);
  EXPECT_EQ(core->tiles, 7U);
  EXPECT_EQ(core->checksum, 8U);
  EXPECT_EQ(core->resolution_m, 0.25);
  for (const double resolution_m : {0.0, -0.25, 0.6, kNaN, std::numeric_limits<double>::infinity()}) {
    auto message = map_state();
    message.resolution_m(resolution_m);
    EXPECT_THAT(to_core(message).reason, HasSubstr("voxels of that size")) << resolution_m;
  }
}

TEST(PlannerConversions, CandidatesSayWhatTheyAreWorthOrWhyNot) {
  const auto message = to_message(decision(), 12, "joint", {});
  EXPECT_EQ(message.decision_id(), 12U);
  EXPECT_EQ(message.method(), "joint");
  ASSERT_EQ(message.candidates().size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& candidate = message.candidates()[i];
    const auto k = static_cast<double>(i);
    EXPECT_EQ(candidate.id(), i);
    EXPECT_EQ(candidate.is_selected(), i == 1);
    EXPECT_EQ(candidate.is_rejected(), i == 2);
    EXPECT_EQ(candidate.reason(), i == 2 ? "cannot be reached" : "");
    EXPECT_EQ(candidate.cost_m(), 1.0 + k);
    EXPECT_EQ(candidate.mutual_information_nats(), 10.0 + k);
    EXPECT_EQ(candidate.d_optimality(), 20.0 + k);
    EXPECT_EQ(candidate.utility(), 30.0 + k);
    const auto goal = to_core(candidate.goal());
    ASSERT_TRUE(goal) << goal.reason;
    EXPECT_NEAR(goal->yaw_rad, 0.1 * k, 1e-12);
  }
}

TEST(PlannerConversions, EveryStateHasItsNumber) {
  using namespace lapis_msgs::msg::PlannerStatus_Constants;
  EXPECT_EQ(to_message(State::kIdle), STATE_IDLE);
  EXPECT_EQ(to_message(State::kExploring), STATE_EXPLORING);
  EXPECT_EQ(to_message(State::kPaused), STATE_PAUSED);
  EXPECT_EQ(to_message(State::kRecovering), STATE_RECOVERING);
  EXPECT_EQ(to_message(State::kReturning), STATE_RETURNING);
  EXPECT_EQ(to_message(State::kDone), STATE_DONE);
  EXPECT_EQ(to_message(State::kGaveUp), STATE_GAVE_UP);
  EXPECT_EQ(to_message(State::kConsolidating), STATE_CONSOLIDATING);
  EXPECT_EQ(to_message(State::kFailed), STATE_FAILED);
}

TEST(PlannerConversions, MarkersShowWhatThePoseGraphMayGain) {
  Decision made = decision();
  Candidate& chosen = made.candidates[*made.chosen];
  chosen.nodes_map = {{1.0, 2.0, 1.0}, {2.0, 2.0, 1.0}};
  chosen.loops = {{chosen.nodes_map[1], {5.0, 2.0, 1.0}, 0.25}};
  const test::World world;
  const auto message = to_markers(FrontierMap({}), world.grid, made, messages::header(time::Time{1}, "map"));
  const auto& nodes = message.markers().at(message.markers().size() - 2);
  EXPECT_EQ(nodes.type(), Markers::SPHERE_LIST);
  EXPECT_EQ(nodes.points().size(), 2U);
  const auto& loops = message.markers().back();
  EXPECT_EQ(loops.type(), Markers::LINE_LIST);
  ASSERT_EQ(loops.points().size(), 2U);
  EXPECT_EQ(loops.points()[0].x(), 2.0);
  EXPECT_EQ(loops.points()[1].x(), 5.0);
  ASSERT_EQ(loops.colors().size(), 2U);
  EXPECT_EQ(loops.colors()[0].a(), 0.25f);
}

TEST(PlannerConversions, MarkersReplaceTheOldOnesAndAreFinite) {
  test::World world;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) world.map.set({x, y}, mapping::kFree);
  }
  FrontierMap frontiers({});
  frontiers.update(world.grid, world.update());
  const auto message = to_markers(frontiers, world.grid, decision(), messages::header(time::Time{1}, "map"));
  ASSERT_EQ(message.markers().size(), 5U);
  EXPECT_EQ(message.markers()[0].action(), Markers::DELETEALL);
  EXPECT_EQ(message.markers()[1].type(), Markers::CUBE_LIST);
  EXPECT_EQ(message.markers()[1].points().size(), 28U) << "the rim of 8 x 8 cells";
  EXPECT_GT(message.markers()[3].color().g(), message.markers()[3].color().b()) << "the chosen one is green";
  EXPECT_GT(message.markers()[2].color().b(), message.markers()[2].color().g());
  EXPECT_EQ(message.markers()[4].type(), Markers::SPHERE) << "a rejected one has no path";
  EXPECT_EQ(message.markers()[4].pose().position().x(), 2.5) << "but a target";
  std::set<std::pair<std::string, std::int32_t>> names;
  for (const auto& marker : message.markers()) {
    EXPECT_EQ(marker.header().frame_id(), "map");
    EXPECT_TRUE(messages::from_message(marker.pose())) << marker.ns();
    EXPECT_TRUE(names.emplace(marker.ns(), marker.id()).second) << "two markers of one name are one";
    for (const auto& p : marker.points()) {
      EXPECT_TRUE(std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()));
    }
  }
}

}  // namespace
}  // namespace lapis::planner
