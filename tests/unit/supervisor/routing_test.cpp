// Which process gets which setting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "supervisor/core/routing.hpp"

namespace lapis::supervisor {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Configurations& known() {
  static const Configurations configurations = {
      {"eye", {{"eye.rate_hz", "15"}, {"robot.radius_m", "0.2"}, {"dds.buffer", "1"}}},
      {"leg", {{"leg.speed_m_s", "0.6"}, {"robot.radius_m", "0.2"}, {"dds.buffer", "1"}}},
      {"mind", {{"mind.method", "a"}, {"dds.buffer", "1"}}}};
  return configurations;
}

TEST(Routing, SettingGoesToEveryProcessThatKnowsItsKey) {
  const auto routed = route(known(), {{"robot.radius_m", "0.3"}, {"mind.method", "b"}, {"dds.buffer", "2"}});
  EXPECT_THAT(routed.at("eye"), ElementsAre(Setting{"robot.radius_m", "0.3"}, Setting{"dds.buffer", "2"}));
  EXPECT_THAT(routed.at("leg"), ElementsAre(Setting{"robot.radius_m", "0.3"}, Setting{"dds.buffer", "2"}));
  EXPECT_THAT(routed.at("mind"), ElementsAre(Setting{"mind.method", "b"}, Setting{"dds.buffer", "2"}));
}

TEST(Routing, OrderIsKeptSoThatLaterOnesWin) {
  const auto routed = route(known(), {{"mind.method", "b"}, {"mind.method", "c"}});
  EXPECT_THAT(routed.at("mind"), ElementsAre(Setting{"mind.method", "b"}, Setting{"mind.method", "c"}));
}

TEST(Routing, KeyThatOnlyItsProcessCanRefuseGoesThere) {
  const auto routed = route(known(), {{"mind.metod", "b"}});
  EXPECT_THAT(routed.at("mind"), ElementsAre(Setting{"mind.metod", "b"}));
}

TEST(Routing, SettingThatNobodyKnowsIsRefusedWithWhatThereIs) {
  for (const char* key : {"arm.length_m", "rate_hz", "robot.colour", ""}) {
    try {
      route(known(), {{key, "1"}});
      FAIL() << key;
    } catch (const UnknownSetting& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string(key) + "=1: unknown key"));
      EXPECT_THAT(error.what(), HasSubstr("eye. leg. mind. robot."));
    }
  }
}

TEST(Routing, FileIsForThoseWhoKnowItsSections) {
  EXPECT_THAT(readers_of(known(), {"robot"}), ElementsAre("eye", "leg"));
  EXPECT_THAT(readers_of(known(), {"dds"}), ElementsAre("eye", "leg", "mind"));
  EXPECT_THAT(readers_of(known(), {"mind"}), ElementsAre("mind"));
  EXPECT_THAT(readers_of(known(), {}), IsEmpty());
}

TEST(Routing, FileThatWouldBeReadInPartIsRefused) {
  const auto refusal = [](const std::vector<std::string>& sections) {
    try {
      readers_of(known(), sections);
    } catch (const UnknownSetting& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal({"robto"}), AllOf(HasSubstr("robto: no process"), HasSubstr("robot.")));
  EXPECT_THAT(refusal({"robot", "robto"}), HasSubstr("robto: no process"));
  EXPECT_THAT(refusal({"robot", "mind"}), AllOf(HasSubstr("robot and mind"), HasSubstr("a file for each")));
  EXPECT_THAT(refusal({"robot", "eye"}), HasSubstr("robot and eye")) << "the leg needs the robot, too";
}

}  // namespace
}  // namespace lapis::supervisor
