#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "common/config/schema.hpp"
#include "common/config/yaml.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::config {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Inner {
  double max_depth_m = 5.0;
  int iterations = 20;
};
struct Outer {
  Inner tracker;
  bool enabled = true;
  std::string mode = "fast";
  std::int64_t seed = 7;
  Words stages = {"slam", "semantic_mapper"};
  Numbers limits = {0.25, 3};
};

template <class Field>
void describe(Field& field, Inner& c) {
  field("max_depth_m", c.max_depth_m, in_range(0.1, 20.0), "measurements beyond this are ignored");
  field("iterations", c.iterations, in_range(1, 100), "Gauss-Newton steps", Change::kAtRunTime);
}
template <class Field>
void describe(Field& field, Outer& c) {
  field("tracker", c.tracker);
  field("enabled", c.enabled, anything(), "switch");
  field("mode", c.mode, one_of({"fast", "exact"}), "which way");
  field("seed", c.seed, at_least(0), "random seed");
  field("stages", c.stages, anything(), "order");
  field("limits", c.limits, in_range(0, 10), "of everything");
  field.moved("depth_limit_m", "slam.tracker.max_depth_m");
  field.moved("model", "mapper.model", "slam reads it in the map");
  field.removed("colour", "nothing was drawn in it");
}

class ConfigTest : public ::testing::Test {
 protected:
  ConfigTest() { schema_("slam", config_); }

  std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  std::string error_of_text(const std::string& text) {
    return error_of([&] { apply_text(schema_, text, "robot.yaml"); });
  }
  std::string error_of_set(const std::string& text) {
    return error_of([&] { apply_override(schema_, text); });
  }

  Outer config_;
  Schema schema_;
};

TEST_F(ConfigTest, LeavesOutKeepsTheDefault) {
  apply_text(schema_, "slam:\n  tracker:\n    max_depth_m: 4\n", "robot.yaml");
  EXPECT_DOUBLE_EQ(config_.tracker.max_depth_m, 4.0);
  EXPECT_EQ(config_.tracker.iterations, 20);
  EXPECT_EQ(config_.mode, "fast");
}

TEST_F(ConfigTest, OverrideReachesEveryKind) {
  apply_override(schema_, "slam.tracker.max_depth_m=2.5");
  apply_override(schema_, "slam.enabled=false");
  apply_override(schema_, "slam.mode=exact");
  apply_override(schema_, "slam.seed=9000000000");
  apply_override(schema_, "slam.stages=[a, b, c]");
  apply_override(schema_, "slam.limits=[0.5, 10]");
  EXPECT_DOUBLE_EQ(config_.tracker.max_depth_m, 2.5);
  EXPECT_FALSE(config_.enabled);
  EXPECT_EQ(config_.mode, "exact");
  EXPECT_EQ(config_.seed, 9000000000);
  EXPECT_EQ(config_.stages, (Words{"a", "b", "c"}));
  EXPECT_EQ(config_.limits, (Numbers{0.5, 10}));
}

TEST_F(ConfigTest, PrintedConfigurationReadsBackUnchanged) {
  config_.tracker.max_depth_m = 1.0 / 3.0;
  config_.mode = "exact";
  config_.stages = {"with \"quotes\"", "and \\ back"};
  config_.limits = {};
  const std::string text = to_yaml(schema_);
  Outer other;
  Schema other_schema;
  other_schema("slam", other);
  apply_text(other_schema, text, "printed");
  EXPECT_EQ(to_yaml(other_schema), text);
  EXPECT_EQ(other.tracker.max_depth_m, 1.0 / 3.0);
}

TEST_F(ConfigTest, UnknownKeyNamesFileLinePathAndNeighbour) {
  EXPECT_THAT(error_of_text("slam:\n  tracker:\n    max_depth: 4\n"),
              AllOf(HasSubstr("robot.yaml:3"), HasSubstr("slam.tracker.max_depth: unknown key"),
                    HasSubstr("slam.tracker.max_depth_m")));
  EXPECT_THAT(error_of_set("slam.nothing=1"), AllOf(HasSubstr("slam.nothing"), HasSubstr("unknown key")));
  EXPECT_THAT(error_of_text("planner: {}\n"), HasSubstr("planner: unknown key"));
}

