// The real executable, as a user runs it.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/mapping/file/map_file.hpp"

namespace lapis::evaluator {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct Outcome {
  int status = -1;
  std::string text;  ///< standard output and error
};

class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("truth.txt", "# t\n0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 2 1 0 0 0 0 1\n4 2 2 0 0 0 0 1\n");
    write("walk.txt", "0 5 0 0 0 0 0 1\n1 6 0 0 0 0 0 1\n2 7 0 0 0 0 0 1\n3 7 1.1 0 0 0 0 1\n4 7 2.2 0 0 0 0 1\n");
    write("late.txt", "100 0 0 0 0 0 0 1\n");
    write("bad.txt", "0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(path(name)) << text; }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  Outcome run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" LAPIS_EVALUATOR "' " + arguments + " 2>&1";
    Outcome outcome;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.text += buffer.data();
    outcome.status = WEXITSTATUS(pclose(pipe));
    return outcome;
  }

  /// A wall of `width` voxels (at most 8) of class 1 behind free space; classes 1 = wall, 2 = `second_class`.
  void write_map(const std::string& name, int width, double resolution_m, const std::string& second_class) {
    mapping::MapFile file{
        mapping::VoxelMap(resolution_m), {}, mapping::LabelList::from_names({{1, "wall"}, {2, second_class}}), {}};
    mapping::BlockVotes block;
    mapping::FrameVotes votes;
    for (int y = 0; y < width; ++y) {
      const int front = mapping::offset_in_block({3, y, 0});
      block.misses[static_cast<std::size_t>(front / 64)] |= std::uint64_t{1} << (front % 64);
      votes.hits.push_back({static_cast<std::uint16_t>(mapping::offset_in_block({4, y, 0})), 1});
    }
    block.hits_end = static_cast<std::uint32_t>(votes.hits.size());
    votes.blocks.push_back(block);
    for (int frame = 0; frame < 3; ++frame) file.map.add(votes);  // one hit alone leaves P(occupied) below 0.5
    ASSERT_FALSE(mapping::save_map(path(name), file));
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("lapis_command_line_test_" + std::to_string(getpid()));
};

TEST_F(CommandLine, HelpNamesTheToolsAndEachGivesAnExample) {
  const Outcome help = run("--help");
  EXPECT_EQ(help.status, 0);
  for (const std::string tool : {"ate", "rpe", "map", "iou", "coverage"}) {
    EXPECT_THAT(help.text, HasSubstr(tool));
    const Outcome tool_help = run(tool + " --help");
    EXPECT_EQ(tool_help.status, 0);
    EXPECT_THAT(tool_help.text, HasSubstr("lapis_evaluator " + tool + " --"));
  }
}

TEST_F(CommandLine, AteInJsonAndText) {
  const Outcome none = run("ate --reference truth.txt --estimate walk.txt --align none --json");
  ASSERT_EQ(none.status, 0) << none.text;
  EXPECT_NEAR(json::parse(none.text)["position_m"]["min"].get<double>(), 5.0, 1e-12);
  const Outcome origin = run("ate --reference truth.txt --estimate walk.txt --align origin --json");
  EXPECT_NEAR(json::parse(origin.text)["position_m"]["max"].get<double>(), 0.2, 1e-12);
  const Outcome text = run("ate --reference truth.txt --estimate walk.txt --align origin --association interpolate");
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.text, HasSubstr("matched_pairs"));
  EXPECT_THAT(text.text, HasSubstr("rmse 0.100000"));
}

TEST_F(CommandLine, RpeInEveryUnit) {
  for (const std::string unit : {"s", "m", "frames"}) {
    const Outcome outcome = run("rpe --reference truth.txt --estimate walk.txt --delta 1 --json --unit " + unit);
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    const json result = json::parse(outcome.text);
    EXPECT_EQ(result["intervals"], unit == "frames" ? 4 : 3);
    EXPECT_NEAR(result["translation_m"]["max"].get<double>(), 0.1, 1e-12);
  }
}

TEST_F(CommandLine, WrongArgumentsAndFilesExitWith2AndSayWhat) {
  const std::string pair = "--reference truth.txt --estimate walk.txt ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"ate", "--reference"},
      {"ate " + pair, "--align"},
      {"ate " + pair + "--align sim3", "sim3"},
      {"ate " + pair + "--align se3 --max-difference -1", "--max-difference"},
      {"ate " + pair + "--align se3 --no-such-flag", "no-such-flag"},
      {"ate --reference absent.txt --estimate walk.txt --align se3", "absent.txt"},
      {"ate --reference truth.txt --estimate bad.txt --align se3", "bad.txt:2: 'nan'"},
      {"ate --reference truth.txt --estimate late.txt --align se3", "--max-difference"},
      {"rpe " + pair + "--delta 100", "--delta"},
      {"rpe " + pair + "--delta 1.5 --unit frames", "whole number"},
      {"rpe " + pair + "--delta 0", "--delta"},
      {"map --reference truth.txt --estimate walk.txt", "truth.txt"},
      {"coverage --estimate absent.lapis", "absent.lapis"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.text, HasSubstr(expected)) << arguments;
  }
}

TEST_F(CommandLine, MapIouAndCoverageOfMapFiles) {
  write_map("reference.lapis", 8, 0.25, "floor");
  write_map("estimate.lapis", 4, 0.25, "floor");
  const std::string pair = " --reference reference.lapis --estimate estimate.lapis --json";
  const Outcome map = run("map" + pair);
  ASSERT_EQ(map.status, 0) << map.text;
  EXPECT_EQ(json::parse(map.text)["map_error_mean_m"], 0.0);
  EXPECT_NEAR(json::parse(map.text)["map_completeness_mean_m"].get<double>(), 0.25 * (1 + 2 + 3 + 4) / 8, 1e-12);
  EXPECT_EQ(json::parse(map.text)["overlap"][0]["recall"], 0.5);
  const Outcome iou = run("iou" + pair);
  ASSERT_EQ(iou.status, 0) << iou.text;
  EXPECT_EQ(json::parse(iou.text)["classes"][0]["class"], "wall");
  EXPECT_EQ(json::parse(iou.text)["iou_mean"], 0.5);
  const Outcome volume = run("coverage" + pair);
  ASSERT_EQ(volume.status, 0) << volume.text;
  EXPECT_NEAR(json::parse(volume.text)["explored_volume_m3"].get<double>(), 8 * 0.25 * 0.25 * 0.25, 1e-12);
  EXPECT_EQ(json::parse(volume.text)["explored_share"], 0.5);
  EXPECT_THAT(run("coverage --estimate estimate.lapis").text, HasSubstr("explored_share              -"));
  EXPECT_THAT(run("iou --reference reference.lapis --estimate estimate.lapis").text, HasSubstr("wall"));
}

TEST_F(CommandLine, MapsThatDoNotCompareAreRefused) {
  write_map("a.lapis", 3, 0.25, "floor");
  write_map("b.lapis", 3, 0.1, "floor");
  write_map("c.lapis", 3, 0.25, "door");
  const Outcome grid = run("map --reference a.lapis --estimate b.lapis");
  EXPECT_EQ(grid.status, 2);
  EXPECT_THAT(grid.text, HasSubstr("one resolution"));
  const Outcome classes = run("iou --reference a.lapis --estimate c.lapis");
  EXPECT_EQ(classes.status, 2);
  EXPECT_THAT(classes.text, HasSubstr("class 2 is 'floor' in a.lapis and 'door' in c.lapis"));
}

}  // namespace
}  // namespace lapis::evaluator
