#include "common/mapping/votes/compact_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "common/files/zstd_codec.hpp"
#include "common/mapping/wire/frame_codec.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::mapping {
namespace {

const geometry::PinholeCamera kCamera{64, 36, 32, 32, 31.5, 17.5};

TEST(CompactFrame, KeepsSampledDepthInMillimetresAndLabels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> depth_m(0.0f, 70.0f);
  std::uniform_int_distribution<int> label(0, 65534);
  for (const int stride : {1, 2, 3, 5}) {
    geometry::DepthImage depth(kCamera.width, kCamera.height);
    geometry::LabelImage labels(kCamera.width, kCamera.height);
    for (float& d : depth.pixels) d = depth_m(random);
    for (std::uint16_t& l : labels.pixels) l = static_cast<std::uint16_t>(label(random));
    std::string error;
    const auto frame = CompactFrame::make(kCamera, depth, &labels, {stride, 65534}, error);
    ASSERT_TRUE(frame) << error;
    ASSERT_EQ(frame->samples(), static_cast<std::size_t>(frame->columns() * frame->rows()));
    for (int row = 0; row < frame->rows(); ++row)
      for (int column = 0; column < frame->columns(); ++column) {
        const int position = row * frame->columns() + column;
        const auto i = static_cast<std::size_t>(position);
        const float true_m = depth(column * stride, row * stride);
        EXPECT_NEAR(frame->depth_mm()[i] * 1e-3f, std::min(true_m, 65.535f), 0.00051f);
        EXPECT_EQ(frame->labels()[i], labels(column * stride, row * stride));
      }
  }
}

TEST(CompactFrame, DepthThatIsNoMeasurementIsZero) {
  geometry::DepthImage depth(kCamera.width, kCamera.height);
  depth.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  depth.pixels[1] = std::numeric_limits<float>::infinity();
  depth.pixels[2] = -1.0f;
  depth.pixels[3] = 2.0f;
  std::string error;
  const auto frame = CompactFrame::make(kCamera, depth, nullptr, {1, 0}, error);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth_mm()[0], 0);
  EXPECT_EQ(frame->depth_mm()[1], 0);
  EXPECT_EQ(frame->depth_mm()[2], 0);
  EXPECT_EQ(frame->depth_mm()[3], 2000);
  EXPECT_TRUE(frame->labels().empty());
  EXPECT_DOUBLE_EQ(frame->median_depth_m(), 2.0);
}

TEST(CompactFrame, LabelsAboveTheListBecomeUnlabelledAndAreCounted) {
  const geometry::DepthImage depth(kCamera.width, kCamera.height, 1.0f);
  geometry::LabelImage labels(kCamera.width, kCamera.height, 40);
  labels.pixels[0] = 41;
  labels.pixels[5] = 65535;
  std::string error;
  const auto frame = CompactFrame::make(kCamera, depth, &labels, {1, 40}, error);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->labels_out_of_list(), 2u);
  EXPECT_EQ(frame->labels()[0], 0);
  EXPECT_EQ(frame->labels()[1], 40);
}

TEST(CompactFrame, KeepsTheSampledConfidenceOfLabels) {
  const geometry::DepthImage depth(kCamera.width, kCamera.height, 1.0f);
  const geometry::LabelImage labels(kCamera.width, kCamera.height, 3);
  geometry::ConfidenceImage confidence(kCamera.width, kCamera.height);
  for (std::size_t i = 0; i < confidence.pixels.size(); ++i) confidence.pixels[i] = static_cast<std::uint8_t>(i * 7);
  std::string error;
  const auto frame = CompactFrame::make(kCamera, depth, &labels, {5, 40}, error, &confidence);
  ASSERT_TRUE(frame) << error;
  for (int row = 0; row < frame->rows(); ++row)
    for (int column = 0; column < frame->columns(); ++column) {
      const int sample = row * frame->columns() + column;
      EXPECT_EQ(frame->confidence()[static_cast<std::size_t>(sample)], confidence(column * 5, row * 5));
    }
  EXPECT_TRUE(CompactFrame::make(kCamera, depth, nullptr, {5, 40}, error, &confidence)->confidence().empty());
}

