// What every process offers as a node of ROS 2: parameters, /parameter_events, /rosout and descriptions of types.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

#include "common/topics/node.hpp"
#include "common/topics/services.hpp"
#include "idl/type_table.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/color_network.hpp"
#include "tests/support/endpoint_watcher.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/support/topic_probe.hpp"
#include "tests/unit/sensor_replay/synthetic_dataset.hpp"

namespace lapis::test {
namespace {

using rcl_interfaces::msg::Parameter;
using rcl_interfaces::msg::ParameterDescriptor;
using rcl_interfaces::msg::ParameterEvent;
using rcl_interfaces::msg::ParameterValue;
using rcl_interfaces::msg::SetParametersResult;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
namespace types = rcl_interfaces::msg::ParameterType_Constants;
using Words = std::vector<std::string>;

/// Calls the services of a node as `ros2 param` does.
class NodeClient {
 public:
  NodeClient(TopicProbe& probe, const ChildProcess& process, const std::string& node)
      : probe_(probe), process_(process), node_(node) {}

  /// Calls a service; a failure of the test when no reply comes.
  template <class Service>
  typename idl::ServiceSupport<Service>::Response call(const dds::ServiceTopic<Service>& service,
                                                       const typename idl::ServiceSupport<Service>::Request& request) {
    const std::string name = node_ + service.name;
    dds::ServiceTopic<Service> own = service;
    own.name = name.c_str();
    auto*& known = clients_[name];
    if (known == nullptr) known = &probe_.client(own);
    auto& client = static_cast<dds::ServiceClient<Service>&>(*known);
    EXPECT_TRUE(probe_.wait_until([&] { return client.is_ready(); })) << name << '\n' << process_.log();
    const auto number = client.call(request);
    std::optional<typename idl::ServiceSupport<Service>::Response> reply;
    EXPECT_TRUE(probe_.wait_until([&] { return (reply = client.take_reply(number.value_or(0))).has_value(); })) << name;
    return reply.value_or(typename idl::ServiceSupport<Service>::Response());
  }

  Words list(const Words& prefixes = {}, std::uint64_t depth = 0) {
    rcl_interfaces::srv::ListParameters_Request request;
    request.prefixes(prefixes);
    request.depth(depth);
    return call(topics::kListParameters, request).result().names();
  }
  std::vector<ParameterValue> values(const Words& names) {
    rcl_interfaces::srv::GetParameters_Request request;
    request.names(names);
    return call(topics::kGetParameters, request).values();
  }
  std::vector<ParameterDescriptor> descriptors(const Words& names) {
    rcl_interfaces::srv::DescribeParameters_Request request;
    request.names(names);
    return call(topics::kDescribeParameters, request).descriptors();
  }
  std::vector<std::uint8_t> types(const Words& names) {
    rcl_interfaces::srv::GetParameterTypes_Request request;
    request.names(names);
    return call(topics::kGetParameterTypes, request).types();
  }
  std::vector<SetParametersResult> set(const std::vector<Parameter>& parameters) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters(parameters);
    return call(topics::kSetParameters, request).results();
  }
  SetParametersResult set_atomically(const std::vector<Parameter>& parameters) {
    rcl_interfaces::srv::SetParametersAtomically_Request request;
    request.parameters(parameters);
    return call(topics::kSetParametersAtomically, request).result();
  }

