#include "tests/support/topic_probe.hpp"

#include <algorithm>

namespace lapis::test {
namespace {

using Clock = dds::Executor::Clock;

constexpr auto kLongestNap = std::chrono::milliseconds(10);  // matching wakes nobody, so conditions are asked again

}  // namespace

dds::ParticipantOptions participant_options(const std::string& name, const std::string& name_space) {
  dds::ParticipantOptions options;
  options.node_name = name;
  options.names.name_space = name_space;
  options.discovery = dds::discovery_from_environment();
  return options;
}

TopicProbe::TopicProbe(const std::string& name, const std::string& name_space)
    : participant_(participant_options(name, name_space)) {}

bool TopicProbe::wait_until(const std::function<bool()>& condition, Seconds deadline) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(deadline);
  while (!condition()) {
    const auto left = end - Clock::now();
    if (left <= Clock::duration::zero()) return false;
    executor_.spin_once(std::min<Clock::duration>(left, kLongestNap));
  }
  return true;
}

bool TopicProbe::wait_until_matched(std::size_t peers, Seconds deadline) {
  return wait_until(
      [&] {
        const auto is_matched = [&](const auto& endpoint) { return endpoint->matched() >= peers; };
        return std::all_of(writers_.begin(), writers_.end(), is_matched) &&
               std::all_of(sources_.begin(), sources_.end(), is_matched);
      },
      deadline);
}

// Discovery announces readers in the order of their creation, and reliably. So who sends to the newest knows all
// others.
bool TopicProbe::wait_until_known_by(const std::string& component, Seconds deadline) {
  using Graph = rmw_dds_common::msg::ParticipantEntitiesInfo;
  bool is_known = false;
  dds::Subscription<Graph> newest(participant_, kRosGraph, [&](const Graph& graph) {
    for (const auto& node : graph.node_entities_info_seq()) is_known |= node.node_name() == component;
  });
  return wait_until(
      [&] {
        newest.dispatch(dds::Executor::kMostPerTurn);
        return is_known;
      },
      deadline);
}

}  // namespace lapis::test