TEST(CompactFrame, LabelsThatComeLaterAreThoseOfAFrameThatHadThemAtOnce) {
  std::mt19937 random(2);
  geometry::DepthImage depth(kCamera.width, kCamera.height);
  geometry::LabelImage labels(kCamera.width, kCamera.height);
  geometry::ConfidenceImage confidence(kCamera.width, kCamera.height);
  for (float& d : depth.pixels) d = static_cast<float>(random() % 9000) * 1e-3f;
  for (std::uint16_t& l : labels.pixels) l = static_cast<std::uint16_t>(random() % 50);
  for (std::uint8_t& c : confidence.pixels) c = static_cast<std::uint8_t>(random() % 256);
  std::string error;
  for (const auto* given : {static_cast<const geometry::ConfidenceImage*>(nullptr),
                            static_cast<const geometry::ConfidenceImage*>(&confidence)}) {
    const auto at_once = CompactFrame::make(kCamera, depth, &labels, {3, 40}, error, given).value();
    auto later = CompactFrame::make(kCamera, depth, nullptr, {3, 40}, error).value();
    EXPECT_EQ(later.set_labels(labels, given, 40), "");
    EXPECT_EQ(pack(later), pack(at_once));
    EXPECT_EQ(later.labels_out_of_list(), at_once.labels_out_of_list());
  }
  auto frame = CompactFrame::make(kCamera, depth, nullptr, {}, error).value();
  EXPECT_NE(frame.set_labels(geometry::LabelImage(8, 8), nullptr, 40).find("label size"), std::string::npos);
  const geometry::ConfidenceImage small(8, 8);
  EXPECT_NE(frame.set_labels(labels, &small, 40).find("confidence size"), std::string::npos);
  EXPECT_FALSE(frame.has_labels());
}

TEST(CompactFrame, NamesWhatDisagrees) {
  const geometry::DepthImage depth(kCamera.width, kCamera.height, 1.0f), small(8, 8, 1.0f);
  const geometry::LabelImage small_labels(8, 8);
  std::string error;
  EXPECT_FALSE(CompactFrame::make(kCamera, small, nullptr, {}, error));
  EXPECT_NE(error.find("depth size"), std::string::npos);
  EXPECT_FALSE(CompactFrame::make(kCamera, depth, &small_labels, {}, error));
  EXPECT_NE(error.find("label size"), std::string::npos);
  const geometry::ConfidenceImage small_confidence(8, 8);
  EXPECT_FALSE(CompactFrame::make(kCamera, depth, nullptr, {}, error, &small_confidence));
  EXPECT_NE(error.find("confidence size"), std::string::npos);
  EXPECT_FALSE(CompactFrame::make(geometry::PinholeCamera{}, depth, nullptr, {}, error));
  EXPECT_NE(error.find("camera"), std::string::npos);
  EXPECT_FALSE(CompactFrame::make(kCamera, depth, nullptr, {0, 0}, error));
  EXPECT_NE(error.find("stride"), std::string::npos);
}

TEST(CompactFrame, MedianIsThatOfTheMeasuredDepths) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> mm(-500, 9000);
  geometry::DepthImage depth(kCamera.width, kCamera.height);
  for (float& d : depth.pixels) d = static_cast<float>(mm(random)) * 1e-3f;
  std::vector<float> measured = depth.pixels;
  std::erase_if(measured, [](float d) { return d <= 0.0f; });
  std::sort(measured.begin(), measured.end());
  std::string error;
  const auto frame = CompactFrame::make(kCamera, depth, nullptr, {1, 0}, error);
  EXPECT_NEAR(frame->median_depth_m(), measured[measured.size() / 2], 1e-6);
  const geometry::DepthImage nothing(kCamera.width, kCamera.height);
  EXPECT_EQ(CompactFrame::make(kCamera, nothing, nullptr, {1, 0}, error)->median_depth_m(), 0.0);
}

