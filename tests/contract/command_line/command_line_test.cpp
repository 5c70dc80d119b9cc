// lapis beside topics and services of the test, and beside a planner.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/bags/bag_reader.hpp"
#include "common/dds/raw.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "idl/type_description_interfaces.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr dds::ServiceTopic<std_srvs::srv::SetBool> kSwitch{"/tested/switch", "test", "succeeds with true"};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class Lapis : public ::testing::Test {
 protected:
  struct Answer {
    std::optional<int> status;
    std::string output, log;
  };

  /// Runs lapis while the probe handles what comes.
  Answer lapis(const std::vector<std::string>& arguments) {
    ChildProcess child("lapis", arguments);
    probe_.wait_until([&] { return !child.is_running(); }, Seconds(20));
    const auto status = child.wait();
    return {status, child.output(), child.log()};
  }
  void publish_often(const nav_msgs::msg::Odometry& message) {
    auto& odometry = probe_.advertise(topics::kWheelOdometry);
    probe_.participant().announce_graph();
    probe_.executor().every(std::chrono::milliseconds(20), [&odometry, message] { odometry.publish(message); });
  }

  TopicProbe probe_{"tested"};
};

nav_msgs::msg::Odometry odometry() {
  nav_msgs::msg::Odometry message;
  message.header().frame_id("odom");
  message.header().stamp().sec(7);
  message.pose().pose().position().x(1.25);
  return message;
}

