#include "semantic_mapper/file_tools.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::LabelList;
using mapping::MapFile;
using ::testing::HasSubstr;

class FileTools : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string save(const std::string& name, mapping::VoxelMap map, int frames = 10) const {
    const MapFile file{std::move(map),
                       {},
                       LabelList::from_names({{1, "wall"}, {7, "chair"}}),
                       {{"frames", std::to_string(frames)}, {"session", "5"}}};
    EXPECT_EQ(mapping::save_map(path(name), file), std::nullopt);
    return path(name);
  }
  int run(const std::vector<std::string>& words) {
    std::vector<const char*> argv{"lapis_semantic_mapper"};
    for (const std::string& word : words) argv.push_back(word.c_str());
    out_.str("");
    err_.str("");
    return runtime::run_file_tool(kFileTools, static_cast<int>(argv.size()), argv.data(), out_, err_);
  }
  nlohmann::json info(const std::string& file) {
    EXPECT_EQ(run({"info", file, "--json"}), 0) << err_.str();
    return nlohmann::json::parse(out_.str());
  }
  MapFile load(const std::string& file) const {
    std::string error;
    auto map = mapping::load_map(file, error);
    EXPECT_TRUE(map) << error;
    return map.value();
  }

  test::TemporaryFolder folder_;
  std::ostringstream out_, err_;
};

TEST_F(FileTools, AreKnownByTheirName) {
  for (const char* name : {"convert", "info", "merge"}) EXPECT_TRUE(runtime::is_file_tool(kFileTools, name));
  EXPECT_FALSE(runtime::is_file_tool(kFileTools, "--config"));
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("merge"));
}

TEST_F(FileTools, InfoCountsWhatTheMapHolds) {
  mapping::VoxelMap map(0.25);
  mapping::VoxelBlock block;
  block.add_hit(mapping::offset_in_block({1, 2, 3}), 7, 5 * mapping::kOneVote);
  block.add_hit(mapping::offset_in_block({1, 2, 4}), 1, 3 * mapping::kOneVote);
  block.add_hit(mapping::offset_in_block({1, 2, 4}), 7, mapping::kOneVote / 2);
  block.add_miss(mapping::offset_in_block({4, 2, 3}), mapping::kOneVote);
  map.set_block({0, 0, 0}, block);
  const std::string file = save("map.lapis", map);
  const auto result = info(file);
  EXPECT_EQ(result["file"], file);
  EXPECT_EQ(result["resolution_m"], 0.25);
  EXPECT_EQ(result["blocks"], 1);
  EXPECT_EQ(result["occupied_voxels"], 2);
  EXPECT_EQ(result["free_voxels"], 1);
  EXPECT_EQ(result["unknown_voxels_in_blocks"], 509);
  EXPECT_EQ(result["occupied_volume_m3"], 2 / 64.0);
  EXPECT_EQ(result["extent_min_m"], nlohmann::json({{"x", 0.25}, {"y", 0.5}, {"z", 0.75}}));
  EXPECT_EQ(result["extent_max_m"], nlohmann::json({{"x", 1.25}, {"y", 0.75}, {"z", 1.25}}));
  EXPECT_EQ(result["provenance"]["frames"], "10");
  ASSERT_EQ(result["classes"].size(), 2u);
  EXPECT_EQ(result["classes"][0],
            nlohmann::json({{"id", 1}, {"class", "wall"}, {"occupied_voxels", 1}, {"votes", 3.0}}));
  EXPECT_EQ(result["classes"][1],
            nlohmann::json({{"id", 7}, {"class", "chair"}, {"occupied_voxels", 1}, {"votes", 5.5}}));
  ASSERT_EQ(run({"info", file}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("chair"));
}

TEST_F(FileTools, InfoSaysHowTheMapIsReadAndWasMade) {
  mapping::MapFile file{mapping::VoxelMap(0.1), {}, {}, {}};
  file.sensor_model.prior_occupied = 0.1;
  ASSERT_EQ(mapping::save_map(path("unknown.lapis"), file), std::nullopt);
  EXPECT_EQ(info(path("unknown.lapis"))["frame_settings"], nullptr);
  file.frames.emplace().stride = 3;
  ASSERT_EQ(mapping::save_map(path("map.lapis"), file), std::nullopt);
  const auto result = info(path("map.lapis"));
  EXPECT_EQ(result["sensor_model"]["prior_occupied"], 0.1);
  EXPECT_EQ(result["sensor_model"]["class_count"], 40);
  EXPECT_EQ(result["frame_settings"]["stride"], 3);
  EXPECT_EQ(result["frame_settings"]["max_range_m"], 5.0);
}

TEST_F(FileTools, ConvertedOctreesHaveTheVoxelsOfTheMap) {
  const std::string map = save("map.lapis", mapping::test::random_map(1));
  const auto expected = info(map);
  for (const char* name : {"map.ot", "map.bt"}) {
    ASSERT_EQ(run({"convert", map, path(name)}), 0) << err_.str();
    const auto result = info(path(name));
    EXPECT_EQ(result["occupied_leaves"], expected["occupied_voxels"]);
    EXPECT_EQ(result["free_leaves"], expected["free_voxels"]);
    EXPECT_EQ(result["extent_min_m"], expected["extent_min_m"]);
    EXPECT_EQ(result["extent_max_m"], expected["extent_max_m"]);
    ASSERT_EQ(run({"convert", path(name), path(std::string(name) + ".ply")}), 0) << err_.str();
  }
  ASSERT_EQ(run({"convert", map, path("map.ply")}), 0) << err_.str();
  for (const char* name : {"map.ply", "map.ot.ply", "map.bt.ply"}) {
    std::ifstream ply(path(name));
    const std::string text{std::istreambuf_iterator<char>(ply), {}};
    EXPECT_THAT(text, HasSubstr("element vertex " + expected["occupied_voxels"].dump() + "\n")) << name;
  }
}

TEST_F(FileTools, MergeIsTheJointMap) {
  std::mt19937 random(4);
  mapping::VoxelMap a(0.1), b(0.1), joint(0.1);
  for (int i = 0; i < 10; ++i) {
    const auto votes = mapping::test::random_votes(random);
    (i % 2 ? a : b).add(votes);
    joint.add(votes);
  }
  const std::string first = save("a.lapis", a, 5), second = save("b.lapis", b, 5);
  ASSERT_EQ(run({"merge", first, second, "--out", path("both.lapis")}), 0) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("b.lapis: added voxel by voxel"));
  const MapFile both = load(path("both.lapis"));
  EXPECT_EQ(both.map, joint);
  EXPECT_EQ(both.provenance.at("frames"), "10");
  EXPECT_THAT(both.provenance.at("merged_from"), HasSubstr("b.lapis"));
}