 private:
  TopicProbe& probe_;
  const ChildProcess& process_;
  std::string node_;
  std::map<std::string, dds::Source*> clients_;
};

/// A parameter of the type that YAML text has, as `ros2 param set` reads it.
Parameter parameter(const std::string& name, const std::string& text) {
  Parameter result;
  result.name(name);
  const YAML::Node node = YAML::Load(text);
  ParameterValue& value = result.value();
  if (node.IsSequence()) {
    value.type(types::PARAMETER_STRING_ARRAY);
    value.string_array_value(node.as<Words>());
  } else if (text == "true" || text == "false") {
    value.type(types::PARAMETER_BOOL);
    value.bool_value(text == "true");
  } else if (text.find_first_not_of("-0123456789") == std::string::npos) {
    value.type(types::PARAMETER_INTEGER);
    value.integer_value(node.as<std::int64_t>());
  } else if (text.find_first_not_of("-.0123456789") == std::string::npos) {
    value.type(types::PARAMETER_DOUBLE);
    value.double_value(node.as<double>());
  } else {
    value.type(types::PARAMETER_STRING);
    value.string_value(text);
  }
  return result;
}

/// The leaves of a YAML file by their paths.
void collect_keys(const YAML::Node& node, const std::string& path, std::map<std::string, YAML::Node>& keys) {
  if (!node.IsMap()) {
    keys.emplace(path, node);
    return;
  }
  for (const auto& item : node) {
    collect_keys(item.second, (path.empty() ? "" : path + ".") + item.first.as<std::string>(), keys);
  }
}

std::map<std::string, YAML::Node> default_keys(const std::string& component) {
  std::map<std::string, YAML::Node> keys;
  const auto file = std::filesystem::path(LAPIS_SOURCE_DIR) / "config/default" / (component + ".yaml");
  collect_keys(YAML::LoadFile(file.string()), "", keys);
  return keys;
}

/// Whether a parameter has the value of a YAML node.
bool is_equal(const ParameterValue& value, const YAML::Node& node) {
  switch (value.type()) {
    case types::PARAMETER_BOOL: return value.bool_value() == node.as<bool>();
    case types::PARAMETER_INTEGER: return value.integer_value() == node.as<std::int64_t>();
    case types::PARAMETER_DOUBLE: return value.double_value() == node.as<double>();
    case types::PARAMETER_STRING: return value.string_value() == node.as<std::string>();
    case types::PARAMETER_STRING_ARRAY: return value.string_array_value() == node.as<Words>();
    case types::PARAMETER_DOUBLE_ARRAY: return value.double_array_value() == node.as<std::vector<double>>();
    default: return false;
  }
}

struct Attempt {
  std::string name;
  std::string value;
  std::string refusal;  ///< part of the reason; empty: it takes effect
};

/// A component, how it is started, and what is tried on it.
struct Component {
  std::string name;
  Words arguments;  ///< "DATASET" and "FOLDER" stand for a data set and a folder for results
  std::vector<Attempt> attempts;
  Words given = {};  ///< keys that the arguments set
};
void PrintTo(const Component& component, std::ostream* out) { *out << component.name; }

const std::string kAtStart = "is read at start: set it in the configuration and restart ";

const std::vector<Component> kComponents = {
    {"slam", {}, {{"slam.tracker.min_matches", "12", kAtStart + "slam"}, {"log.level", "warn", ""}}},
    {"segmenter", {"FOLDER/model.yaml"}, {{"dds.sensor_qos", "reliable", kAtStart + "segmenter"}}, {"segmenter.model"}},
    {"semantic_mapper",
     {},
     {{"semantic_mapper.tile_period_s", "1.5", ""},
      {"semantic_mapper.view_period_s", "3.0", ""},
      {"semantic_mapper.obstacle_period_s", "0.5", ""},
      {"semantic_mapper.obstacle_period_s", "61.0", "61 is out of range, allowed is 0 to 60"},
      {"semantic_mapper.resolution_m", "0.2", kAtStart + "semantic_mapper"},
      {"use_sim_time", "true", kAtStart + "semantic_mapper"}}},
    {"evaluator",
     {"--set", "evaluator.output_dir=FOLDER"},
     {{"evaluator.output_dir", "elsewhere", kAtStart + "evaluator"}, {"log.level", "error", ""}},
     {"evaluator.output_dir"}},
    {"planner",
     {},
     {{"planner.beta", "2.5", ""},
      {"planner.beta", "2", ""},
      {"planner.beta", "101.0", "planner.beta: 101 is out of range, allowed is 0 to 100"},
      {"planner.beta", "much", "planner.beta is a double, not a string"},
      {"planner.bta", "1.0", "there is no parameter 'planner.bta'"},
      {"planner.max_candidates", "20", ""},
      {"planner.max_candidates", "20.5", "planner.max_candidates is an integer, not a double"},
      {"planner.replan_period_s", "2.0", ""},
      {"planner.returns_home", "true", ""},
      {"planner.method", "nearest", kAtStart + "planner"}}},
    {"controller",
     {},
     {{"controller.speed_limit_m_s", "0.2", ""},
      {"controller.turn_limit_rad_s", "0.4", "controller.progress_timeout_s (6) has to be longer than half a turn"},
      {"controller.turn_limit_rad_s", "0.7", ""},
      {"controller.look_ahead_m", "0.8", ""},
      {"controller.speed_limit_m_s", "0.0", "allowed is 0.01 to 5"},
      {"robot.max_speed_m_s", "2.0", kAtStart + "controller"}}},
    {"sensor_replay",
     {"DATASET", "--rate", "1", "--set", "sensor_replay.wait_for_readers=1"},
     {{"sensor_replay.rate", "2.0", kAtStart + "sensor_replay"}},
     {"sensor_replay.dataset", "sensor_replay.rate", "sensor_replay.wait_for_readers"}},
    {"simulator",
     {"FOLDER/scene.yaml", "--mode", "freerun", "--set", "simulator.wait_for_readers=1"},
     {{"simulator.max_real_time_factor", "1.0", ""}, {"simulator.seed", "3", kAtStart + "simulator"}},
     {"simulator.scene", "simulator.mode", "simulator.wait_for_readers"}},
    {"recorder",
     {"FOLDER/bag"},
     {{"log.level", "loud", "is not one of debug | info | warn | error"}, {"log.level", "debug", ""}},
     {"recorder.output"}}};

class Node : public ::testing::TestWithParam<Component> {
 protected:
  Words arguments() const {
    Words words = GetParam().arguments;
    for (auto& word : words) {
      for (const std::string place : {"DATASET", "FOLDER"}) {
        const auto at = word.find(place);
        if (at != std::string::npos) word.replace(at, place.size(), folder_.path().string());
      }
    }
    return words;
  }
  void SetUp() override {
    sensor_replay::test::write_dataset(folder_.path(), 2);
    write_small_scene(folder_.path());
    write_color_model(folder_.path(), {.colors = {{200, 0, 0}, {0, 0, 200}}});
  }

