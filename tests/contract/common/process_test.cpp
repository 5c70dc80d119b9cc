// What every process promises on its command line: readiness, exit status, configuration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/support/child_process.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kEchoProgram = "lapis_test_echo";

std::filesystem::path temporary_file(const std::string& name, const std::string& text) {
  auto path = std::filesystem::path(::testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path;
}

struct Outcome {
  std::optional<int> status;
  std::string output;
  std::string log;
};

Outcome run(const std::vector<std::string>& arguments) {
  ChildProcess process(kEchoProgram, arguments);
  const auto status = process.wait();
  return {status, process.output(), process.log()};
}

TEST(Process, BecomesReadyAndEndsWithStatus0WhenAsked) {
  for (const int signal : {SIGTERM, SIGINT}) {
    ChildProcess process(kEchoProgram);
    ASSERT_TRUE(wait_until_ready(process, Seconds(5))) << process.log();
    EXPECT_EQ(process.stop(signal, Seconds(3)), 0) << process.log();
    EXPECT_THAT(process.log(), HasSubstr("stopped"));
  }
}

TEST(Process, EndsEvenWhenAskedBeforeItIsReady) {
  ChildProcess process(kEchoProgram);
  ASSERT_TRUE(process.wait_for_line("domain")) << process.log();
  EXPECT_EQ(process.stop(SIGTERM, Seconds(5)), 0) << process.log();
}

TEST(Process, EndsWhenAskedThoughALibraryHasThreadsOfItsOwn) {
  for (const int signal : {SIGTERM, SIGINT}) {
    ChildProcess process("lapis_test_early_thread");
    ASSERT_TRUE(process.wait_for_line("ready")) << process.log();
    EXPECT_EQ(process.stop(signal), 0) << process.log();
  }
}

TEST(Process, WrongSetUpIsStatus2AndNamesTheCause) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--set", "test_echo.tyles=3"}, "test_echo.tyles"},
      {{"--set", "test_echo.tiles=-1"}, "0 to 10000"},
      {{"--set", "test_echo.tiles=many"}, "test_echo.tiles"},
      {{"--set", "test_echo.tiles"}, "test_echo.tiles"},
      {{"--domain", "232"}, "231"},
      {{"--domain", "x"}, "x"},
      {{"--namespace", "robot 1"}, "robot 1"},
      {{"--transport", "pigeon"}, "pigeon"},
      {{"--log-level", "loud"}, "loud"},
      {{"--config", "/no/such/file.yaml"}, "/no/such/file.yaml"},
      {{"--no-such-option"}, "no-such-option"}};
  for (const auto& [arguments, cause] : cases) {
    const auto outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.log;
    EXPECT_THAT(outcome.log, HasSubstr(cause));
    EXPECT_EQ(outcome.output, "") << "errors belong on standard error";
  }
}

TEST(Process, RunsInTheLastDomain) {
  for (const char* range : {"LOCALHOST", "SUBNET", "OFF"}) {
    ChildProcess process("/usr/bin/env", {std::string("ROS_AUTOMATIC_DISCOVERY_RANGE=") + range,
                                          (bin_dir() / kEchoProgram).string(), "--domain", "231"});
    ASSERT_TRUE(wait_until_ready(process)) << process.log();
    EXPECT_EQ(process.stop(SIGTERM), 0) << process.log();
  }
}

TEST(Process, CheckConfigRefusesWhatTheStartRefuses) {
  struct Case {
    std::string name;
    std::vector<std::string> arguments;
    std::string reason;
  };
  const std::vector<Case> cases = {
      {"planner",
       {"--set", "planner.path.comfort_m=0.1"},
       "planner.path.comfort_m (0.1) has to be more than robot.radius_m (0.2) and planner.grid.margin_m ("},
      {"planner",
       {"--set", "robot.obstacle_min_height_m=2"},
       "robot.obstacle_min_height_m (2) has to be less than robot.obstacle_max_height_m (1.2)"},
      {"planner",
       {"--set", "planner.then=nearest", "--set", "planner.returns_home=true"},
       "planner.then (\"nearest\") and planner.returns_home (true) exclude each other"},
      {"controller",
       {"--set", "controller.local_map.min_height_m=5"},
       "controller.local_map.min_height_m (5) has to be less than robot.obstacle_max_height_m (1.2)"},
      {"controller", {"--set", "controller.fan.groups=4"}, "controller.fan.groups (4) has to be odd"},
      {"semantic_mapper",
       {"--set", "semantic_mapper.integration.min_range_m=1", "--set", "robot.sensing_range_m=1"},
       "semantic_mapper.integration.min_range_m (1) has to be less than robot.sensing_range_m (1)"},
      {"semantic_mapper",
       {"--set", "semantic_mapper.resolution_m=0.02", "--set", "robot.sensing_range_m=11"},
       "robot.sensing_range_m (11) has to be at most 500 times semantic_mapper.resolution_m (0.02)"},
      {"semantic_mapper",
       {"--set", "semantic_mapper.resolution_m=0.02", "--set", "semantic_mapper.tile_edge_m=3"},
       "semantic_mapper.tile_edge_m (3) has to be at most 128 times semantic_mapper.resolution_m (0.02)"},
      {"simulator", {"--mode", "sideways"}, R"(simulator.mode: "sideways" is not one of lockstep | freerun)"},
      {"simulator", {"--set", "simulator.start=here"}, R"(simulator.start ("here") has to be "x y yaw_deg", or empty)"},
      {"slam", {"--config", "/dev/zero"}, "/dev/zero: cannot be read"}};
  for (const auto& [name, arguments, reason] : cases) {
    for (const bool is_asked : {true, false}) {
      auto all = arguments;
      if (is_asked) all.emplace_back("--check-config");
      ChildProcess process("lapis_" + name, all);
      EXPECT_EQ(process.wait(), 2) << process.log();
      EXPECT_THAT(process.log(), HasSubstr("lapis_" + name + ": " + reason)) << (is_asked ? "asked" : "started");
    }
  }
}

