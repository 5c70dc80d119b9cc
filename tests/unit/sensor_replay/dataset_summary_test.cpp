#include "sensor_replay/core/dataset_summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sensor_replay/camera_yaml.hpp"
#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using testing::ContainsRegex;

TEST(DatasetSummary, SaysWhatThereIs) {
  const test::TemporaryFolder folder;
  test::write_dataset(folder.path(), 6);
  const TumDataset dataset({.folder = folder.path(), .class_list = {}}, read_camera_file);
  EXPECT_NEAR(*path_length_m(dataset), 0.5, 1e-9);
  const std::string text = describe(dataset);
  EXPECT_THAT(text, ContainsRegex("frames +6\n"));
  EXPECT_THAT(text, ContainsRegex("duration +0.500 s"));
  EXPECT_THAT(text, ContainsRegex("camera +32x24"));
  EXPECT_THAT(text, ContainsRegex("depth +every frame\n"));
  EXPECT_THAT(text, ContainsRegex("labels +3 classes\n"));
  EXPECT_THAT(text, ContainsRegex("ground truth +6 frames, path 0.50 m\n"));
  EXPECT_THAT(text, Not(ContainsRegex("missing")));
}

TEST(DatasetSummary, SaysWhatThereIsNot) {
  const test::TemporaryFolder folder;
  test::write_dataset(folder.path(), 6);
  std::filesystem::remove(folder.path() / "groundtruth.txt");
  std::filesystem::remove(folder.path() / "rgb/00003.png");
  std::filesystem::remove_all(folder.path() / "label");
  test::write_text(folder.path() / "depth.txt", "0.0 depth/00000.png\n0.1 depth/00001.png\n");
  const TumDataset dataset({.folder = folder.path(), .class_list = {}}, read_camera_file);
  EXPECT_FALSE(path_length_m(dataset));
  const std::string text = describe(dataset);
  EXPECT_THAT(text, ContainsRegex("depth +2 frames; 4 without\n"));
  EXPECT_THAT(text, ContainsRegex("labels +none\n"));
  EXPECT_THAT(text, ContainsRegex("ground truth +none\n"));
  EXPECT_THAT(text, ContainsRegex("missing +1 images, the first is rgb/00003.png\n"));
}

}  // namespace
}  // namespace lapis::sensor_replay