  sensor_replay::test::TemporaryFolder folder_;
};

TEST_P(Node, ListsDescribesAndReadsEveryKeyOfItsConfiguration) {
  const auto keys = default_keys(GetParam().name);
  TopicProbe probe;
  ChildProcess process("lapis_" + GetParam().name, arguments());
  NodeClient client(probe, process, "/" + GetParam().name);
  const Words names = client.list();
  const auto values = client.values(names);
  const auto descriptors = client.descriptors(names);
  const auto type_ids = client.types(names);
  ASSERT_EQ(values.size(), names.size());
  ASSERT_EQ(descriptors.size(), names.size());
  ASSERT_EQ(type_ids.size(), names.size());
  Words expected = {"use_sim_time"};
  for (const auto& [key, value] : keys) expected.push_back(key);
  EXPECT_THAT(names, ::testing::UnorderedElementsAreArray(expected));
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(descriptors[i].name(), names[i]);
    EXPECT_FALSE(descriptors[i].description().empty()) << names[i];
    EXPECT_EQ(descriptors[i].type(), values[i].type()) << names[i];
    EXPECT_EQ(type_ids[i], values[i].type()) << names[i];
    const auto it = keys.find(names[i]);
    const bool is_given = std::ranges::find(GetParam().given, names[i]) != GetParam().given.end();
    if (it != keys.end() && !is_given) EXPECT_TRUE(is_equal(values[i], it->second)) << names[i];
  }
  EXPECT_THAT(client.list({"dds"}, 1), ElementsAre("dds.color_transport", "dds.depth_transport", "dds.remap",
                                                   "dds.sensor_qos", "dds.socket_buffer_bytes"));
  EXPECT_THAT(client.list({}, 1), ElementsAre("use_sim_time"));
}

TEST_P(Node, ChangesWhatMayChangeAndRefusesTheRestWithTheReason) {
  TopicProbe probe;
  std::vector<ParameterEvent> events;
  probe.listen<ParameterEvent>(topics::kParameterEvents, [&](ParameterEvent& event) { events.push_back(event); });
  ChildProcess process("lapis_" + GetParam().name, arguments());
  ASSERT_TRUE(probe.wait_until_known_by(GetParam().name)) << process.log();
  NodeClient client(probe, process, "/" + GetParam().name);
  std::size_t changes = 0;
  for (const Attempt& attempt : GetParam().attempts) {
    const auto before = client.values({attempt.name});
    const Parameter wanted = parameter(attempt.name, attempt.value);
    const auto results = client.set({wanted});
    ASSERT_EQ(results.size(), 1U);
    const auto after = client.values({attempt.name});
    EXPECT_EQ(results[0].successful(), attempt.refusal.empty()) << attempt.name << ": " << results[0].reason();
    EXPECT_THAT(results[0].reason(), HasSubstr(attempt.refusal));
    const auto described = client.descriptors({attempt.name});
    if (!attempt.refusal.empty()) {
      EXPECT_EQ(after, before) << attempt.name;
      EXPECT_EQ(described[0].read_only(), attempt.refusal.starts_with(kAtStart)) << attempt.name;
      continue;
    }
    EXPECT_FALSE(described[0].read_only()) << attempt.name;
    EXPECT_TRUE(is_equal(after[0], YAML::Load(attempt.value))) << attempt.name;
    ++changes;
    ASSERT_TRUE(probe.wait_until([&] { return events.size() == changes; })) << attempt.name << '\n' << process.log();
    EXPECT_EQ(events.back().node(), "/" + GetParam().name);
    EXPECT_TRUE(events.back().new_parameters().empty() && events.back().deleted_parameters().empty());
    ASSERT_EQ(events.back().changed_parameters().size(), 1U);
    EXPECT_EQ(events.back().changed_parameters()[0].name(), attempt.name);
    EXPECT_EQ(events.back().changed_parameters()[0].value(), after[0]);
  }
  EXPECT_EQ(events.size(), changes);
}