TEST(Process, UnknownKeyInAFileNamesFileAndKey) {
  const auto file = temporary_file("echo.yaml", "test_echo:\n  tiles: 3\n  tyles: 4\n");
  const auto outcome = run({"--config", file.string()});
  EXPECT_EQ(outcome.status, 2) << outcome.log;
  EXPECT_THAT(outcome.log, HasSubstr("echo.yaml"));
  EXPECT_THAT(outcome.log, HasSubstr("test_echo.tyles"));
}

TEST(Process, WrongDomainInTheEnvironmentIsStatus2) {
  ChildProcess process("/usr/bin/env", {"ROS_DOMAIN_ID=nonsense", (bin_dir() / kEchoProgram).string()});
  EXPECT_EQ(process.wait(), 2) << process.log();
  EXPECT_THAT(process.log(), HasSubstr("ROS_DOMAIN_ID='nonsense'"));
}

TEST(Process, PrintedConfigurationReadsBackToItself) {
  const auto printed = run({"--set", "test_echo.tiles=7", "--set", "test_echo.greeting=a: b # c", "--print-config"});
  ASSERT_EQ(printed.status, 0) << printed.log;
  EXPECT_THAT(printed.output, HasSubstr("tiles: 7"));
  const auto file = temporary_file("printed.yaml", printed.output);
  EXPECT_EQ(run({"--config", file.string(), "--print-config"}).output, printed.output);
  const auto checked = run({"--config", file.string(), "--check-config"});
  EXPECT_EQ(checked.status, 0) << checked.log;
}

TEST(Process, LaterLayersWin) {
  const auto first = temporary_file("first.yaml", "test_echo:\n  tiles: 1\n  greeting: first\n");
  const auto second = temporary_file("second.yaml", "test_echo:\n  tiles: 2\n");
  const auto printed = run({"--config", first.string(), "--config", second.string(), "--print-config"});
  EXPECT_THAT(printed.output, HasSubstr("tiles: 2"));
  EXPECT_THAT(printed.output, HasSubstr("greeting: \"first\""));
  const auto overridden = run({"--config", second.string(), "--set", "test_echo.tiles=3", "--print-config"});
  EXPECT_THAT(overridden.output, HasSubstr("tiles: 3"));
}

TEST(Process, ExplainsItself) {
  const auto version = run({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.output, HasSubstr("lapis "));
  const auto help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* option : {"--config", "--set", "--domain", "--namespace", "--transport", "--use-sim-time",
                             "--print-config", "--check-config", "--log-level", "--version"}) {
    EXPECT_THAT(help.output, HasSubstr(option));
  }
}

TEST(Process, SmallSocketBuffersAreWarnedAbout) {
  ChildProcess process(kEchoProgram, {"--set", "dds.socket_buffer_bytes=212992"});
  ASSERT_TRUE(wait_until_ready(process)) << process.log();
  EXPECT_THAT(process.log(), HasSubstr("60-lapis.conf"));
  EXPECT_EQ(process.stop(SIGTERM), 0);
}

TEST(Process, SharedMemoryWorksAndIsWarnedAbout) {
  ChildProcess process(kEchoProgram, {"--transport", "shm"});
  ASSERT_TRUE(wait_until_ready(process)) << process.log();
  EXPECT_THAT(process.log(), HasSubstr("shared memory"));
  EXPECT_EQ(process.stop(SIGTERM), 0);
}

}  // namespace
}  // namespace lapis::test
