// lapis_segmenter alone, with a network that the test writes: its classes are colours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/messages/camera.hpp"
#include "common/messages/labels.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "tests/contract/common/driven.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/color_network.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using sensor_msgs::msg::Image;
using ::testing::HasSubstr;

constexpr const char* kSegmenter = "lapis_segmenter";
constexpr const char* kOpticalFrame = "head_optical_frame";
constexpr int kWidth = 64, kHeight = 48;
const std::vector<geometry::Rgb8> kColors = {{200, 30, 30}, {30, 190, 40}, {20, 40, 210}};

time::Time stamp(int index) { return {1'000'000'000 + index * 33'333'333LL}; }

/// Class of a pixel of image `index`: squares that move.
std::size_t class_at(int index, int column, int row) {
  return static_cast<std::size_t>((column + index) / 8 + row / 8) % kColors.size();
}

Image picture(int index) {
  geometry::ColorImage image(kWidth, kHeight);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) image(column, row) = kColors[class_at(index, column, row)];
  }
  return messages::to_image(image, "rgb8", messages::header(stamp(index), kOpticalFrame));
}

struct Setting {
  ColorNetwork network{.colors = kColors, .width = kWidth, .height = kHeight};
  std::vector<std::string> settings = {};
};

/// The segmenter with a camera that the test plays, and a reader of its labels.
class SegmenterContract : public ::testing::Test {
 protected:
  explicit SegmenterContract(const Setting& setting = {})
      : first_label_(setting.network.first_label),
        segmenter(kSegmenter, arguments(write_color_model(folder_.path(), setting.network), setting.settings)) {}
  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(segmenter)) << segmenter.log();
    ASSERT_TRUE(probe.wait_until([&] { return color.matched() > 0 || compressed.matched() > 0; })) << segmenter.log();
    ASSERT_TRUE(probe.wait_until_known_by("segmenter")) << segmenter.log();
  }
  static std::vector<std::string> arguments(const std::filesystem::path& model, const std::vector<std::string>& more) {
    std::vector<std::string> all = {model.string()};
    for (const auto& setting : more) all.insert(all.end(), {"--set", setting});
    return all;
  }
  bool wait_for_labels(std::size_t number) {
    return probe.wait_until([&] { return labels.size() >= number; });
  }
  void expect_labels_of(int index, const Image& message) const {
    EXPECT_EQ(messages::from_message(message.header().stamp()), stamp(index));
    EXPECT_EQ(message.header().frame_id(), kOpticalFrame);
    const auto image = messages::to_labels(message);
    ASSERT_TRUE(image) << image.reason;
    ASSERT_EQ(std::pair(image->width, image->height), std::pair(kWidth, kHeight));
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const std::size_t expected = static_cast<std::size_t>(first_label_) + class_at(index, column, row);
        ASSERT_EQ((*image)(column, row), expected) << column << ", " << row;
      }
    }
  }
  bool wait_for_count(const std::string& text, double number) {
    return probe.wait_until([&] { return sum_of(newest_values(diagnostics, "segmenter"), text) >= number; },
                            Seconds(5));
  }

  TemporaryFolder folder_;
  int first_label_;
  TopicProbe probe;
  dds::Publisher<Image>& color = probe.advertise(topics::kColor);
  dds::Publisher<sensor_msgs::msg::CompressedImage>& compressed = probe.advertise(topics::kCompressedColor);
  const std::vector<Image>& labels = probe.collect(topics::kLabels);
  std::vector<Image> confidence;
  dds::Source& confidence_source =
      probe.listen<Image>(topics::kLabelConfidence, [this](auto& m) { confidence.push_back(m); });
  const std::vector<vision_msgs::msg::LabelInfo>& label_info = probe.collect(topics::kLabelInfo);
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess segmenter;
};

