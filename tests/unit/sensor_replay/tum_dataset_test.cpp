#include "sensor_replay/core/tum_dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sensor_replay/camera_yaml.hpp"
#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::error_of;
using test::kHeight;
using test::kWidth;
using test::write_text;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 6;

class Dataset : public testing::Test {
 protected:
  Dataset() { test::write_dataset(path(), kFrames); }

  const fs::path& path() const { return folder_.path(); }
  TumDataset open() const { return TumDataset({.folder = path(), .class_list = {}}, read_camera_file); }
  std::string open_error() const {
    return error_of([&] { open(); });
  }
  ReplayFrame frame(std::size_t index) const { return std::get<ReplayFrame>(open().load_frame(index)); }

  test::TemporaryFolder folder_;
};

TEST_F(Dataset, FramesAreWhatTheFilesHold) {
  const TumDataset dataset = open();
  ASSERT_EQ(dataset.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(dataset.duration(), time::Duration::from_seconds(0.5));
  EXPECT_TRUE(dataset.has_labels());
  EXPECT_TRUE(dataset.has_ground_truth());
  for (int i = 0; i < kFrames; ++i) {
    const auto loaded = std::get<ReplayFrame>(dataset.load_frame(static_cast<std::size_t>(i)));
    EXPECT_EQ(loaded.index, static_cast<std::size_t>(i));
    EXPECT_EQ(loaded.stamp.nanoseconds, i * 100'000'000);
    EXPECT_TRUE(loaded.problems.empty());
    EXPECT_EQ(loaded.color(3, 5), test::synthetic_color(i, 3, 5));
    EXPECT_EQ((*loaded.depth)(3, 5), test::synthetic_depth(i, 3, 5));
    EXPECT_EQ((*loaded.label)(3, 5), test::synthetic_label(i, 3, 5));
    EXPECT_NEAR(loaded.T_world_camera->translation().x(), 0.1 * i, 1e-12);
  }
}

TEST_F(Dataset, AssociationsDecideWhichFramesThereAre) {
  write_text(path() / "associations.txt",
             "0.1 rgb/00001.png 0.1 depth/00002.png\n0.3 rgb/00003.png 0.3 depth/00003.png\n");
  EXPECT_EQ(open().size(), 2u);
  EXPECT_EQ((*frame(0).depth)(0, 0), test::synthetic_depth(2, 0, 0));
}

TEST_F(Dataset, DepthIsPairedByNearestStamp) {
  write_text(path() / "depth.txt", "0.019 depth/00000.png\n0.121 depth/00001.png\n0.195 depth/00002.png\n");
  EXPECT_EQ(open().frames_without_depth(), 4u);
  EXPECT_TRUE(frame(0).depth);
  EXPECT_FALSE(frame(1).depth) << "21 ms apart";
  EXPECT_EQ(frame(1).problems.at(0).fault, ImageFault::kNotListed);
  EXPECT_TRUE(frame(2).depth);
}

TEST_F(Dataset, GroundTruthIsOptionalAndNeverMadeUp) {
  write_text(path() / "groundtruth.txt", "0.09 1 0 0 0 0 0 1\n0.11 3 0 0 0 0 0 1\n0.25 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(open().ground_truth(0));
  EXPECT_NEAR(open().ground_truth(1)->translation().x(), 2.0, 1e-9);
  EXPECT_FALSE(open().ground_truth(2)) << "50 ms from the nearest pose";
  fs::remove(path() / "groundtruth.txt");
  EXPECT_FALSE(open().has_ground_truth());
  EXPECT_FALSE(frame(1).T_world_camera);
}

TEST_F(Dataset, ClassesComeFromTheListOrFromTheImages) {
  EXPECT_THAT(open().classes(), ElementsAre(ClassName{1, "class_1"}, ClassName{2, "class_2"}, ClassName{3, "class_3"}));
  write_text(path() / "classes.csv", "class_id,class\n1,wall\n9,chair\n");
  EXPECT_THAT(open().classes(), ElementsAre(ClassName{1, "wall"}, ClassName{9, "chair"}));
  write_text(path() / "mine.csv", "class_id,class\n4,mine\n");
  const TumDataset dataset({.folder = path(), .class_list = path() / "mine.csv"}, read_camera_file);
  EXPECT_THAT(dataset.classes(), ElementsAre(ClassName{4, "mine"}));
  fs::remove_all(path() / "label");
  EXPECT_TRUE(open().classes().empty());
  EXPECT_FALSE(open().has_labels());
  EXPECT_FALSE(frame(0).label);
  EXPECT_TRUE(frame(0).problems.empty()) << "no labels at all is no problem of a frame";
}

// ---- wrong set-up: one line that names the file
// ----------------------------------------------------------------------

TEST_F(Dataset, MissingFolderOrFilesAreNamed) {
  EXPECT_THAT(error_of([&] { TumDataset({.folder = path() / "nowhere", .class_list = {}}, read_camera_file); }),
              HasSubstr((path() / "nowhere").string() + ": no such folder"));
  fs::remove(path() / "camera.yaml");
  EXPECT_THAT(open_error(), testing::AllOf(HasSubstr((path() / "camera.yaml").string()), HasSubstr("{width: 640")));
  fs::remove(path() / "depth.txt");
  EXPECT_THAT(open_error(), HasSubstr((path() / "depth.txt").string() + ": not found"));
  fs::remove(path() / "rgb.txt");
  EXPECT_THAT(open_error(), HasSubstr((path() / "rgb.txt").string() + ": not found"));
}

TEST_F(Dataset, EmptyDataSetsAreRefused) {
  write_text(path() / "depth.txt", "# nothing\n");
  EXPECT_THAT(open_error(), HasSubstr((path() / "depth.txt").string() + ": lists no image"));
  write_text(path() / "rgb.txt", "");
  EXPECT_THAT(open_error(), HasSubstr((path() / "rgb.txt").string() + ": lists no image"));
  write_text(path() / "associations.txt", "# nothing\n");
  EXPECT_THAT(open_error(), HasSubstr((path() / "associations.txt").string() + ": lists no frame"));
}

TEST_F(Dataset, ErrorsInEveryListNameFileAndLine) {
  const std::string good = test::read_text(path() / "rgb.txt");
  write_text(path() / "rgb.txt", good + "0.0 rgb/00000.png\n");
  EXPECT_THAT(open_error(), HasSubstr((path() / "rgb.txt").string() + ":9: time stamps are not sorted"));
  write_text(path() / "rgb.txt", good);
  write_text(path() / "depth.txt", "0.1 depth/00000.png\n0.1 depth/00001.png\n");
  EXPECT_THAT(open_error(), HasSubstr((path() / "depth.txt").string() + ":2: time stamp 0.100000000 occurs twice"));
  write_text(path() / "depth.txt", "0.1 depth/00000.png\n");
  write_text(path() / "groundtruth.txt", "0.1 0 0 zero 0 0 0 1\n");
  EXPECT_THAT(open_error(), HasSubstr((path() / "groundtruth.txt").string() + ":1: 'zero' is not"));
}

TEST_F(Dataset, ListsOnDifferentClocksAreRefused) {
  write_text(path() / "depth.txt", "1000.0 depth/00000.png\n1000.1 depth/00001.png\n");
  EXPECT_THAT(open_error(), testing::AllOf(HasSubstr("depth.txt"), HasSubstr("same clock")));
}

TEST_F(Dataset, AllImagesOfAKindMissingIsAWrongFolder) {
  fs::rename(path() / "label/00000.png", path() / "label/other.png");
  for (int i = 1; i < kFrames; ++i) fs::remove(path() / "label" / ("0000" + std::to_string(i) + ".png"));
  EXPECT_THAT(open_error(), HasSubstr((path() / "label/00000.png").string() + ": missing"));
  fs::remove_all(path() / "depth");
  EXPECT_THAT(open_error(), HasSubstr((path() / "depth/00000.png").string() + ": missing"));
  fs::remove_all(path() / "rgb");
  EXPECT_THAT(open_error(), HasSubstr((path() / "rgb/00000.png").string() + ": missing"));
}

TEST_F(Dataset, CameraFileThatDisagreesWithTheImagesIsRefused) {
  std::string text = test::kCameraFile;
  write_text(path() / "camera.yaml", text.replace(text.find("32"), 2, "64"));
  EXPECT_THAT(open_error(),
              testing::AllOf(HasSubstr((path() / "camera.yaml").string()), HasSubstr("64x24"), HasSubstr("32x24")));
}

TEST_F(Dataset, ToleranceIsChecked) {
  EXPECT_THAT(error_of([&] {
                TumDataset({path(), {}, -0.1}, read_camera_file);
              }),
              HasSubstr("max_stamp_difference_s: must be from 0"));
}

// ---- bad data: a value with a reason, the replay continues
// -------------------------------------------------------------

TEST_F(Dataset, FrameWithoutUsableColourIsSkippedWithAReason) {
  fs::remove(path() / "rgb/00001.png");
  test::truncate(path() / "rgb/00002.png", 0.5);
  test::write_rgb8(path() / "rgb/00003.png", kWidth + 1, kHeight);
  test::write_gray8(path() / "rgb/00004.png", kWidth, kHeight, 9);
  const TumDataset dataset = open();
  const ImageFault expected[] = {ImageFault::kMissing, ImageFault::kUndecodable, ImageFault::kWrongSize,
                                 ImageFault::kWrongPixelType};
  for (std::size_t i = 1; i <= 4; ++i) {
    const auto skipped = std::get<SkippedFrame>(dataset.load_frame(i));
    EXPECT_EQ(skipped.index, i);
    EXPECT_EQ(skipped.stamp, dataset.stamp(i));
    EXPECT_EQ(skipped.problem.part, ImagePart::kColor);
    EXPECT_EQ(skipped.problem.fault, expected[i - 1]);
    EXPECT_EQ(skipped.problem.file, "rgb/0000" + std::to_string(i) + ".png");
  }
  EXPECT_TRUE(std::holds_alternative<ReplayFrame>(dataset.load_frame(5)));
}

TEST_F(Dataset, FrameWithoutUsableDepthIsColourAlone) {
  fs::remove(path() / "depth/00001.png");
  test::truncate(path() / "depth/00002.png", 0.5);
  test::write_gray16(path() / "depth/00003.png", DepthMillimetres(kWidth, kHeight + 1));
  test::write_gray8(path() / "depth/00004.png", kWidth, kHeight, 9);
  const ImageFault expected[] = {ImageFault::kMissing, ImageFault::kUndecodable, ImageFault::kWrongSize,
                                 ImageFault::kWrongPixelType};
  for (std::size_t i = 1; i <= 4; ++i) {
    const ReplayFrame loaded = frame(i);
    EXPECT_FALSE(loaded.color.empty());
    EXPECT_FALSE(loaded.depth);
    EXPECT_TRUE(loaded.label);
    ASSERT_EQ(loaded.problems.size(), 1u);
    EXPECT_EQ(loaded.problems[0].part, ImagePart::kDepth);
    EXPECT_EQ(loaded.problems[0].fault, expected[i - 1]);
    EXPECT_THAT(to_string(loaded.problems[0]), HasSubstr("depth/0000" + std::to_string(i) + ".png: "));
  }
}

TEST_F(Dataset, FrameWithoutUsableLabelIsAFrameWithoutLabel) {
  fs::remove(path() / "label/00001.png");
  test::write_rgb8(path() / "label/00002.png", kWidth, kHeight);
  for (std::size_t i = 1; i <= 2; ++i) {
    const ReplayFrame loaded = frame(i);
    EXPECT_TRUE(loaded.depth);
    EXPECT_FALSE(loaded.label);
    ASSERT_EQ(loaded.problems.size(), 1u);
    EXPECT_EQ(loaded.problems[0].part, ImagePart::kLabel);
  }
  EXPECT_EQ(frame(1).problems[0].fault, ImageFault::kMissing);
  EXPECT_EQ(frame(2).problems[0].fault, ImageFault::kWrongPixelType);
}

TEST_F(Dataset, MissingImagesAreListedAtOpening) {
  fs::remove(path() / "rgb/00002.png");
  fs::remove(path() / "label/00004.png");
  const auto missing = open().missing_images();
  ASSERT_EQ(missing.size(), 2u);
  EXPECT_EQ(to_string(missing[0]), "colour rgb/00002.png: file missing");
  EXPECT_EQ(to_string(missing[1]), "label label/00004.png: file missing");
}

// ---- part of a data set
// ------------------------------------------------------------------------------------------------

TEST_F(Dataset, SelectsByTime) {
  const auto seconds = [](double s) { return time::Duration::from_seconds(s); };
  const TumDataset dataset = open();
  const auto range = [&](double start, std::optional<time::Duration> duration) {
    const FrameRange r = dataset.select(seconds(start), duration);
    return std::pair(r.begin, r.end);
  };
  EXPECT_EQ(range(0.0, std::nullopt), std::pair(std::size_t{0}, std::size_t{6}));
  EXPECT_EQ(range(0.15, std::nullopt), std::pair(std::size_t{2}, std::size_t{6}));
  EXPECT_EQ(range(0.1, seconds(0.2)), std::pair(std::size_t{1}, std::size_t{3})) << "the end is exclusive";
  EXPECT_EQ(range(0.0, seconds(99.0)), std::pair(std::size_t{0}, std::size_t{6}));
  EXPECT_THAT(error_of([&] { range(0.6, std::nullopt); }), HasSubstr("lasts 0.5"));
  EXPECT_THAT(error_of([&] { range(0.0, seconds(0.0)); }), HasSubstr("no frame in the selected time"));
}

}  // namespace
}  // namespace lapis::sensor_replay
