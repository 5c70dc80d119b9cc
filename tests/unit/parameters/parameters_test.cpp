// The configuration of a process as the parameters of a ROS 2 node.
#include "common/parameters/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::parameters {
namespace {

using rcl_interfaces::msg::Parameter;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
namespace types = rcl_interfaces::msg::ParameterType_Constants;

struct Tracker {
  int least = 10, most = 20;
  double range_m = 5.0;
};
struct Config {
  Tracker tracker;
  std::string mode = "fast";
};

template <class Field>
void describe(Field& field, Tracker& c) {
  field("least", c.least, config::in_range(1, 100), "fewest matches", config::Change::kAtRunTime);
  field("most", c.most, config::in_range(1, 100), "most matches", config::Change::kAtRunTime);
  field("range_m", c.range_m, config::in_range(0.1, 20.0), "range");
}
template <class Field>
void describe(Field& field, Config& c) {
  field("tracker", c.tracker);
  field("mode", c.mode, config::one_of({"fast", "exact"}), "which way");
}

Parameter integer(const std::string& name, std::int64_t value) {
  Parameter parameter;
  parameter.name(name);
  parameter.value().type(types::PARAMETER_INTEGER);
  parameter.value().integer_value(value);
  return parameter;
}

class ParametersTest : public ::testing::Test {
 protected:
  static config::Schema schema(Config& config, bool& flag) {
    config::Schema schema;
    schema("slam", config);
    schema("use_sim_time", flag, config::anything(), "whose time");
    return schema;
  }
  std::vector<std::string> names(const std::vector<std::string>& prefixes, std::uint64_t depth) const {
    return parameters_.list(prefixes, depth).names();
  }
  std::string refusal(const std::vector<Parameter>& wanted) {
    const auto result = parameters_.set(wanted);
    EXPECT_EQ(result.successful(), result.reason().empty());
    return result.reason();
  }

  Config config_;
  bool flag_ = false;
  int applied_ = 0;
  Parameters parameters_{
      "slam",
      schema(config_, flag_),
      {[this] {
         return config::Rules{{config_.tracker.least < config_.tracker.most, "slam.tracker.least has to be less"}};
       },
       [this] { ++applied_; }}};
};

TEST_F(ParametersTest, AreListedByPrefixAndDepth) {
  EXPECT_THAT(names({}, 0), ElementsAre("slam.mode", "slam.tracker.least", "slam.tracker.most", "slam.tracker.range_m",
                                        "use_sim_time"));
  EXPECT_THAT(names({}, 1), ElementsAre("use_sim_time"));
  EXPECT_THAT(names({}, 2), ElementsAre("slam.mode", "use_sim_time"));
  EXPECT_THAT(names({"slam"}, 1), ElementsAre("slam.mode"));
  EXPECT_THAT(names({"slam.tracker"}, 1),
              ElementsAre("slam.tracker.least", "slam.tracker.most", "slam.tracker.range_m"));
  EXPECT_THAT(names({"slam.mode", "use_sim_time"}, 1), ElementsAre("slam.mode", "use_sim_time"));
  EXPECT_THAT(names({"sl", "slam.", "slam.track", ""}, 0), IsEmpty());
  EXPECT_THAT(parameters_.list({}, 0).prefixes(), ElementsAre("slam", "slam.tracker"));
  EXPECT_THAT(parameters_.list({}, 1).prefixes(), IsEmpty());
}

TEST_F(ParametersTest, AreReadAndDescribedAndUnknownOnesAreNotSet) {
  EXPECT_EQ(parameters_.value("slam.tracker.least").integer_value(), 10);
  EXPECT_EQ(parameters_.text("slam.mode"), "\"fast\"");
  EXPECT_EQ(parameters_.descriptor("slam.tracker.range_m").type(), types::PARAMETER_DOUBLE);
  for (const char* name : {"slam.tracker", "slam.tracker.leas", "", "zzz"}) {
    EXPECT_EQ(parameters_.value(name).type(), types::PARAMETER_NOT_SET);
    EXPECT_EQ(parameters_.text(name), "");
    EXPECT_EQ(parameters_.descriptor(name).type(), types::PARAMETER_NOT_SET);
    EXPECT_EQ(parameters_.descriptor(name).name(), name);
  }
}

TEST_F(ParametersTest, ThatMayChangeDo) {
  EXPECT_EQ(refusal({integer("slam.tracker.least", 12)}), "");
  EXPECT_EQ(config_.tracker.least, 12);
  EXPECT_EQ(applied_, 1);
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(applied_, 1);
}

TEST_F(ParametersTest, AreRefusedWithTheReasonAndNothingChanges) {
  EXPECT_EQ(refusal({integer("slam.trackr.least", 3)}), "there is no parameter 'slam.trackr.least'");
  EXPECT_EQ(refusal({integer("slam.tracker.range_m", 3)}),
            "slam.tracker.range_m is read at start: set it in the configuration and restart slam");
  EXPECT_EQ(refusal({integer("slam.tracker.least", 0)}), "slam.tracker.least: 0 is out of range, allowed is 1 to 100");
  EXPECT_EQ(refusal({integer("slam.tracker.least", 20)}), "slam.tracker.least has to be less");
  EXPECT_EQ(config_.tracker.least, 10);
  EXPECT_EQ(config_.tracker.range_m, 5.0);
  EXPECT_EQ(applied_, 0);
}

TEST_F(ParametersTest, AreSetAllOrNone) {
  EXPECT_EQ(refusal({integer("slam.tracker.least", 30), integer("slam.tracker.most", 40)}), "")
      << "the rule holds for both together";
  EXPECT_EQ(applied_, 1);
  EXPECT_NE(refusal({integer("slam.tracker.least", 35), integer("slam.tracker.most", 200)}), "");
  EXPECT_NE(refusal({integer("slam.tracker.least", 5), integer("slam.tracker.least", 6), integer("slam.none", 1)}), "");
  EXPECT_EQ(config_.tracker.least, 30);
  EXPECT_EQ(config_.tracker.most, 40);
  EXPECT_EQ(applied_, 1);
}

}  // namespace
}  // namespace lapis::parameters
