#include "evaluator/core/map/ground_truth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/mapping/file/map_file.hpp"

namespace lapis::evaluator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GroundTruthFolder : public ::testing::Test {
 protected:
  GroundTruthFolder() {
    std::filesystem::create_directories(folder);
    mapping::MapFile file{mapping::VoxelMap(0.25), {}, mapping::LabelList::from_names({{1, "wall"}}), {}};
    mapping::VoxelBlock block;
    block.add_hit(mapping::offset_in_block({3, 2, 1}), 1, 32 * mapping::kOneVote);
    block.add_miss(mapping::offset_in_block({4, 2, 1}), mapping::kOneVote);
    file.map.set_block({0, 0, 0}, block);
    EXPECT_FALSE(mapping::save_map((folder / "mesh.lapis").string(), file));
    write("classes.json", R"({"top_classes": [1, 7]})");
    write("rooms.json", R"({"T_map_world": [1, 2, 3, 0, 0, 1, 0]})");
  }
  ~GroundTruthFolder() override { std::filesystem::remove_all(folder); }
  void write(const char* name, const char* text) const { std::ofstream(folder / name) << text; }
  std::string problem_of_folder() const {
    std::string problem;
    EXPECT_FALSE(load_ground_truth(folder, problem));
    return problem;
  }

  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "lapis_ground_truth_test";
};

TEST_F(GroundTruthFolder, IsRead) {
  std::string problem;
  const auto truth = load_ground_truth(folder, problem);
  ASSERT_TRUE(truth) << problem;
  EXPECT_THAT(truth->mesh.occupied.voxels, ElementsAre(LabelledVoxel{{3, 2, 1}, 1}));
  EXPECT_THAT(truth->mesh.free, ElementsAre(VoxelIndex(4, 2, 1)));
  EXPECT_THAT(truth->top_classes, ElementsAre(1, 7));
  EXPECT_TRUE((truth->T_map_world * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 2, 3)));
}

TEST_F(GroundTruthFolder, WithoutAMeshIsNoTruthAndNoProblem) {
  std::filesystem::remove(folder / "mesh.lapis");
  EXPECT_EQ(problem_of_folder(), "");
}

TEST_F(GroundTruthFolder, DamageIsNamed) {
  write("rooms.json", R"({"T_map_world": [1, 2, 3]})");
  EXPECT_THAT(problem_of_folder(), HasSubstr(folder.string()));
  write("rooms.json", R"({"T_map_world": [1, 2, 3, 0, 0, 0, 0]})");
  EXPECT_THAT(problem_of_folder(), HasSubstr("T_map_world"));
  write("classes.json", "{");
  EXPECT_THAT(problem_of_folder(), HasSubstr(folder.string()));
  std::filesystem::remove(folder / "classes.json");
  EXPECT_THAT(problem_of_folder(), HasSubstr("classes.json"));
  write("mesh.lapis", "LAPISMAP");
  EXPECT_THAT(problem_of_folder(), HasSubstr("mesh.lapis"));
}

TEST(SameFrame, IsNoticedAtTheOriginOfTheMapHoweverFarTheWorld) {
  const auto pose = [](double x, double y, double yaw) {
    return geometry::make_pose({x, y, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())));
  };
  const geometry::Pose T_world_map = pose(500, 300, 1.0);  // where the run begins
  const auto with_start = [&](double x, double y, double yaw) {
    return is_same_frame(T_world_map.inverse(), (T_world_map * pose(x, y, yaw)).inverse());
  };
  EXPECT_TRUE(with_start(0, 0, 0));
  EXPECT_TRUE(with_start(0.007, 0.006, 0.0009));
  EXPECT_FALSE(with_start(0.011, 0, 0));
  EXPECT_FALSE(with_start(0, 0, 0.0011));
}

}  // namespace
}  // namespace lapis::evaluator
