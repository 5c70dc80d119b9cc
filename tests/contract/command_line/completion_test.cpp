// The completion for bash beside topics of the test.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "common/topics/robot.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

/// What bash offers for a command line; its last word is the one under the cursor.
std::vector<std::string> offered(TopicProbe& probe, const std::string& line) {
  const std::string script = "source '" LAPIS_COMPLETION "'; complete -p lapis >&2; COMP_WORDS=(" + line +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _lapis; printf '%s\\n' \"${COMPREPLY[@]}\"";
  ChildProcess bash("/bin/bash", {"-c", "PATH='" + bin_dir().string() + "':$PATH; " + script});
  probe.wait_until([&] { return !bash.is_running(); }, Seconds(20));
  EXPECT_EQ(bash.wait(), 0) << bash.log();
  EXPECT_NE(bash.log().find("complete -F _lapis lapis"), std::string::npos) << bash.log();
  std::vector<std::string> words;
  std::istringstream in(bash.output());
  for (std::string word; std::getline(in, word);) {
    if (!word.empty()) words.push_back(word);
  }
  return words;
}

TEST(Completion, OffersEveryCommand) {
  TopicProbe probe;
  ChildProcess help("lapis", {"--help"});
  ASSERT_EQ(help.wait(), 0);
  std::vector<std::string> commands;
  std::istringstream in(help.output().substr(help.output().find("Subcommands:")));
  std::string line;
  for (std::getline(in, line); std::getline(in, line) && line.starts_with("  ");) {
    if (line[2] != ' ') commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  EXPECT_EQ(commands.size(), 13U) << help.output();
  EXPECT_THAT(offered(probe, "lapis ''"), ::testing::UnorderedElementsAreArray(commands));
  EXPECT_THAT(offered(probe, "lapis pa"), ElementsAre("pause", "params"));
  EXPECT_THAT(offered(probe, "lapis params d"), ElementsAre("describe", "dump"));
  EXPECT_THAT(offered(probe, "lapis --domain 7 do"), ElementsAre("doctor"));
}

TEST(Completion, OffersOptions) {
  TopicProbe probe;
  EXPECT_THAT(offered(probe, "lapis echo /odom --"), IsSupersetOf({"--once", "--field", "--json", "--domain"}));
  EXPECT_THAT(offered(probe, "lapis doctor --sec"), ElementsAre("--seconds"));
  EXPECT_THAT(offered(probe, "lapis record --exc"), ElementsAre("--exclude"));
}

TEST(Completion, OffersTheTopicsOfTheDomain) {
  TopicProbe probe;
  probe.advertise(topics::kWheelOdometry);
  EXPECT_THAT(offered(probe, "lapis echo /o"), ElementsAre("/odom"));
  EXPECT_THAT(offered(probe, "lapis record out --topic /o"), ElementsAre("/odom"));
  EXPECT_THAT(offered(probe, "lapis echo /odom ''"), IsEmpty());
}

TEST(Completion, OffersTheServicesOfTheDomain) {
  TopicProbe probe;
  ChildProcess planner("lapis_planner");
  ASSERT_TRUE(wait_until_ready(planner)) << planner.log();
  EXPECT_THAT(offered(probe, "lapis call /planner/"), Contains("/planner/pause"));
}

}  // namespace
}  // namespace lapis::test