INSTANTIATE_TEST_SUITE_P(Components, Node, ::testing::ValuesIn(kComponents),
                         [](const auto& component) { return component.param.name; });

constexpr const char* kEcho = "lapis_test_echo";

TEST(NodeParameters, TakeEffectOnTheComponentAndAreSetAllOrNone) {
  TopicProbe probe("probe", "robot1");
  std::vector<ParameterEvent> events;
  probe.listen<ParameterEvent>(topics::kParameterEvents, [&](ParameterEvent& event) { events.push_back(event); });
  ChildProcess echo(kEcho, {"--namespace", "robot1"});
  ASSERT_TRUE(probe.wait_until_known_by("test_echo")) << echo.log();
  NodeClient client(probe, echo, "/test_echo");
  NodeClient services(probe, echo, "");
  EXPECT_EQ(services.call(topics::kSaveMap, {}).message(), "hello");
  EXPECT_TRUE(client.set({parameter("test_echo.greeting", "good day")})[0].successful());
  EXPECT_EQ(services.call(topics::kSaveMap, {}).message(), "good day");

  const auto refused =
      client.set_atomically({parameter("test_echo.greeting", "never"), parameter("test_echo.tiles", "3")});
  EXPECT_FALSE(refused.successful());
  EXPECT_THAT(refused.reason(), HasSubstr("test_echo.tiles " + kAtStart));
  EXPECT_EQ(services.call(topics::kSaveMap, {}).message(), "good day");

  EXPECT_TRUE(
      client.set_atomically({parameter("test_echo.greeting", "both"), parameter("log.level", "debug")}).successful());
  EXPECT_EQ(services.call(topics::kSaveMap, {}).message(), "both");
  ASSERT_TRUE(probe.wait_until([&] { return events.size() == 2; }));
  EXPECT_EQ(events.back().node(), "/robot1/test_echo");
  EXPECT_EQ(events.back().changed_parameters().size(), 2U);

  const auto mixed = client.set({parameter("test_echo.none", "3"), parameter("test_echo.greeting", "each")});
  ASSERT_EQ(mixed.size(), 2U);
  EXPECT_FALSE(mixed[0].successful());
  EXPECT_TRUE(mixed[1].successful());
  EXPECT_EQ(services.call(topics::kSaveMap, {}).message(), "each");
  EXPECT_EQ(client.values({"test_echo.none"})[0].type(), types::PARAMETER_NOT_SET);
  EXPECT_EQ(client.descriptors({"test_echo.none"})[0].type(), types::PARAMETER_NOT_SET);
}

/// "info  test_echo: ready" of a line on standard error, without its time of day.
Words lines_of(const std::string& log) {
  Words lines;
  std::istringstream in(log);
  for (std::string line; std::getline(in, line);) {
    if (line.find(" test_echo: ") != std::string::npos) lines.push_back(line.substr(line.find(' ') + 1));
  }
  return lines;
}

std::string line_of(const rcl_interfaces::msg::Log& log) {
  namespace levels = rcl_interfaces::msg::Log_Constants;
  const char* level = log.level() == levels::DEBUG  ? "debug"
                      : log.level() == levels::INFO ? "info "
                      : log.level() == levels::WARN ? "warn "
                                                    : "error";
  return std::string(level) + " test_echo: " + log.msg();
}

