#include "command_line/topic_reader.hpp"

#include <algorithm>

#include "command_line/service_call.hpp"
#include "common/cdr/described_type.hpp"
#include "idl/type_table.hpp"

namespace lapis::command_line {
namespace {

constexpr int kDepth = 1000;  // bursts wait here while the terminal is slow

[[noreturn]] void fail_without(const Domain& domain, const std::string& name) {
  std::vector<std::string> published;
  std::size_t readers = 0;
  for (const SeenTopic& topic : topics_of(domain.seen())) {
    if (topic.name == name) readers = topic.readers.size();
    if (!topic.writers.empty()) published.push_back(topic.name);
  }
  if (readers > 0) {
    throw Failure(kNotThere, "nobody publishes " + name + ", which " + std::to_string(readers) + " read(s)");
  }
  throw Failure(kNotThere, not_among("topic", name, published));
}

/// What the node of a writer says of its type (~/get_type_description).
std::optional<cdr::Layout> layout_by_node(Domain& domain, const FoundTopic& topic) {
  constexpr const char* kService = "/get_type_description";
  std::string service;
  const auto has_service = [&] {
    service = domain.node_of(topic.writer) + kService;
    const auto services = domain.services();
    return std::ranges::find(services, service, &SeenService::name) != services.end();
  };
  if (!domain.wait_until(has_service, domain.patience())) return std::nullopt;
  const cdr::Value answer = call(domain, service, {{"type_name", topic.type}, {"type_hash", topic.type_hash}});
  if (!is_success(answer)) return std::nullopt;
  return cdr::layout_of_description(answer["type_description"]);
}

}  // namespace

FoundTopic find_topic(Domain& domain, const std::string& wanted) {
  const std::string name = wanted.starts_with("lapis/") ? wanted : domain.full_name(wanted);
  std::vector<dds::Endpoint> writers;
  const bool is_found = domain.wait_until(
      [&] {
        writers = domain.endpoints();
        std::erase_if(writers, [&](const dds::Endpoint& endpoint) {
          return !endpoint.is_writer || endpoint.topic != dds::topic_dds_name(name);
        });
        return !writers.empty();
      },
      domain.patience());
  if (!is_found) fail_without(domain, name);
  const dds::Endpoint& first = writers.front();
  if (first.is_keyed) throw Failure(kWrongCall, name + " has keys, which neither ROS 2 nor this program reads");
  FoundTopic topic{name,      first.topic, first.type, dds::ros_type_name(first.type), dds::type_hash_of(first),
                   first.gid, {}};
  topic.qos.best_effort = !std::ranges::all_of(writers, &dds::Endpoint::is_reliable);
  topic.qos.latched = std::ranges::all_of(writers, &dds::Endpoint::is_latched);
  topic.qos.depth = topic.qos.reader_depth = kDepth;
  return topic;
}

dds::RawSubscription& read(Domain& domain, const FoundTopic& topic, dds::RawSubscription::Handler handler) {
  auto& reader =
      domain.add<dds::RawSubscription>(topic.dds_name, topic.dds_type, topic.type_hash, topic.qos, std::move(handler));
  domain.participant().announce_graph();
  return reader;
}

cdr::Layout layout_of(Domain& domain, const FoundTopic& topic) {
  const idl::TypeEntry* entry = idl::find(topic.type);
  const bool is_ours = entry != nullptr && (topic.type_hash.empty() || topic.type_hash == entry->hash);
  if (is_ours) return cdr::parse_ros2msg(entry->ros_name, entry->ros2msg_text);
  if (const auto layout = layout_by_node(domain, topic)) return *layout;
  throw Failure(kWrongCall, "this build does not know the type " + topic.type +
                                (entry == nullptr ? "" : " as declared there") +
                                ", and no node describes it; lapis hz and lapis record do without");
}

}  // namespace lapis::command_line