TEST(FrameCodec, UnpacksToTheSameFrame) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> depth_m(-1.0f, 70.0f);
  std::uniform_int_distribution<int> label(0, 65535);
  geometry::DepthImage depth(kCamera.width, kCamera.height);
  geometry::LabelImage labels(kCamera.width, kCamera.height);
  for (float& d : depth.pixels) d = depth_m(random);
  for (std::uint16_t& l : labels.pixels) l = static_cast<std::uint16_t>(label(random));
  geometry::ConfidenceImage confidence(kCamera.width, kCamera.height);
  for (std::uint8_t& c : confidence.pixels) c = static_cast<std::uint8_t>(label(random));
  for (const geometry::LabelImage* with_labels : {&labels, static_cast<geometry::LabelImage*>(nullptr)}) {
    std::string error;
    const auto frame = CompactFrame::make(kCamera, depth, with_labels, {3, 60000}, error, &confidence);
    ASSERT_TRUE(frame) << error;
    const CompactFrame again = *unpack_frame(pack(*frame));
    EXPECT_EQ(again.depth_mm(), frame->depth_mm());
    EXPECT_EQ(again.labels(), frame->labels());
    EXPECT_EQ(again.confidence(), frame->confidence());
    EXPECT_EQ(again.confidence().empty(), with_labels == nullptr);
    EXPECT_EQ(again.labels_out_of_list(), frame->labels_out_of_list());
    EXPECT_EQ(again.stride(), 3);
    EXPECT_EQ(again.camera().fx, kCamera.fx);
  }
}

TEST(FrameCodec, DamagedBytesGiveNothing) {
  std::string error;
  const auto frame = CompactFrame::make(kCamera, {kCamera.width, kCamera.height, 1.0f}, nullptr, {}, error);
  std::vector<std::uint8_t> bytes = pack(*frame);
  EXPECT_FALSE(unpack_votes(bytes));
  bytes.resize(bytes.size() / 2);
  EXPECT_FALSE(unpack_frame(bytes));
  EXPECT_FALSE(unpack_frame({}));
}

TEST(FrameCodec, AHeaderThatNoFrameHasGivesNothing) {
  std::string error;
  const auto frame = CompactFrame::make(kCamera, {kCamera.width, kCamera.height, 1.0f}, nullptr, {}, error);
  const auto plain = files::zstd_decompress(pack(*frame), 10000).value();
  const std::size_t samples = static_cast<std::size_t>(frame->columns()) * static_cast<std::size_t>(frame->rows());
  const std::size_t stride_at = plain.size() - 2 * samples - 8;  // two flags of 2 bytes follow the stride, then depth
  ASSERT_EQ(plain[stride_at], frame->stride());
  for (const std::uint8_t byte : {std::uint8_t{0x00}, std::uint8_t{0xff}, std::uint8_t{0x7f}}) {  // 0, -1, huge
    for (const std::size_t at : {stride_at, std::size_t{0}}) {  // the stride, the width of the camera
      auto spoilt = plain;
      std::fill_n(spoilt.begin() + static_cast<std::ptrdiff_t>(at), 4, byte);
      EXPECT_FALSE(unpack_frame(files::zstd_compress(spoilt, 1))) << int{byte} << " at " << at;
    }
  }
}

TEST(FrameCodec, TakesAFractionOfTheImagesMemory) {
  const geometry::PinholeCamera camera{640, 360, 320, 320, 319.5, 179.5};
  const auto image =
      lapis::test::render(lapis::test::furnished_room(), camera, lapis::test::look({-2, -1, 1}, 0.4, 0.1));
  std::string error;
  const auto frame = CompactFrame::make(camera, image.depth, &image.labels, {}, error);
  ASSERT_TRUE(frame);
  EXPECT_LT(pack(*frame).size(), 40'000u);  // images: 640 * 360 * 6 = 1,382,400
}

}  // namespace
}  // namespace lapis::mapping
