#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/service_call.hpp"
#include "common/cdr/encode.hpp"
#include "common/cdr/text.hpp"
#include "common/dds/raw.hpp"
#include "common/topics/planner.hpp"

namespace lapis::command_line {
namespace {

constexpr double kDegree_rad = 0.017453292519943295;
constexpr const char* kNoNode = "a bare DDS program";
constexpr Seconds kNamesPatience{0.2};  // names come after the endpoints that have them

struct Goal {
  double x_m = 0.0, y_m = 0.0;
  std::optional<double> yaw_deg;
};

cdr::Value to_pose(const Goal& goal, const std::string& frame) {
  const double half_rad = 0.5 * kDegree_rad * goal.yaw_deg.value_or(0.0);
  return {{"header", {{"frame_id", frame}}},
          {"pose",
           {{"position", {{"x", goal.x_m}, {"y", goal.y_m}}},
            {"orientation", {{"z", std::sin(half_rad)}, {"w", goal.yaw_deg ? std::cos(half_rad) : 0.0}}}}}};
}

/// Not only the planner may read: a recorder does, too.
std::vector<std::string> nodes_that_read(const Domain& domain, const dds::Writer& publisher) {
  std::vector<std::string> nodes;
  for (const dds::Endpoint& endpoint : domain.endpoints()) {
    if (endpoint.is_writer || !publisher.is_matched(endpoint.gid)) continue;
    const std::string node = domain.node_of(endpoint.gid);
    nodes.push_back(node.empty() ? kNoNode : node);
  }
  return nodes;
}

Status send_goal(const Settings& settings, const Goal& goal) {
  Domain domain(settings);
  const std::string frame = dds::in_namespace(domain.names().full("map", true), settings.name_space);
  const cdr::Bytes pose = cdr::encode(known_layout("geometry_msgs/msg/PoseStamped"), to_pose(goal, frame));
  using Support = idl::TypeSupport<geometry_msgs::msg::PoseStamped>;
  const std::string topic = dds::dds_name(topics::kGoal, domain.names());
  dds::RawPublisher publisher(domain.participant(), topic, Support::kDdsName, Support::kHash, topics::kGoal.qos);
  domain.participant().announce_graph();
  if (!domain.wait_until([&] { return publisher.matched() > 0; }, domain.patience())) {
    throw Failure(kNotThere, "no planner reads " + dds::ros_topic_name(topic) + "; lapis topics lists what is there");
  }
  if (!publisher.publish(pose) || !publisher.wait_until_acknowledged(settings.wait_s)) {
    throw Failure(kTooLate, "the planner has not received the goal");
  }
  std::vector<std::string> readers;
  domain.wait_until(
      [&] {
        readers = nodes_that_read(domain, publisher);
        return std::ranges::find(readers, kNoNode) == readers.end();
      },
      kNamesPatience);
  if (settings.is_json) {
    std::cout << cdr::to_json({{"readers", readers}}) << '\n';
  } else {
    for (const std::string& node : readers) std::cout << node << " has the goal\n";
  }
  return kDone;
}

}  // namespace

void add_goal(CLI::App& app, const Settings& settings, Job& job) {
  auto goal = std::make_shared<Goal>();
  CLI::App* command = app.add_subcommand("goal", "drive to a place of the map instead of exploring");
  command->add_option("x", goal->x_m, "in the map frame [m]")->required();
  command->add_option("y", goal->y_m, "in the map frame [m]")->required();
  command->add_option("yaw", goal->yaw_deg, "heading at the goal; none: any [deg]");
  command->callback([&settings, &job, goal] { job = [&settings, goal] { return send_goal(settings, *goal); }; });
}

}  // namespace lapis::command_line