TEST_F(SegmenterContract, LabelsHaveStampFrameAndSizeOfTheirImage) {
  for (int i = 0; i < 5; ++i) {
    color.publish(picture(i));
    ASSERT_TRUE(wait_for_labels(static_cast<std::size_t>(i) + 1)) << segmenter.log();
    EXPECT_EQ(labels.back().encoding(), "mono8");
    expect_labels_of(i, labels.back());
  }
  ASSERT_TRUE(probe.wait_until([&] { return confidence.size() == labels.size() && !label_info.empty(); }));
  EXPECT_EQ(confidence[4].header(), labels[4].header());
  const auto shares = messages::to_confidence(confidence[4]);
  ASSERT_TRUE(shares) << shares.reason;
  for (const auto share : shares->pixels) ASSERT_GT(share, 250);
  const auto list = messages::from_message(label_info[0]);
  ASSERT_TRUE(list) << list.reason;
  EXPECT_EQ(list->name(2), "color 1");
  EXPECT_TRUE(wait_for_count("frames", 5));
  EXPECT_GT(sum_of(newest_values(diagnostics, "segmenter"), "wall_ms"), 0.0);
  EXPECT_GT(sum_of(newest_values(diagnostics, "segmenter"), "cpu_ms"), 0.0);
  TopicProbe late("late");
  const auto& again = late.collect(topics::kLabelInfo);
  EXPECT_TRUE(late.wait_until([&] { return !again.empty(); }));
  EXPECT_EQ(segmenter.stop(SIGTERM), 0) << segmenter.log();
  EXPECT_THAT(segmenter.log(), HasSubstr("5 images labelled"));
}

