#include "simulator/core/truth/truth_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "box_world.hpp"
#include "common/mapping/file/map_file.hpp"
#include "evaluator/core/map/ground_truth.hpp"
#include "evaluator/core/map/map_input.hpp"

namespace lapis::simulator {
namespace {

using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class TruthFiles : public ::testing::Test {
 protected:
  TruthFiles() {
    test::add_box(scene, {2, 1, 0}, {2.5F, 1.5F, 0.8F}, 5);
    scene.rooms.push_back({"r1", "bedroom", {{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 2.5});
    write(folder);
  }
  ~TruthFiles() override { std::filesystem::remove_all(folder.parent_path()); }
  VoxelTruth write(const std::filesystem::path& where) const {
    const SceneRaycaster raycaster(scene.mesh);
    const NavMap nav_map = build_nav_map(scene);
    TruthConfig config;
    config.camera = {640, 360, 320.0, 320.0, 319.5, 179.5};
    config.mount = {1.0, 0.0};
    auto truth = make_voxel_truth(scene, raycaster, nav_map, start, config);
    write_scene_truth(where, scene, nav_map, start, truth);
    return truth;
  }

  Scene scene = test::room({4, 3, 2.5F});
  const geometry::Pose start = test::planar_pose(0.7, 0.9, 0.6);
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "lapis_truth_test" / "ground_truth";
};

TEST_F(TruthFiles, AreWhatTheEvaluatorReads) {
  const VoxelTruth truth = write(folder);
  std::string problem;
  const auto read = evaluator::load_ground_truth(folder, problem);
  ASSERT_TRUE(read) << problem;
  const auto expected = evaluator::to_known_space(truth.mesh, mapping::BeliefReader(mapping::SensorModel{}));
  EXPECT_EQ(read->mesh.occupied.voxels, expected.occupied.voxels);
  EXPECT_EQ(read->mesh.free, expected.free);
  ASSERT_TRUE(read->with_margin);
  EXPECT_EQ(read->with_margin->free,
            evaluator::to_known_space(truth.with_margin, mapping::BeliefReader(mapping::SensorModel{})).free);
  EXPECT_EQ(read->top_classes, (std::vector<std::uint16_t>{1, 5}));
  EXPECT_TRUE(read->T_map_world.isApprox(start.inverse(), 1e-12));
  const auto flood = mapping::load_map((folder / "flood.lapis").string(), problem);
  ASSERT_TRUE(flood) << problem;
  EXPECT_TRUE(flood->map == truth.flood);
  EXPECT_EQ(flood->labels, scene.labels);
}

TEST_F(TruthFiles, RoomsAndClassesAreThoseOfTheScene) {
  const auto rooms = nlohmann::json::parse(text_of(folder / "rooms.json"));
  const auto corner = rooms["rooms"][0]["polygon_map"][2];
  const Eigen::Vector3d expected = start.inverse() * Eigen::Vector3d(4, 3, 0);
  EXPECT_NEAR(corner[0], expected.x(), 1e-12);
  EXPECT_NEAR(corner[1], expected.y(), 1e-12);
  EXPECT_EQ(rooms["rooms"][0]["polygon_world"][2], nlohmann::json({4.0, 3.0}));
  EXPECT_EQ(rooms["rooms"][0]["type"], "bedroom");
  const auto classes = nlohmann::json::parse(text_of(folder / "classes.json"));
  EXPECT_EQ(classes["classes"].size(), 9U);
  EXPECT_EQ(classes["classes"][4]["name"], "class 5");
}

TEST_F(TruthFiles, NavigationMapIsThatOfAMapServer) {
  const cv::Mat picture = cv::imread((folder / "navmap.png").string(), cv::IMREAD_GRAYSCALE);
  const NavMap map = build_nav_map(scene);
  ASSERT_EQ(picture.cols, map.grid().width);
  ASSERT_EQ(picture.rows, map.grid().height);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const int value = picture.at<std::uint8_t>(picture.rows - 1 - row, column);
      ASSERT_EQ(value, map.is_blocked({column, row}) ? 0 : 255);
    }
  }
  const std::string yaml = text_of(folder / "navmap.yaml");
  EXPECT_THAT(yaml, HasSubstr("image: navmap.png\n"));
  EXPECT_THAT(yaml, HasSubstr("resolution: 0.025\n"));
  EXPECT_THAT(yaml, HasSubstr("origin: [-0.050000, -0.050000, 0.0]\n"));
}

TEST_F(TruthFiles, AreEqualBytesEveryTime) {
  const auto again = folder.parent_path() / "again";
  write(again);
  for (const char* name :
       {"mesh.lapis", "flood.lapis", "with_margin.lapis", "classes.json", "rooms.json", "navmap.png", "navmap.yaml"}) {
    EXPECT_FALSE(text_of(folder / name).empty()) << name;
    EXPECT_EQ(text_of(folder / name), text_of(again / name)) << name;
  }
}

TEST_F(TruthFiles, IdealMapIsAMapFile) {
  const mapping::FrameSettings frames{{.max_range_m = 4.0, .kernel_length_voxels = 2.0}, 3};
  IdealMap ideal(0.25, frames);
  const geometry::PinholeCamera camera{64, 36, 32.0, 32.0, 31.5, 17.5};
  ideal.add(camera, geometry::Pose::Identity(), geometry::DepthImage(64, 36, 2.0F), geometry::LabelImage(64, 36, 3));
  write_ideal_map(folder, scene, ideal);
  std::string problem;
  const auto file = mapping::load_map((folder / "ideal.lapis").string(), problem);
  ASSERT_TRUE(file) << problem;
  EXPECT_TRUE(file->map == ideal.map());
  EXPECT_EQ(file->frames, mapping::of_reference(frames));
  EXPECT_THROW(write_ideal_map("/proc/nowhere", scene, ideal), std::runtime_error);
}

TEST_F(TruthFiles, WhatIsMissingOrDamagedIsReported) {
  std::string problem;
  EXPECT_FALSE(evaluator::load_ground_truth(folder / "nowhere", problem));
  EXPECT_TRUE(problem.empty());
  std::filesystem::remove(folder / "rooms.json");
  EXPECT_FALSE(evaluator::load_ground_truth(folder, problem));
  EXPECT_THAT(problem, HasSubstr("rooms.json"));
  std::ofstream(folder / "mesh.lapis") << "LAPIS";
  EXPECT_FALSE(evaluator::load_ground_truth(folder, problem));
  EXPECT_THAT(problem, HasSubstr("mesh.lapis"));
}

}  // namespace
}  // namespace lapis::simulator
