#include "common/runtime/run_component.hpp"

#include <CLI/CLI.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::runtime {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct ProbeConfig {
  int speed = 3;
  int limit = 9;
  std::string gear = "low";
};

template <class Field>
void describe(Field& field, ProbeConfig& c) {
  field("speed", c.speed, config::in_range(1, 9), "how fast");
  field("limit", c.limit, config::in_range(1, 9), "of speed");
  field("gear", c.gear, config::one_of({"low", "high"}), "which");
}

// A component whose tool mode ends the process before any DDS is set up.
struct ProbeComponent {
  using Config = ProbeConfig;
  static constexpr const char* kName = "probe";
  static constexpr const char* kSummary = "ends at once";
  static void add_options(CLI::App& app, Config& c) {
    app.add_option("--speed", c.speed);
    app.add_option("--gear", c.gear);
  }
  static config::Rules rules(const Config& c) {
    return {{c.speed <= c.limit, "probe.speed has to be at most probe.limit"}};
  }
  ProbeComponent(const Config&, Context&) { ADD_FAILURE() << "the tool should have ended the process"; }
  static std::optional<int> run_tool(const Config& c) {
    std::cout << "speed " << c.speed << '\n';
    return c.speed == 9 ? 1 : 0;
  }
};

struct Outcome {
  int status;
  std::string out;
  std::string err;
};

Outcome run_probe(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "lapis_probe");
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int status = run_component<ProbeComponent>(static_cast<int>(argv.size()), argv.data());
  return {status, ::testing::internal::GetCapturedStdout(), ::testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, ToolSeesTheConfigurationInEffect) {
  EXPECT_EQ(run_probe({}).out, "speed 3\n");
  EXPECT_EQ(run_probe({"--set", "probe.speed=5"}).out, "speed 5\n");
  EXPECT_EQ(run_probe({"--set", "probe.speed=9"}).status, 1);
}

TEST(CommandLine, OptionsOfTheComponentWinAndAreChecked) {
  EXPECT_EQ(run_probe({"--speed", "4", "--set", "probe.speed=5"}).out, "speed 4\n");
  const auto out_of_range = run_probe({"--speed", "99"});
  EXPECT_EQ(out_of_range.status, 2);
  EXPECT_THAT(out_of_range.err, HasSubstr("1 to 9"));
}

TEST(CommandLine, BadSetUpIsStatus2AndOneHelpfulLine) {
  const auto unknown = run_probe({"--set", "probe.sped=5"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("probe.sped"));
  const auto out_of_range = run_probe({"--set", "probe.speed=99"});
  EXPECT_EQ(out_of_range.status, 2);
  EXPECT_THAT(out_of_range.err, HasSubstr("1 to 9"));
  EXPECT_EQ(run_probe({"--set", "probe.speed"}).status, 2);
  EXPECT_EQ(run_probe({"--namespace", "robot 1"}).status, 2);
  const auto domain = run_probe({"--domain", "232"});
  EXPECT_EQ(domain.status, 2);
  EXPECT_THAT(domain.err, AllOf(HasSubstr("--domain: Value 232 not in range"), HasSubstr("231")));
  EXPECT_EQ(run_probe({"--transport", "pigeon"}).status, 2);
  EXPECT_EQ(run_probe({"--config", "no_such_file.yaml"}).status, 2);
  EXPECT_EQ(run_probe({"--nonsense"}).status, 2);
}

TEST(CommandLine, CheckConfigRefusesWhatTheStartRefuses) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--set", "probe.speed=5", "--set", "probe.limit=4"}, "probe.speed (5) has to be at most probe.limit (4)"},
      {{"--gear", "sideways"}, R"(probe.gear: "sideways" is not one of low | high)"},
      {{"--config", "/dev/zero"}, "/dev/zero: cannot be read; give --config the path of an existing YAML file"}};
  for (const auto& [arguments, reason] : cases) {
    for (const char* question : {"", "--check-config", "--print-config"}) {
      auto asked = arguments;
      if (*question != '\0') asked.emplace_back(question);
      const auto refused = run_probe(asked);
      EXPECT_EQ(refused.status, 2) << question;
      EXPECT_EQ(refused.err, "lapis_probe: " + reason + "\n") << question;
      EXPECT_EQ(refused.out, "") << question;
    }
  }
}

TEST(CommandLine, QuestionsAreAnsweredWithStatus0) {
  const auto printed = run_probe({"--set", "probe.speed=4", "--print-config"});
  EXPECT_EQ(printed.status, 0);
  EXPECT_THAT(printed.out, HasSubstr("speed: 4"));
  EXPECT_THAT(printed.out, HasSubstr("socket_buffer_bytes"));
  EXPECT_EQ(run_probe({"--check-config"}).status, 0);
  EXPECT_THAT(run_probe({"--version"}).out, HasSubstr("lapis "));
  EXPECT_THAT(run_probe({"--help"}).out, HasSubstr("--print-config"));
}

}  // namespace
}  // namespace lapis::runtime
