// Which process gets which setting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "supervisor/core/routing.hpp"

namespace lapis::supervisor {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST(Routing, FileIsForThoseWhoKnowAllItsSections) {
  EXPECT_TRUE(knows_sections(known().at("eye"), {"robot"}));
  EXPECT_TRUE(knows_sections(known().at("eye"), {"robot", "eye"}));
  EXPECT_FALSE(knows_sections(known().at("mind"), {"robot"}));
  EXPECT_FALSE(knows_sections(known().at("eye"), {"robot", "leg"}));
  EXPECT_FALSE(knows_sections(known().at("eye"), {"rob"}));
}

}  // namespace
}  // namespace lapis::supervisor
