// Descriptions of systems: those that are shipped, and what is wrong with others.
#include "supervisor/core/system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "supervisor/program.hpp"
#include "supervisor/system_yaml.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::supervisor {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SystemFile : public ::testing::Test {
 protected:
  System read(const std::string& text) {
    const auto file = folder_.path() / "small.yaml";
    std::ofstream(file) << text;
    return read_system(file);
  }
  std::string problem(const std::string& text) {
    try {
      read(text);
    } catch (const BadSetup& error) {
      return error.what();
    }
    return "none";
  }
  test::TemporaryFolder folder_;
};

TEST_F(SystemFile, ShippedOnesAreGood) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SYSTEMS_FOLDER)) {
    if (entry.path().extension() != ".yaml") continue;
    const System system = read_system(entry.path());
    EXPECT_EQ(system.processes.back(), system.source) << entry.path();
    EXPECT_THAT(system.results, Contains(system.result)) << entry.path();
    EXPECT_THAT(system.results, Contains(system.report)) << entry.path();
    for (const auto& file : system.configuration) EXPECT_TRUE(std::filesystem::exists(file)) << file;
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(SystemFile, EverythingIsRead) {
  const System system = read(
      "processes: [mind, eye]\nsource: eye\nstages: [mind]\nsilence_s: 3\nshows: mind\n"
      "settings: {eye.names: [a, b], mind.on: true}\n"
      "variants: {fast: {silence_s: 1, settings: {eye.rate_hz: 30}},\n"
      "           calm: {processes: [mind, ear, eye], stages: [mind, ear]}}\n"
      "restart: {times: 2, resume: {mind: [{file: x.map, settings: {mind.from: \"{run_folder}/x.map\"}}, {file: "
      "y}]}}\n");
  EXPECT_EQ(system.name, "small");
  EXPECT_THAT(system.settings, ElementsAre(Setting{"eye.names", "[a, b]"}, Setting{"mind.on", "true"}));
  EXPECT_EQ(system.variants.at("fast").silence, "1");
  EXPECT_THAT(system.variants.at("calm").processes, ElementsAre("mind", "ear", "eye"));
  EXPECT_EQ(system.restart.times, 2);
  ASSERT_EQ(system.restart.resume.at("mind").size(), 2U);
  EXPECT_EQ(system.restart.resume.at("mind")[0].file, "x.map");
  EXPECT_EQ(system.restart.resume.at("mind")[1].file, "y");
}

TEST_F(SystemFile, AVariantChangesWhatItNames) {
  const System system = read(
      "processes: [mind, eye]\nsource: eye\nstages: [mind]\nsilence_s: 3\nsettings: {eye.on: true}\n"
      "variants: {fast: {silence_s: 1}, calm: {processes: [mind, ear, eye], stages: [mind, ear], settings: {eye.on: "
      "false}}}\n");
  const System both = varied(varied(system, system.variants.at("fast")), system.variants.at("calm"));
  EXPECT_EQ(both.silence, "1");
  EXPECT_THAT(both.processes, ElementsAre("mind", "ear", "eye"));
  EXPECT_THAT(both.stages, ElementsAre("mind", "ear"));
  EXPECT_THAT(both.settings, ElementsAre(Setting{"eye.on", "true"}, Setting{"eye.on", "false"}));
  EXPECT_EQ(varied(system, system.variants.at("fast")).processes, system.processes);
}

TEST_F(SystemFile, AVariantAddsProcessesBeforeTheSource) {
  const System system = read(
      "processes: [mind, eye]\nsource: eye\nstages: [mind]\nsilence_s: 3\n"
      "variants: {calm: {processes: [ear, mind, eye], stages: [ear, mind]}, written: {adds: [pen]}}\n");
  const System both = varied(varied(system, system.variants.at("calm")), system.variants.at("written"));
  EXPECT_THAT(both.processes, ElementsAre("ear", "mind", "pen", "eye"));
  EXPECT_THAT(both.stages, ElementsAre("ear", "mind", "pen"));
}

TEST_F(SystemFile, WhatItSaysWinsOverItsBase) {
  std::ofstream(folder_.path() / "base.yaml") << "silence_s: 3\nreport: a.txt\nconfiguration: [robot.yaml]\n";
  const System system = read("base: base.yaml\nprocesses: [eye]\nsource: eye\nreport: b.txt\n");
  EXPECT_EQ(system.silence, "3");
  EXPECT_EQ(system.report, "b.txt");
  EXPECT_THAT(system.configuration, ElementsAre((folder_.path() / "robot.yaml").string()));
  EXPECT_THAT(problem("base: none.yaml\n"), HasSubstr("small.yaml: "));
  EXPECT_THAT(problem("base: small.yaml\n"), HasSubstr("line 1: a base has no base"));
}

TEST_F(SystemFile, WhatIsWrongIsNamedWithFileLineAndRemedy) {
  EXPECT_THAT(problem("processes: [a]\nsource: a\nsilence: 3\n"),
              HasSubstr("small.yaml: line 3: unknown key silence;"));
  EXPECT_THAT(problem("processes: a\n"), HasSubstr("line 1: a list such as"));
  EXPECT_THAT(problem("processes: [a, b]\nsource: a\nsilence_s: 1\n"), HasSubstr("source: has to be the last"));
  EXPECT_THAT(problem("processes: [a, a]\nsource: a\nsilence_s: 1\n"), HasSubstr("a is there twice"));
  EXPECT_THAT(problem("processes: [a]\nsource: a\n"), HasSubstr("silence_s: give seconds"));
  EXPECT_THAT(problem("processes: [a]\nsource: a\nsilence_s: 1\nstages: [b]\n"), HasSubstr("stages: b is not"));
  EXPECT_THAT(problem("restart: {resume: {a: {file: x}}}\n"), HasSubstr("line 1: give a list of files"));
  EXPECT_THAT(problem("processes: [\n"), HasSubstr("small.yaml: "));
  EXPECT_THAT(problem("processes: [a]\nsource: a\nsilence_s: 1\nvariants: {calm: {stages: [b]}}\n"),
              HasSubstr("variants: calm: stages: b is not"));
  EXPECT_THROW(read_system(folder_.path() / "none.yaml"), BadSetup);
}

}  // namespace
}  // namespace lapis::supervisor
