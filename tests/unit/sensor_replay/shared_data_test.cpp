// Recorded sequences of the shared test data; found through the environment variable LAPIS_TEST_DATA.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "sensor_replay/camera_yaml.hpp"
#include "sensor_replay/core/dataset_summary.hpp"
#include "sensor_replay/core/tum_dataset.hpp"
#include "tests/support/test_data.hpp"

namespace lapis::sensor_replay {
namespace {

class SharedData : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = lapis::test::find_test_data("rgbd");
    if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("rgbd");
    folder_ = *folder;
  }
  TumDataset open(const char* name) const {
    return TumDataset({.folder = folder_ / name, .class_list = {}}, read_camera_file);
  }

  std::filesystem::path folder_;
};

void expect_every_frame_whole(const TumDataset& dataset) {
  for (std::size_t i = 0; i < dataset.size(); ++i) {
    const LoadedFrame loaded = dataset.load_frame(i);
    const auto* frame = std::get_if<ReplayFrame>(&loaded);
    ASSERT_TRUE(frame) << "frame " << i;
    EXPECT_TRUE(frame->problems.empty()) << "frame " << i;
    EXPECT_TRUE(frame->depth && frame->T_world_camera) << "frame " << i;
    EXPECT_EQ(frame->label.has_value(), dataset.has_labels());
  }
}

TEST_F(SharedData, RedwoodLivingRoom) {
  const TumDataset dataset = open("redwood_livingroom1");
  EXPECT_EQ(dataset.size(), 150u);
  EXPECT_EQ(dataset.camera().camera, (geometry::PinholeCamera{640, 480, 525.0, 525.0, 319.5, 239.5}));
  EXPECT_NEAR(*path_length_m(dataset), 2.49, 0.005);
  EXPECT_FALSE(dataset.has_labels());
  expect_every_frame_whole(dataset);
}

TEST_F(SharedData, AwsSmallHouse) {
  const TumDataset dataset = open("aws_small_house_loop");
  EXPECT_EQ(dataset.size(), 268u);
  EXPECT_NEAR(*path_length_m(dataset), 20.0, 0.05);
  EXPECT_TRUE(dataset.has_labels());
  expect_every_frame_whole(dataset);
  // The camera is level to the side and 8 degrees down, 1 m above the floor: its mount must put base_link on the floor.
  const geometry::Pose T_world_base = *dataset.ground_truth(100) * T_base_camera(dataset.camera().mount).inverse();
  EXPECT_NEAR(T_world_base.translation().z(), 0.0, 1e-3);
  EXPECT_NEAR((T_world_base.linear() * Eigen::Vector3d::UnitZ()).z(), 1.0, 1e-3) << "base_link stands upright";
}

}  // namespace
}  // namespace lapis::sensor_replay