TEST_F(Lapis, EchoesAMessage) {
  publish_often(odometry());
  const Answer text = lapis({"echo", "/odom", "--once"});
  EXPECT_EQ(text.status, 0) << text.log;
  EXPECT_THAT(text.output,
              StartsWith("header:\n  stamp:\n    sec: 7\n    nanosec: 0\n  frame_id: odom\nchild_frame_id: ''\n"));
  EXPECT_THAT(text.output, HasSubstr("      x: 1.25\n"));
  EXPECT_THAT(text.output, EndsWith("---\n"));
  const Answer value = lapis({"--json", "echo", "odom", "--once"});
  EXPECT_EQ(json::parse(value.output)["pose"]["pose"]["position"]["x"], 1.25) << value.log;
  const Answer field = lapis({"echo", "/odom", "--once", "--json", "--field", "header.stamp.sec"});
  EXPECT_EQ(field.output, "7\n") << field.log;
  const Answer unknown = lapis({"echo", "/odom", "--once", "--field", "nothing.x"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.log, HasSubstr("no field 'nothing' of 'nothing.x'; there is header, child_frame_id"));
}

TEST_F(Lapis, EchoesWhatIsLatchedAndWhatIsBestEffort) {
  probe_.advertise(topics::kKeyframePath).publish({});
  dds::Topic<sensor_msgs::msg::Imu> unreliable = topics::kImu;
  unreliable.qos.best_effort = true;
  auto& imu = probe_.advertise(unreliable);
  probe_.executor().every(std::chrono::milliseconds(20), [&] { imu.publish({}); });
  EXPECT_EQ(lapis({"echo", "/slam/path", "--once"}).status, 0);
  EXPECT_EQ(lapis({"echo", "/imu", "--once"}).status, 0);
}

TEST_F(Lapis, EchoesUntilItIsInterrupted) {
  publish_often(odometry());
  ChildProcess echo("lapis", {"echo", "/odom"});
  ASSERT_TRUE(probe_.wait_until([&] { return echo.output().size() > 2000; })) << echo.log();
  EXPECT_EQ(echo.stop(SIGINT), 0) << echo.log();
}

TEST_F(Lapis, NamesTheTopicsThatExistForOneThatDoesNot) {
  publish_often(odometry());
  const Answer unknown = lapis({"echo", "/odometry", "--wait", "1"});
  EXPECT_EQ(unknown.status, 3);
  EXPECT_THAT(unknown.log, HasSubstr("no topic /odometry; there are /odom"));
  probe_.listen<sensor_msgs::msg::Imu>(topics::kImu, [](auto&) {});
  const Answer read_only = lapis({"hz", "/imu", "--wait", "1"});
  EXPECT_EQ(read_only.status, 3);
  EXPECT_THAT(read_only.log, HasSubstr("nobody publishes /imu, which 1 read(s)"));
}

TEST_F(Lapis, SaysThatATopicIsSilent) {
  probe_.advertise(topics::kWheelOdometry);
  for (const auto& command : std::vector<std::vector<std::string>>{{"echo", "/odom", "--once", "--wait", "1"},
                                                                   {"hz", "/odom", "--seconds", "1"}}) {
    const Answer silent = lapis(command);
    EXPECT_EQ(silent.status, 4) << silent.log;
    EXPECT_THAT(silent.log, HasSubstr("/odom has a publisher, but no message came"));
  }
}

TEST_F(Lapis, DoesWithoutTheTypeWhereItCan) {
  dds::RawPublisher strange(probe_.participant(), "rt/strange", "other_msgs::msg::dds_::Strange_", "", {.depth = 10});
  const dds::RawType::Bytes bytes{0, 1, 0, 0, 7, 0, 0, 0};
  probe_.executor().every(std::chrono::milliseconds(20), [&] { strange.publish(bytes); });
  EXPECT_EQ(lapis({"hz", "/strange", "--seconds", "1"}).status, 0);
  const Answer echo = lapis({"echo", "/strange", "--wait", "1"});
  EXPECT_EQ(echo.status, 2);
  EXPECT_THAT(echo.log, HasSubstr("does not know the type other_msgs/msg/Strange"));
}

TEST_F(Lapis, AsksTheNodeForATypeThatItDoesNotKnow) {
  using Service = type_description_interfaces::srv::GetTypeDescription;
  constexpr dds::ServiceTopic<Service> kDescribe{"/tested/get_type_description", "test", "describes one type"};
  dds::ServiceServer<Service> server(probe_.participant(), kDescribe, [](const auto& request) {
    type_description_interfaces::srv::GetTypeDescription_Response response;
    response.successful(request.type_name() == "other_msgs/msg/Strange" && request.type_hash() == "RIHS01_77");
    response.type_description().type_description().type_name(request.type_name());
    type_description_interfaces::msg::Field field;
    field.name("numbers");
    field.type().type_id(3 + 144);  // uint8[]
    response.type_description().type_description().fields().push_back(field);
    return response;
  });
  probe_.executor().add(server);
  dds::RawPublisher strange(probe_.participant(), "rt/strange", "other_msgs::msg::dds_::Strange_", "RIHS01_77",
                            {.depth = 10});
  probe_.participant().announce_graph();
  const dds::RawType::Bytes bytes{0, 1, 0, 0, 2, 0, 0, 0, 7, 8};
  probe_.executor().every(std::chrono::milliseconds(20), [&] { strange.publish(bytes); });
  const Answer echo = lapis({"echo", "/strange", "--once"});
  EXPECT_EQ(echo.output, "numbers:\n- 7\n- 8\n---\n") << echo.log;
}

TEST_F(Lapis, MeasuresRateAndBandwidth) {
  publish_often(odometry());
  const Answer rate = lapis({"hz", "/odom", "--json", "--seconds", "1.2"});
  EXPECT_EQ(rate.status, 0) << rate.log;
  const json last = json::parse(lines_of(rate.output).back());
  EXPECT_NEAR(last["rate_hz"], 50.0, 15.0) << rate.log;
  EXPECT_EQ(last["lost"], 0);
  EXPECT_THAT(lapis({"hz", "/odom", "--seconds", "1"}).output, HasSubstr(" Hz, gaps "));
  const Answer bytes = lapis({"bw", "/odom", "--json", "--seconds", "1.2"});
  const json size = json::parse(lines_of(bytes.output).back());
  EXPECT_GT(size["mean_bytes"], 700.0) << bytes.log;
  EXPECT_NEAR(size["bytes_per_s"], 50.0 * size["mean_bytes"].get<double>(), 15.0 * size["mean_bytes"].get<double>());
}

TEST_F(Lapis, ListsTopicsAndServices) {
  publish_often(odometry());
  ChildProcess planner("lapis_planner");
  ASSERT_TRUE(wait_until_ready(planner)) << planner.log();
  const Answer names = lapis({"topics", "--names"});
  EXPECT_EQ(names.status, 0) << names.log;
  EXPECT_THAT(lines_of(names.output), ::testing::IsSupersetOf({"/odom", "/planner/path", "lapis/slam/landmarks"}));
  bool is_listed = false;
  for (const std::string& line : lines_of(lapis({"topics", "--json", "-v"}).output)) {
    const json topic = json::parse(line);
    if (topic["topic"] != "/odom") continue;
    is_listed = true;
    EXPECT_EQ(topic["types"], json::array({"nav_msgs/msg/Odometry"}));
    EXPECT_EQ(topic["writers"], 1);
    EXPECT_EQ(topic["publishers"][0]["node"], "/tested");
    EXPECT_EQ(topic["publishers"][0]["reliability"], "reliable");
    EXPECT_THAT(topic["publishers"][0]["type_hash"], StartsWith("RIHS01_"));
  }
  EXPECT_TRUE(is_listed);
  const Answer services = lapis({"topics", "--services"});
  EXPECT_THAT(services.output, HasSubstr("/planner/pause  std_srvs/srv/Trigger  /planner\n"));
}

TEST_F(Lapis, CallsServicesOfARunningPlannerWithinASecond) {
  ChildProcess planner("lapis_planner");
  ASSERT_TRUE(wait_until_ready(planner)) << planner.log();
  for (const auto& [arguments, answer] : std::vector<std::pair<std::vector<std::string>, json>>{
           {{"call", "/planner/pause"}, {{"success", true}, {"message", "paused"}}},
           {{"resume"}, {{"success", true}, {"message", "exploring"}}},
           {{"pause"}, {{"success", true}, {"message", "paused"}}},
           {{"home"}, {{"success", true}, {"message", "returning"}}}}) {
    std::vector<std::string> words = arguments;
    words.emplace_back("--json");
    const auto begin = std::chrono::steady_clock::now();
    const Answer called = lapis(words);
    EXPECT_LT(Seconds(std::chrono::steady_clock::now() - begin).count(), 1.0) << words[0];
    EXPECT_EQ(called.status, 0) << called.log;
    EXPECT_EQ(json::parse(called.output), answer);
  }
  EXPECT_EQ(lapis({"call", "planner/stop"}).output, "success: true\nmessage: stopped\n");
  const Answer refused = lapis({"pause"});
  EXPECT_EQ(refused.status, 1) << refused.log;
  EXPECT_THAT(refused.output, HasSubstr("success: false"));
}

TEST_F(Lapis, CallsAServiceWithARequest) {
  dds::ServiceServer<std_srvs::srv::SetBool> server(probe_.participant(), kSwitch, [](const auto& request) {
    std_srvs::srv::SetBool_Response response;
    response.success(request.data());
    response.message("it's done");
    return response;
  });
  probe_.executor().add(server);
  const Answer yes = lapis({"call", "/tested/switch", "{data: true}"});
  EXPECT_EQ(yes.output, "success: true\nmessage: \"it's done\"\n") << yes.log;
  EXPECT_EQ(yes.status, 0);
  EXPECT_EQ(lapis({"call", "/tested/switch", R"({"data": false})"}).status, 1);
  const Answer wrong = lapis({"call", "/tested/switch", "{date: true}"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.log, HasSubstr("has no field date; it has data"));
  const Answer unknown = lapis({"call", "/tested/witch", "--wait", "1"});
  EXPECT_EQ(unknown.status, 3);
  EXPECT_THAT(unknown.log, HasSubstr("no service /tested/witch; there are /tested/switch"));
}

TEST_F(Lapis, SaysThatAServiceDoesNotAnswer) {
  using Support = idl::TypeSupport<std_srvs::srv::Trigger_Request>;
  using Answered = idl::TypeSupport<std_srvs::srv::Trigger_Response>;
  dds::RawSubscription deaf(probe_.participant(), "rq/tested/deafRequest", Support::kDdsName, "", {},
                            [](auto&, auto&) {});
  const dds::RawPublisher mute(probe_.participant(), "rr/tested/deafReply", Answered::kDdsName, "", {});
  const Answer answer = lapis({"call", "/tested/deaf", "--wait", "1"});
  EXPECT_EQ(answer.status, 4) << answer.log;
  EXPECT_THAT(answer.log, HasSubstr("/tested/deaf has not answered"));
}

TEST_F(Lapis, ReadsAndChangesParameters) {
  ChildProcess planner("lapis_planner");
  ASSERT_TRUE(wait_until_ready(planner)) << planner.log();
  const std::string key = "planner.turn_cost_m_per_rad";
  EXPECT_THAT(lines_of(lapis({"params", "list", "/planner"}).output), ::testing::Contains(key));
  EXPECT_EQ(lapis({"params", "get", "planner", key}).output, "0.5\n");
  const Answer both = lapis({"params", "get", "/planner", key, "planner.method", "--json"});
  EXPECT_EQ(json::parse(both.output), (json{{key, 0.5}, {"planner.method", "lapis"}})) << both.log;
  const json descriptor = json::parse(lapis({"params", "describe", "/planner", key, "--json"}).output);
  EXPECT_EQ(descriptor["type"], "a number");
  EXPECT_EQ(descriptor["floating_point_range"][0]["to_value"], 10.0);
  const Answer changed = lapis({"params", "set", "/planner", key, "1"});
  EXPECT_EQ(changed.status, 0) << changed.log;
  EXPECT_EQ(changed.output, "successful: true\nreason: ''\n");
  EXPECT_EQ(lapis({"params", "get", "/planner", key}).output, "1.0\n");
  const json dump = json::parse(lapis({"params", "dump", "/planner", "--json"}).output);
  EXPECT_EQ(dump["/planner"]["ros__parameters"]["planner"]["turn_cost_m_per_rad"], 1.0);
  EXPECT_THAT(lapis({"params", "dump", "/planner"}).output, StartsWith("/planner:\n  ros__parameters:\n"));

  for (const auto& [name, value] : {std::pair<std::string, std::string>{key, "-1"}, {"planner.output_dir", "/tmp"}}) {
    const Answer refused = lapis({"params", "set", "/planner", name, value});
    EXPECT_EQ(refused.status, 1) << refused.log;
    EXPECT_THAT(refused.output, HasSubstr("successful: false"));
  }
  EXPECT_EQ(lapis({"params", "set", "/planner", key, "much"}).status, 2);
  const Answer unknown = lapis({"params", "get", "/planner", "planner.nothing"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.log, HasSubstr("/planner has no parameter planner.nothing"));
  const Answer nobody = lapis({"params", "list", "/slam", "--wait", "1"});
  EXPECT_EQ(nobody.status, 3);
  EXPECT_THAT(nobody.log, HasSubstr("no node with parameters /slam; there are /planner"));
}

TEST_F(Lapis, SendsAGoal) {
  const auto& goals = probe_.collect(topics::kGoal);
  probe_.participant().announce_graph();
  const Answer sent = lapis({"goal", "-1.5", "2", "90"});
  EXPECT_EQ(sent.status, 0) << sent.log;
  EXPECT_EQ(sent.output, "/tested has the goal\n");
  ASSERT_TRUE(probe_.wait_until([&] { return !goals.empty(); }));
  EXPECT_EQ(goals[0].header().frame_id(), "map");
  EXPECT_EQ(goals[0].pose().position().x(), -1.5);
  EXPECT_NEAR(goals[0].pose().orientation().z(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(goals[0].pose().orientation().w(), std::sqrt(0.5), 1e-12);
}

TEST_F(Lapis, KeepsToTheNamespaceOfARobot) {
  TopicProbe robot("robot", "robot1");
  const auto& goals = robot.collect(topics::kGoal);
  ChildProcess child("lapis", {"--namespace", "robot1", "goal", "1", "2"});
  robot.wait_until([&] { return !child.is_running(); });
  EXPECT_EQ(child.wait(), 0) << child.log();
  ASSERT_TRUE(robot.wait_until([&] { return !goals.empty(); }));
  EXPECT_EQ(goals[0].header().frame_id(), "robot1/map");
  EXPECT_EQ(goals[0].pose().orientation().w(), 0.0);
  const Answer other = lapis({"goal", "1", "2", "--wait", "0.5"});
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.log, HasSubstr("no planner reads /planner/goal"));
}

TEST_F(Lapis, Records) {
  publish_often(odometry());
  const TemporaryFolder folder;
  const auto bag = folder.path() / "bag";
  ChildProcess record("lapis", {"record", bag.string(), "--topic", "/odom"});
  bool has_begun = false;
  ASSERT_TRUE(probe_.wait_until([&] { return has_begun = record.log().find("records /odom") != std::string::npos; }));
  EXPECT_EQ(record.stop(SIGINT), 0) << record.log();
  EXPECT_EQ(bags::BagReader(bag).contents().channels.at(0).topic, "/odom");
  EXPECT_THAT(lapis({"record", "--help"}).output, HasSubstr("lapis_recorder"));
  EXPECT_EQ(lapis({"record"}).status, 2);
}

TEST_F(Lapis, RefusesWrongCalls) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"fly"},
                                             {"echo"},
                                             {"echo", "/odom", "--twice"},
                                             {"hz", "/odom", "--window", "1"},
                                             {"goal", "1"},
                                             {"goal", "here", "there"},
                                             {"params"},
                                             {"params", "set", "/slam", "name"},
                                             {"--domain", "-1", "topics"},
                                             {"--namespace", "1x", "topics"},
                                             {"--remap", "/nothing:=/x", "topics"},
                                             {"call", "/x", "{a: "}}) {
    const Answer answer = lapis(arguments);
    EXPECT_EQ(answer.status, 2) << ::testing::PrintToString(arguments) << answer.log;
    EXPECT_FALSE(answer.log.empty());
  }
  EXPECT_EQ(lapis({"--help"}).status, 0);
  EXPECT_THAT(lapis({"--version"}).output, StartsWith("lapis "));
}

