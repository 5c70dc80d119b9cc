// The manifest is YAML, and metrics stay JSON, whatever paths and settings look like.
#include "supervisor/manifest.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>

#include "common/config/schema.hpp"

namespace lapis::supervisor {
namespace {

const std::vector<std::string>& odd_texts() {
  static const std::vector<std::string> texts = {"plain",
                                                 "two\nlines",
                                                 "tab\tquote\"'back\\slash",
                                                 "$(touch x) #: {}[]",
                                                 "größe 目",
                                                 "\x01\x7f",
                                                 " - a: b",
                                                 "null",
                                                 "6007e82",
                                                 "12345678",
                                                 "0x12",
                                                 "true",
                                                 ""};
  return texts;
}

TEST(Manifest, IsYamlForAnyText) {
  for (const auto& text : odd_texts()) {
    Manifest manifest{"explore.sh --out " + text, {{"scene", config::quoted(text)}, {"seed", "7"}}, {}};
    manifest.processes.push_back({"eye", 0, 1, "eye:\n  # note\n  rate_hz: 15\n"});
    manifest.processes.push_back({"leg", std::nullopt, 0, ""});
    const auto yaml = YAML::Load(to_yaml(manifest, "frames: 3\n"));
    EXPECT_EQ(yaml["command"].as<std::string>(), "explore.sh --out " + text);
    EXPECT_EQ(yaml["run"]["scene"].as<std::string>(), text);
    EXPECT_EQ(yaml["run"]["scene"].Tag(), "!") << "text";
    EXPECT_EQ(yaml["run"]["seed"].as<int>(), 7);
    EXPECT_EQ(yaml["exit_status"]["eye"].as<int>(), 0);
    EXPECT_TRUE(yaml["exit_status"]["leg"].IsNull());
    EXPECT_EQ(yaml["restarts"]["eye"].as<int>(), 1);
    EXPECT_EQ(yaml["simulation"]["frames"].as<int>(), 3);
    EXPECT_EQ(yaml["configuration"]["eye"]["eye"]["rate_hz"].as<int>(), 15);
  }
}

TEST(Manifest, TextThatIsNotUtf8IsYamlToo) {
  const Manifest manifest{"explore.sh --out \xff\xc3(", {}, {}};
  EXPECT_NO_THROW(YAML::Load(to_yaml(manifest, "")));
}

TEST(Manifest, TextsAreJsonToo) {
  for (const auto& text : odd_texts()) EXPECT_EQ(nlohmann::json::parse(config::quoted(text)), text);
}

TEST(Metrics, NumberThatJsonDoesNotHaveIsText) {
  EXPECT_EQ(nlohmann::json::parse(with_facts("{}", {{"duration_s", ".inf"}}))["run"]["duration_s"], ".inf");
}

TEST(Metrics, GetTheFactsOfTheRunAndKeepTheirOwn) {
  for (const auto& text : odd_texts()) {
    const auto json = nlohmann::json::parse(
        with_facts(R"({"ate": 0.1, "none": null})", {{"scene", config::quoted(text)}, {"seed", "7"}}));
    EXPECT_EQ(json["ate"], 0.1);
    EXPECT_TRUE(json["none"].is_null());
    EXPECT_EQ(json["run"]["scene"], text);
    EXPECT_EQ(json["run"]["seed"], 7);
  }
}

}  // namespace
}  // namespace lapis::supervisor