TEST_F(ConfigTest, AKeyOfBeforeIsRefusedWithItsNameOfToday) {
  EXPECT_THAT(error_of_text("slam:\n  depth_limit_m: 4\n"),
              AllOf(HasSubstr("robot.yaml:2"), HasSubstr("slam.depth_limit_m: is now 'slam.tracker.max_depth_m'")));
  EXPECT_EQ(error_of_set("slam.depth_limit_m=4"),
            "--set slam.depth_limit_m=4: slam.depth_limit_m: is now 'slam.tracker.max_depth_m'");
  EXPECT_THAT(error_of_text("slam: {model: {gain: 1}}"), HasSubstr("slam.model: is now 'mapper.model': slam reads it"));
  EXPECT_THAT(error_of_set("slam.model.gain=1"), HasSubstr("slam.model.gain: is now 'mapper.model.gain': slam reads"));
  EXPECT_THAT(error_of_set("slam.colour=red"), HasSubstr("slam.colour: is gone: nothing was drawn in it"));
  EXPECT_THAT(error_of_set("slam.models=1"), HasSubstr("unknown key")) << "begins like one of before";
  EXPECT_THAT(to_yaml(schema_), Not(HasSubstr("depth_limit_m")));
}

TEST_F(ConfigTest, OutOfRangeNamesValueAndBound) {
  EXPECT_THAT(error_of_text("slam: {tracker: {max_depth_m: 40}}"),
              AllOf(HasSubstr("robot.yaml:1"), HasSubstr("slam.tracker.max_depth_m"), HasSubstr("'40'"),
                    HasSubstr("0.1 to 20")));
  EXPECT_THAT(error_of_text("slam: {tracker: {max_depth_m: .nan}}"), HasSubstr("out of range"));
  EXPECT_THAT(error_of_set("slam.limits=[1, 11]"), AllOf(HasSubstr("'11'"), HasSubstr("0 to 10")));
  EXPECT_THAT(error_of_set("slam.mode=slow"), AllOf(HasSubstr("'slow'"), HasSubstr("fast | exact")));
}

TEST_F(ConfigTest, ValuesFromElsewhereAreChecked) {
  EXPECT_NO_THROW(check(schema_));
  config_.tracker.iterations = 0;
  EXPECT_THAT(error_of([&] { check(schema_); }), AllOf(HasSubstr("slam.tracker.iterations: 0"), HasSubstr("1 to 100")));
  config_.tracker.iterations = 1;
  config_.tracker.max_depth_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { check(schema_); }), HasSubstr("slam.tracker.max_depth_m"));
  config_.tracker.max_depth_m = 1.0;
  config_.mode = "sideways";
  EXPECT_EQ(error_of([&] { check(schema_); }), "slam.mode: \"sideways\" is not one of fast | exact");
  config_.mode = "fast";
  config_.limits = {1, 11};
  EXPECT_THAT(error_of([&] { check(schema_); }), AllOf(HasSubstr("slam.limits: [1, 11]"), HasSubstr("0 to 10")));
}

TEST_F(ConfigTest, BrokenRuleNamesTheValuesOfTheKeysThatItNames) {
  config_.tracker.max_depth_m = 0.5;
  const Rule good{true, "slam.seed has to be 7"};
  EXPECT_EQ(error_of([&] { check(schema_, {good}); }), "no error");
  EXPECT_EQ(error_of([&] {
              check(schema_, {good, {false, "slam.tracker.max_depth_m, slam.seeds and slam.mode differ"}});
            }),
            "slam.tracker.max_depth_m (0.5), slam.seeds and slam.mode (\"fast\") differ");
}

