#include "command_line/domain.hpp"

#include <algorithm>
#include <set>

#include "common/dds/discovery.hpp"
#include "common/dds/subscription.hpp"
#include "common/runtime/known_names.hpp"

namespace lapis::command_line {
namespace {

using Clock = dds::Executor::Clock;

constexpr Seconds kQuiet{0.5};  // discovery answers an announcement within a heartbeat period of 0.1 s
constexpr std::string_view kRequestPrefix = "rq/", kReplyPrefix = "rr/", kRequestSuffix = "Request";
constexpr const char* kGraphName = "ros_discovery_info";
constexpr dds::Topic<rmw_dds_common::msg::ParticipantEntitiesInfo> kGraph{
    kGraphName, {.depth = 1000, .latched = true}, "all", "on change", "ROS 2 graph", true, true};

dds::ParticipantOptions options_of(const Settings& settings) {
  dds::check_namespace(settings.name_space);
  dds::ParticipantOptions options;
  options.node_name = "lapis_command_line";
  options.names = {settings.name_space, dds::parse_remaps(settings.remaps, runtime::known_names())};
  options.discovery = dds::discovery_from_environment();
  if (settings.domain) options.discovery.domain = *settings.domain;
  options.socket_buffer_bytes = settings.socket_buffer_bytes;
  options.watches_endpoints = true;
  return options;
}

dds::Gid participant_of(dds::Gid gid) {
  std::fill(gid.begin() + dds::kGidPrefixBytes, gid.end(), std::uint8_t{0});
  return gid;
}

/// A name of ROS 2 where it is one, else the name of DDS.
std::string shown(const std::string& ros_name, const std::string& dds_name) {
  return ros_name.empty() ? dds_name : ros_name;
}

}  // namespace

Domain::Domain(const Settings& settings) : settings_(settings), participant_(options_of(settings)) {
  participant_.changes().on_ring([this] { executor_.wake(); });
  interruption_.watch([this] { executor_.wake(); });
  add<dds::Subscription<Graph>>(kGraph, [this](const Graph& graph) { note_nodes(graph); });
  participant_.announce_graph();
}

Domain::~Domain() { participant_.changes().on_ring({}); }

bool Domain::wait_until(const std::function<bool()>& condition, Seconds longest) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(longest);
  while (!condition()) {
    const auto left = end - Clock::now();
    if (left <= Clock::duration::zero() || is_interrupted()) return false;
    executor_.spin_once(left);
  }
  return true;
}

void Domain::settle() {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(patience());
  for (bool is_over = false; !is_over && !is_interrupted();) {
    const std::uint64_t version = participant_.endpoints().version();
    const Seconds left = end - Clock::now();
    const bool is_empty = participants() == 0;
    const bool has_changed = wait_until([&] { return participant_.endpoints().version() != version; },
                                        is_empty ? left : std::min(left, kQuiet));
    is_over = !has_changed || left <= Seconds::zero();
  }
}

bool Domain::is_own(const dds::Gid& gid) const { return participant_of(gid) == participant_of(participant_.gid()); }

std::vector<dds::Endpoint> Domain::endpoints() const {
  std::vector<dds::Endpoint> others = participant_.endpoints().all();
  std::erase_if(others, [this](const dds::Endpoint& endpoint) { return is_own(endpoint.gid); });
  return others;
}

std::vector<SeenEndpoint> Domain::seen() const {
  std::vector<SeenEndpoint> found;
  for (const dds::Endpoint& endpoint : endpoints()) {
    const std::string& name = endpoint.topic;
    if (name.starts_with(kRequestPrefix) || name.starts_with(kReplyPrefix) || name == kGraphName) continue;
    found.push_back({.is_writer = endpoint.is_writer,
                     .topic = shown(dds::ros_topic_name(name), name),
                     .type = shown(dds::ros_type_name(endpoint.type), endpoint.type),
                     .is_reliable = endpoint.is_reliable,
                     .is_latched = endpoint.is_latched,
                     .is_keyed = endpoint.is_keyed,
                     .type_hash = dds::type_hash_of(endpoint),
                     .node = node_of(endpoint.gid),
                     .run = participant_.peers().run_of(endpoint.gid)});
  }
  return found;
}

std::vector<SeenService> Domain::services() const {
  std::vector<SeenService> found;
  for (const dds::Endpoint& endpoint : endpoints()) {
    const std::string& name = endpoint.topic;
    if (endpoint.is_writer || !name.starts_with(kRequestPrefix) || !name.ends_with(kRequestSuffix)) continue;
    found.push_back({name.substr(2, name.size() - 2 - kRequestSuffix.size()), dds::ros_type_name(endpoint.type),
                     node_of(endpoint.gid)});
  }
  std::ranges::sort(found, {}, &SeenService::name);
  return found;
}

std::string Domain::node_of(const dds::Gid& endpoint) const {
  const auto participant = nodes_.find(participant_of(endpoint));
  if (participant == nodes_.end()) return "";
  const auto node = participant->second.find(endpoint);
  return node == participant->second.end() ? "" : node->second;
}

std::size_t Domain::participants() const {
  std::set<dds::Gid> found;
  for (const dds::Endpoint& endpoint : endpoints()) found.insert(participant_of(endpoint.gid));
  return found.size();
}

std::vector<std::string> Domain::nodes() const {
  std::set<std::string> found;
  const auto own = participant_of(participant_.gid());
  for (const auto& [participant, endpoints] : nodes_) {
    if (participant == own) continue;
    for (const auto& [gid, node] : endpoints) found.insert(node);
  }
  return {found.begin(), found.end()};
}

std::string Domain::full_name(const std::string& name) const {
  return name.starts_with('/') ? name : dds::in_namespace("/" + name, names().name_space);
}

/// A participant's newest word replaces those before.
void Domain::note_nodes(const Graph& graph) {
  auto& endpoints = nodes_[participant_of(graph.gid().data())];
  endpoints.clear();
  for (const auto& node : graph.node_entities_info_seq()) {
    const std::string name_space = node.node_namespace().c_str();
    const std::string name = (name_space == "/" ? "" : name_space) + "/" + node.node_name().c_str();
    for (const auto& gid : node.reader_gid_seq()) endpoints[gid.data()] = name;
    for (const auto& gid : node.writer_gid_seq()) endpoints[gid.data()] = name;
  }
}

}  // namespace lapis::command_line