/// As long as it lives, new participants look for others as told.
class InRange {
 public:
  explicit InRange(const char* range) { setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", range, 1); }
  ~InRange() { setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1); }
  InRange(const InRange&) = delete;
  InRange& operator=(const InRange&) = delete;
};

TEST(LapisOnSubnet, MeetsOthersByMulticast) {
  const InRange subnet("SUBNET");
  TopicProbe probe("tested");
  probe.advertise(topics::kKeyframePath).publish({});
  ChildProcess echo("lapis", {"echo", "/slam/path", "--once"});
  probe.wait_until([&] { return !echo.is_running(); });
  EXPECT_EQ(echo.wait(), 0) << echo.log();
}

TEST(LapisOff, SaysThatItMayNotLook) {
  const InRange off("OFF");
  ChildProcess doctor("lapis", {"doctor", "--wait", "0.5", "--seconds", "0.1"});
  EXPECT_EQ(doctor.wait(), 1) << doctor.log();
  EXPECT_THAT(doctor.output(), HasSubstr("ROS_AUTOMATIC_DISCOVERY_RANGE=OFF forbids to look"));
}

TEST(LapisAlone, SaysThatNobodyIsThere) {
  ChildProcess topics("lapis", {"topics", "--wait", "0.5"});
  EXPECT_EQ(topics.wait(), 3) << topics.log();
  EXPECT_THAT(topics.log(), HasSubstr("lapis doctor"));
  ChildProcess call("lapis", {"pause", "--wait", "0.5"});
  EXPECT_EQ(call.wait(), 3) << call.log();
}

}  // namespace
}  // namespace lapis::test