TEST_F(ConfigTest, WrongTypesAreErrors) {
  EXPECT_THAT(error_of_text("slam: {tracker: {iterations: 2.5}}"), HasSubstr("not a whole number"));
  EXPECT_THAT(error_of_text("slam: {enabled: perhaps}"), HasSubstr("not true or false"));
  EXPECT_THAT(error_of_text("slam: {tracker: 4}"), HasSubstr("a section with keys is needed"));
  EXPECT_THAT(error_of_text("slam: {stages: slam}"), HasSubstr("a list"));
  EXPECT_THAT(error_of_text("slam: {limits: 1}"), HasSubstr("a list"));
  EXPECT_THAT(error_of_text("slam: {limits: [1, few]}"), HasSubstr("'few' is not a number"));
  EXPECT_THAT(error_of_text("slam: {mode: [fast]}"), HasSubstr("text is needed"));
  EXPECT_THAT(error_of_text("slam: {seed: 1, seed: 2}"), HasSubstr("twice"));
  EXPECT_THAT(error_of_set("slam.seed"), HasSubstr("path=value"));
}

TEST_F(ConfigTest, MissingFileAndBrokenYamlNameTheFile) {
  EXPECT_THAT(error_of([&] { apply_file(schema_, "/nonexistent/robot.yaml"); }), HasSubstr("/nonexistent/robot.yaml"));
  EXPECT_THAT(error_of([&] { apply_file(schema_, std::filesystem::temp_directory_path().string()); }),
              HasSubstr("cannot be read"));
  EXPECT_THAT(error_of_text("slam: {seed: 1}\n---\nslam: {seed: 2}\n"), HasSubstr("more than one YAML document"));
  EXPECT_THAT(error_of_text("slam: [unclosed"), AllOf(HasSubstr("robot.yaml"), HasSubstr("not valid YAML")));
}

TEST_F(ConfigTest, FileThatIsNoTextIsRefused) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "robot.yaml").string();
  const auto error_of_file = [&](std::string_view bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    return error_of([&] { apply_file(schema_, file); });
  };
  using std::string_view_literals::operator""sv;
  for (const auto bytes : {"\xff\xfe#\0\n\0"sv, "\xfe\xff\0#\0\n"sv, "#\0\n\0"sv, "\0#\0\n"sv, "\0\0\xfe\xff\0\0\0#"sv,
                           "slam: {seed: 1}\n\0"sv, "# caf\xe9\n"sv}) {
    EXPECT_EQ(error_of_file(bytes), file + ": is not UTF-8 text") << testing::PrintToString(bytes);
  }
  EXPECT_EQ(error_of_file("\xef\xbb\xbf# caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\xa4\x96\nslam: {seed: 9}\n"), "no error");
  EXPECT_EQ(config_.seed, 9);
  EXPECT_EQ(error_of_file(std::string(16 << 20, '\n')), "no error");
  EXPECT_EQ(error_of_file(std::string((16 << 20) + 1, '\n')), file + ": is larger than 16 MiB");
}

TEST_F(ConfigTest, PathThatIsNoFileIsRefusedAtOnce) {
  const test::TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {std::string("/dev/zero"), pipe, folder.path().string(), pipe + "/robot.yaml",
                                  std::string(5000, 'x'), std::string()}) {
    EXPECT_THAT(error_of([&] { apply_file(schema_, path); }), HasSubstr(path + ": cannot be read")) << path;
  }
}

TEST_F(ConfigTest, GarbageIsRefusedOrApplied) {
  const std::string valid = to_yaml(schema_);
  std::mt19937 engine(5);
  for (int round = 0; round < 3000; ++round) {
    std::string text = valid;
    for (int flips = 0; flips < 3; ++flips) text[engine() % text.size()] = static_cast<char>(engine() % 256);
    Outer other;
    Schema schema;
    schema("slam", other);
    try {
      apply_text(schema, text, "fuzz");
    } catch (const Error&) {
      continue;  // any other exception fails the test
    }
    EXPECT_GE(other.tracker.max_depth_m, 0.1);
    EXPECT_LE(other.tracker.max_depth_m, 20.0);
  }
}

TEST_F(ConfigTest, MarkdownTableHasARowPerKey) {
  const std::string table = to_markdown(schema_);
  EXPECT_THAT(table,
              HasSubstr("| `slam.tracker.max_depth_m` | `5` | 0.1 to 20 | measurements beyond this are ignored |"));
  EXPECT_THAT(table, HasSubstr("| Gauss-Newton steps; may change at run time |"));
  EXPECT_THAT(table, HasSubstr("fast \\| exact"));
}

}  // namespace
}  // namespace lapis::config