TEST_F(SegmenterContract, ImagesThatCannotBeReadAreCountedAndTheNextOneIsLabelled) {
  const std::vector<std::pair<std::string, std::function<void(Image&)>>> faults = {
      {"encoding 'bayer_rggb8'", [](auto& m) { m.encoding("bayer_rggb8"); }},
      {"image is empty", [](auto& m) { m.width(0); }},
      {"larger than 16384", [](auto& m) { m.width(70'000); }},
      {"step x height", [](auto& m) { m.data().resize(100); }},
      {"rows are shorter", [](auto& m) { m.step(3); }}};
  int index = 0;
  for (const auto& [reason, spoil] : faults) {
    Image image = picture(index++);
    spoil(image);
    color.publish(image);
    EXPECT_TRUE(wait_for_count(reason, 1)) << reason << segmenter.log();
  }
  color.publish(picture(index));
  ASSERT_TRUE(wait_for_labels(1)) << segmenter.log();
  expect_labels_of(index, labels[0]);
  color.publish(picture(index));
  EXPECT_TRUE(wait_for_count("stamp was there before", 1));
  EXPECT_EQ(labels.size(), 1u);
}

class SegmenterCompressed : public SegmenterContract {
 protected:
  SegmenterCompressed() : SegmenterContract({.settings = {"dds.color_transport=compressed"}}) {}
};

TEST_F(SegmenterCompressed, PngIsLabelledAndADamagedOneIsCounted) {
  Image raw = picture(3);
  cv::Mat pixels(kHeight, kWidth, CV_8UC3, raw.data().data());
  cv::Mat bgr(kHeight, kWidth, CV_8UC3);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const auto& p = pixels.at<cv::Vec3b>(i / kWidth, i % kWidth);
    bgr.at<cv::Vec3b>(i / kWidth, i % kWidth) = {p[2], p[1], p[0]};
  }
  sensor_msgs::msg::CompressedImage message;
  message.header(raw.header());
  cv::imencode(".png", bgr, message.data());
  compressed.publish(message);
  ASSERT_TRUE(wait_for_labels(1)) << segmenter.log();
  expect_labels_of(3, labels[0]);
  message.header().stamp(messages::to_message(stamp(4)));
  message.data().resize(message.data().size() / 2);
  compressed.publish(message);
  EXPECT_TRUE(wait_for_count("compressed colour image is damaged", 1)) << segmenter.log();
}

class SegmenterOfLabels : public SegmenterContract {
 protected:
  SegmenterOfLabels()
      : SegmenterContract(
            {.network = {
                 .colors = kColors, .width = kWidth, .height = kHeight, .ending = "ArgMax", .first_label = 300}}) {}
};

TEST_F(SegmenterOfLabels, LargeIdsNeedMono16AndNobodyPublishesConfidence) {
  color.publish(picture(2));
  ASSERT_TRUE(wait_for_labels(1)) << segmenter.log();
  EXPECT_EQ(labels[0].encoding(), "mono16");
  expect_labels_of(2, labels[0]);
  EXPECT_EQ(confidence_source.matched(), 0u);
}

class SlowSegmenter : public SegmenterContract {
 protected:
  SlowSegmenter()
      : SegmenterContract({.network = {.colors = kColors, .width = 1280, .height = 960, .has_detour = true}}) {}
};

TEST_F(SlowSegmenter, TheNewestImageWinsAndOthersAreCounted) {
  constexpr int kBursts = 3, kBurst = 4;  // fewer at once than the topic keeps
  for (int i = 0; i < kBursts * kBurst; ++i) {
    color.publish(picture(i));
    if (i % kBurst < kBurst - 1) continue;
    ASSERT_TRUE(probe.wait_until([&] {
      return !labels.empty() && messages::from_message(labels.back().header().stamp()) == stamp(i);
    })) << segmenter.log();
    expect_labels_of(i, labels.back());
  }
  EXPECT_LT(labels.size(), static_cast<std::size_t>(kBursts * kBurst));
  EXPECT_TRUE(
      wait_for_count("colour replaced", static_cast<double>(kBursts * kBurst) - static_cast<double>(labels.size())));
}

TEST_F(SlowSegmenter, EndsCleanlyWhileTheNetworkWorks) {
  color.publish(picture(0));
  color.publish(picture(1));
  EXPECT_EQ(segmenter.stop(SIGINT), 0) << segmenter.log();
}

std::vector<Image> labels_in_lockstep(const std::filesystem::path& model, int ticks) {
  ChildProcess segmenter(kSegmenter, {model.string()});
  TopicProbe probe;
  const auto& labels = probe.collect(topics::kLabels);
  Driven run({{"segmenter"}, 5.0, 20.0, "abort"});
  run.accompany(probe);
  EXPECT_TRUE(run.wait_for(runtime::LockstepDriver::State::kIdle)) << segmenter.log();
  EXPECT_TRUE(probe.wait_until_known_by("segmenter")) << segmenter.log();
  for (int i = 0; i < ticks; ++i) {
    run.show(picture(i));
    EXPECT_TRUE(run.step()) << segmenter.log();
  }
  EXPECT_TRUE(probe.wait_until([&] { return labels.size() == static_cast<std::size_t>(ticks); })) << labels.size();
  return labels;
}

TEST(SegmenterInLockstep, LabelsEachImageWithTheSameBytesEachTime) {
  constexpr int kTicks = 12;
  TemporaryFolder folder;
  const auto model =
      write_color_model(folder.path(), {.colors = kColors, .width = 640, .height = 480, .has_detour = true});
  const auto labels = labels_in_lockstep(model, kTicks);
  ASSERT_EQ(labels.size(), static_cast<std::size_t>(kTicks));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_EQ(messages::from_message(labels[i].header().stamp()), Driven::stamp(i + 1));
  }
  EXPECT_EQ(labels_in_lockstep(model, kTicks), labels);
}

TEST(SegmenterSetUp, BadModelsAreStatus2AndNamed) {
  TemporaryFolder folder;
  const auto model = write_color_model(folder.path(), {.colors = kColors});
  const auto expect_refused = [](const std::vector<std::string>& arguments, const std::string& text) {
    ChildProcess segmenter(kSegmenter, arguments);
    EXPECT_EQ(segmenter.wait(), 2) << segmenter.log();
    EXPECT_THAT(segmenter.log(), HasSubstr(text));
  };
  expect_refused({}, "segmenter.model");
  expect_refused({"/no/such/model.yaml"}, "/no/such/model.yaml: not found");
  std::ofstream(model, std::ios::app) << "  3: color 0\n";
  expect_refused({model.string()}, "the network has 3 classes, from 0 on; classes names 3");
  write_color_model(folder.path(), {.colors = kColors, .ending = "NoSuchOperator"});
  expect_refused({model.string()}, "NoSuchOperator");
  std::filesystem::resize_file(folder.path() / "network.onnx", 100);
  expect_refused({model.string()}, "network.onnx: OpenCV");
  std::filesystem::remove(folder.path() / "network.onnx");
  expect_refused({model.string()}, (folder.path() / "network.onnx").string());
}

}  // namespace
}  // namespace lapis::test