TEST_F(FileTools, MergeMovesTheOthersByTheirTransform) {
  const mapping::VoxelMap map = mapping::test::random_map(1);
  const std::string empty = save("empty.lapis", mapping::VoxelMap(0.1)), file = save("map.lapis", map);
  ASSERT_EQ(run({"merge", empty, file, "--transform", "-1.5,2,0.1,0,0,90", "--out", path("turned.lapis")}), 0)
      << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("added voxel by voxel"));
  const mapping::VoxelMap turned = load(path("turned.lapis")).map;
  map.for_each_observed([&](const mapping::VoxelIndex& v, const mapping::VoxelCounts& counts) {
    ASSERT_EQ(turned.read({-v.y - 1 - 15, v.x + 20, v.z + 1}), counts);
  });
  ASSERT_EQ(run({"merge", empty, file, file, "--transform", "0,0,0,0,0,0", "--transform", "0,0,0,0,0,1", "--out",
                 path("twice.lapis")}),
            0)
      << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("resampled"));
}

TEST_F(FileTools, BadInputIsStatus2WithFileAndRemedy) {
  const std::string map = save("map.lapis", mapping::test::random_map(1)),
                    coarse = save("c.lapis", mapping::VoxelMap(0.2));
  std::ofstream(path("text.bt")) << "no tree";
  ASSERT_EQ(run({"convert", map, path("map.bt")}), 0);
  struct Case {
    std::vector<std::string> words;
    std::string reason;
  };
  const std::vector<Case> cases{
      {{"info", path("absent.lapis")}, "absent.lapis: cannot be opened"},
      {{"info", path("text.bt")}, "text.bt: is not an OctoMap file"},
      {{"info", "map.pcd"}, "map.pcd: cannot be read as a map; expected .lapis, .ot or .bt"},
      {{"convert", map, path("map.stl")}, "map.stl: cannot be written; expected .ot, .bt or .ply"},
      {{"convert", path("map.bt"), path("new.lapis")}, "expected .ply, or a .lapis file to convert"},
      {{"convert", map, "/nowhere/map.ot"}, "/nowhere/map.ot"},
      {{"merge", map, "--out", path("m.lapis")}, "files"},
      {{"merge", map, coarse, "--out", path("m.lapis")}, "c.lapis: voxels of 0.2"},
      {{"merge", map, map, "--out", path("m.ot")}, "m.ot: a merged map is a .lapis file"},
      {{"merge", map, map, "--transform", "1,2,3", "--out", path("m.lapis")}, "expected X,Y,Z,ROLL,PITCH,YAW"},
      {{"merge", map, map, "--transform", "1e9,0,0,0,0,0", "--out", path("m.lapis")}, "at most 10 km"},
      {{"merge", map, map, map, "--transform", "0,0,0,0,0,0", "--out", path("m.lapis")}, "one --transform for each"},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(run(c.words), 2) << c.reason;
    EXPECT_THAT(err_.str(), HasSubstr(c.reason));
  }
  EXPECT_FALSE(std::filesystem::exists(path("m.lapis")));
}

TEST_F(FileTools, InfoMeetsTheCountsOfLiboctomapForPublicTrees) {
  const auto folder = test::find_test_data("octomap");
  if (!folder) GTEST_SKIP() << test::missing_test_data("octomap");
  const auto corridor = info((*folder / "geb079.bt").string());
  EXPECT_EQ(corridor["resolution_m"], 0.08);
  EXPECT_EQ(corridor["nodes"], 532566);
  EXPECT_EQ(corridor["leaves"], 428144);
  EXPECT_EQ(corridor["occupied_leaves"], 143729);
  EXPECT_EQ(corridor["free_leaves"], 284415);
  EXPECT_NEAR(corridor["occupied_volume_m3"], 95.0646, 1e-4);
  EXPECT_NEAR(corridor["free_volume_m3"], 486.7886, 1e-4);
  const double box[] = {-8, -7.52, -0.32, 30.96, 7.44, 2.8};
  int i = 0;
  for (const char* end : {"extent_min_m", "extent_max_m"})
    for (const char* axis : {"x", "y", "z"}) EXPECT_NEAR(corridor[end][axis], box[i++], 1e-9) << end << axis;
  const auto office = info((*folder / "slambook_dense_RGBD.bt").string());
  EXPECT_EQ(office["nodes"], 146768);
  EXPECT_EQ(office["leaves"], 118594);
  EXPECT_EQ(office["occupied_leaves"], 37811);
  EXPECT_EQ(office["free_leaves"], 80783);
  EXPECT_NEAR(office["occupied_volume_m3"], 5.6057, 1e-4);
  EXPECT_NEAR(office["free_volume_m3"], 38.5572, 1e-4);
}

}  // namespace
}  // namespace lapis::semantic_mapper