TEST(Rosout, HasEachLineOfTheLogOnce) {
  TopicProbe probe;
  const auto& logs = probe.collect(topics::kRosout);
  ChildProcess echo(kEcho, {"--namespace", "robot1", "--log-level", "debug", "--set", "test_echo.lines=300"});
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  ASSERT_TRUE(probe.wait_until([&] {
    return std::ranges::any_of(logs, [](const auto& log) { return log.msg() == "ready"; });
  })) << echo.log();
  echo.signal(SIGTERM);
  const auto has_stopped = [&] {
    return std::ranges::any_of(logs, [](const auto& log) { return log.msg() == "stopped"; });
  };
  EXPECT_TRUE(probe.wait_until(has_stopped)) << echo.log();
  EXPECT_EQ(echo.wait(), 0) << echo.log();
  Words seen;
  for (const auto& log : logs) {
    seen.push_back(line_of(log));
    EXPECT_EQ(log.name(), "robot1.test_echo");
    EXPECT_GT(log.stamp().sec(), 1'600'000'000);
  }
  EXPECT_EQ(seen, lines_of(echo.log()));
  EXPECT_GT(seen.size(), 300U);
}

TEST(Rosout, IsThereForALateJoinerAndFollowsTheLevel) {
  TopicProbe probe;
  ChildProcess echo(kEcho);
  ASSERT_TRUE(wait_until_ready(echo)) << echo.log();
  const auto& logs = probe.collect(topics::kRosout);
  const auto has = [&](const std::string& text) {
    return std::ranges::any_of(logs, [&](const auto& log) { return log.msg() == text; });
  };
  EXPECT_TRUE(probe.wait_until([&] { return has("ready"); })) << "a late joiner gets what is up to 10 s old";
  NodeClient client(probe, echo, "/test_echo");
  NodeClient services(probe, echo, "");
  services.call(topics::kSaveMap, {});
  EXPECT_TRUE(client.set({parameter("log.level", "debug")})[0].successful());
  services.call(topics::kSaveMap, {});
  EXPECT_TRUE(probe.wait_until([&] { return has("asked 2 times"); })) << echo.log();
  EXPECT_FALSE(has("asked 1 times"));
}

/// The hash of a type as rosidl makes it, from a description.
std::string hash_of(const type_description_interfaces::msg::TypeDescription& type) {
  const auto text_of = [](const auto& individual) {
    std::string text = "{\"type_name\": \"" + individual.type_name() + "\", \"fields\": [";
    for (const auto& field : individual.fields()) {
      text += text.back() == '[' ? "" : ", ";
      text += "{\"name\": \"" + field.name() + "\", \"type\": {\"type_id\": " + std::to_string(field.type().type_id()) +
              ", \"capacity\": " + std::to_string(field.type().capacity()) +
              ", \"string_capacity\": " + std::to_string(field.type().string_capacity()) +
              ", \"nested_type_name\": \"" + field.type().nested_type_name() + "\"}}";
    }
    return text + "]}";
  };
  std::string text =
      "{\"type_description\": " + text_of(type.type_description()) + ", \"referenced_type_descriptions\": [";
  for (const auto& used : type.referenced_type_descriptions()) text += (text.back() == '[' ? "" : ", ") + text_of(used);
  const auto file = std::filesystem::path(::testing::TempDir()) / "description.json";
  std::ofstream(file) << text << "]}";
  ChildProcess sum("/usr/bin/sha256sum", {file.string()});
  EXPECT_EQ(sum.wait(), 0) << sum.log();
  return "RIHS01_" + sum.output().substr(0, 64);
}

TEST(TypeDescriptions, OfAllTypesOfTheNodeMakeTheirHashes) {
  TopicProbe probe;
  const EndpointWatcher watcher(probe.participant());
  ChildProcess echo(kEcho);
  ASSERT_TRUE(probe.wait_until_known_by("test_echo")) << echo.log();
  NodeClient client(probe, echo, "/test_echo");
  std::map<std::string, std::string> hashes;  // by type
  for (const auto& endpoint : watcher.endpoints()) {
    const std::string name = dds::ros_type_name(endpoint.type);
    if (!name.empty()) hashes[name] = dds::type_hash_of(endpoint);
  }
  EXPECT_GT(hashes.size(), 10U);
  for (const auto& [name, hash] : hashes) {
    type_description_interfaces::srv::GetTypeDescription_Request request;
    request.type_name(name);
    request.type_hash(hash);
    request.include_type_sources(true);
    const auto response = client.call(topics::kGetTypeDescription, request);
    ASSERT_TRUE(response.successful()) << name << ": " << response.failure_reason();
    EXPECT_EQ(hash_of(response.type_description()), hash) << name;
    EXPECT_EQ(response.type_sources().size(), response.type_description().referenced_type_descriptions().size() + 1);
    request.type_hash("RIHS01_0");
    EXPECT_THAT(client.call(topics::kGetTypeDescription, request).failure_reason(), HasSubstr(hash));
  }
  type_description_interfaces::srv::GetTypeDescription_Request request;
  request.type_name("other_msgs/msg/Strange");
  EXPECT_FALSE(client.call(topics::kGetTypeDescription, request).successful());
}

}  // namespace
}  // namespace lapis::test
