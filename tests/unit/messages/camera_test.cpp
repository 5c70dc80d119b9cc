#include "common/messages/camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace lapis::messages {
namespace {

using sensor_msgs::msg::Image;
using ::testing::HasSubstr;

template <class Pixel>
Image image(const std::string& encoding, std::uint32_t width, std::uint32_t height, const std::vector<Pixel>& pixels,
            std::size_t channels = 1) {
  Image message;
  message.encoding(encoding);
  message.width(width);
  message.height(height);
  message.step(static_cast<std::uint32_t>(width * sizeof(Pixel) * channels));
  message.data().resize(pixels.size() * sizeof(Pixel));
  std::memcpy(message.data().data(), pixels.data(), message.data().size());
  return message;
}

Image depth_mm(const std::vector<std::uint16_t>& pixels) {
  return image("16UC1", static_cast<std::uint32_t>(pixels.size()), 1, pixels);
}

sensor_msgs::msg::CameraInfo camera_info() {
  sensor_msgs::msg::CameraInfo info;
  info.width(640);
  info.height(360);
  info.k({500.0, 0.0, 319.5, 0.0, 501.0, 179.5, 0.0, 0.0, 1.0});
  return info;
}

TEST(CameraInfo, GivesThePinholeModel) {
  const auto camera = lens_camera(camera_info());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->pinhole, (geometry::PinholeCamera{640, 360, 500.0, 501.0, 319.5, 179.5}));
}

TEST(CameraInfo, ZeroDistortionIsNone) {
  auto info = camera_info();
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(lens_camera(info));
  EXPECT_FALSE(lens_camera(info)->is_distorted());
  info.d({0.0, 0.1, 0.0, 0.0, 0.0});
  EXPECT_TRUE(lens_camera(info)->is_distorted());
}

TEST(CameraInfo, KeepsTheDistortionOfKnownModels) {
  auto info = camera_info();
  EXPECT_FALSE(lens_camera(info)->is_distorted());
  info.distortion_model("plumb_bob");
  info.d({0.1, -0.2, 0.001, -0.002});
  ASSERT_TRUE(lens_camera(info));
  EXPECT_EQ(lens_camera(info)->distortion, info.d());
  EXPECT_EQ(lens_camera(info)->pinhole, (geometry::PinholeCamera{640, 360, 500.0, 501.0, 319.5, 179.5}));
  info.distortion_model("rational_polynomial");
  info.d({0.5, -2.4, 0.001, -0.002, 1.4, 0.4, -2.2, 1.3});
  ASSERT_TRUE(lens_camera(info));
  EXPECT_EQ(lens_camera(info)->distortion, info.d());
}

TEST(CameraInfo, RefusesDistortionThatItCannotRead) {
  auto info = camera_info();
  info.d({0.1, 0.0, 0.0, 0.0});
  EXPECT_THAT(lens_camera(info).reason, HasSubstr("distortion model ''"));
  info.distortion_model("equidistant");  // zeros do not make a pinhole of a fisheye
  info.d({0.0, 0.0, 0.0, 0.0});
  EXPECT_THAT(lens_camera(info).reason, HasSubstr("distortion model 'equidistant'"));
  info.distortion_model(std::string(10'000, 'x'));
  EXPECT_LT(lens_camera(info).reason.size(), 200U);
  info.distortion_model("plumb_bob");
  info.d({0.1, 0.0, 0.0});
  EXPECT_THAT(lens_camera(info).reason, HasSubstr("4, 5 or 8 numbers"));
  info.d({0.1, 0.0, 0.0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THAT(lens_camera(info).reason, HasSubstr("not finite"));
}

TEST(CameraInfo, RefusesWhatIsNoCamera) {
  EXPECT_FALSE(lens_camera(sensor_msgs::msg::CameraInfo()));
  for (const double bad : {0.0, -500.0, std::numeric_limits<double>::quiet_NaN()}) {
    auto info = camera_info();
    info.k()[4] = bad;
    EXPECT_FALSE(lens_camera(info)) << bad;
  }
  auto info = camera_info();
  info.width(0);
  EXPECT_FALSE(lens_camera(info));
  info.width(4'000'000'000u);
  EXPECT_THAT(lens_camera(info).reason, HasSubstr("too large"));
}

TEST(Gray, LuminanceFollowsBt601) {
  const std::vector<std::uint8_t> pixels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 10, 200, 30};
  const auto rgb = to_gray(image("rgb8", 6, 1, pixels, 3));
  ASSERT_TRUE(rgb);
  for (std::size_t i = 0; i < 6; ++i) {
    const double exact = 0.299 * pixels[3 * i] + 0.587 * pixels[3 * i + 1] + 0.114 * pixels[3 * i + 2];
    EXPECT_NEAR(rgb->pixels[i], exact, 0.51) << i;
  }
  std::vector<std::uint8_t> swapped = pixels;
  for (std::size_t i = 0; i < 6; ++i) std::swap(swapped[3 * i], swapped[3 * i + 2]);
  EXPECT_EQ(to_gray(image("bgr8", 6, 1, swapped, 3))->pixels, rgb->pixels);
  std::vector<std::uint8_t> opaque;
  std::vector<std::uint8_t> swapped_opaque;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    opaque.push_back(pixels[i]);
    swapped_opaque.push_back(swapped[i]);
    if (i % 3 == 2) opaque.push_back(77);
    if (i % 3 == 2) swapped_opaque.push_back(77);
  }
  EXPECT_EQ(to_gray(image("rgba8", 6, 1, opaque, 4))->pixels, rgb->pixels);
  EXPECT_EQ(to_gray(image("bgra8", 6, 1, swapped_opaque, 4))->pixels, rgb->pixels);
  EXPECT_EQ(to_gray(image<std::uint8_t>("mono8", 3, 1, {0, 7, 255}))->pixels, (std::vector<std::uint8_t>{0, 7, 255}));
}

TEST(Gray, Yuv422HasLuminanceInEverySecondByte) {
  const std::vector<std::uint8_t> chroma_first = {90, 1, 91, 2, 92, 3, 93, 4};
  const std::vector<std::uint8_t> luminance_first = {1, 90, 2, 91, 3, 92, 4, 93};
  for (const char* encoding : {"yuv422", "uyvy"}) {
    EXPECT_EQ(to_gray(image(encoding, 4, 1, chroma_first, 2))->pixels, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  }
  for (const char* encoding : {"yuv422_yuy2", "yuyv"}) {
    EXPECT_EQ(to_gray(image(encoding, 4, 1, luminance_first, 2))->pixels, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  }
}

TEST(Gray, WideValuesUseTheWholeRangeWhateverPartTheCameraUses) {
  std::vector<std::uint16_t> values(200, 1000);
  values[0] = 0;
  values[1] = 500;
  values[2] = 60'000;  // 1 % glare does not count
  for (const char* encoding : {"mono16", "16UC1"}) {
    const auto gray = to_gray(image<std::uint16_t>(encoding, 20, 10, values));
    ASSERT_TRUE(gray);
    EXPECT_EQ(gray->pixels[0], 0);
    EXPECT_EQ(gray->pixels[1], 127);
    EXPECT_EQ(gray->pixels[2], 255);
    EXPECT_EQ(gray->pixels[3], 255);
  }
  EXPECT_EQ(to_gray(image<std::uint16_t>("mono16", 2, 1, {7, 20}))->pixels, (std::vector<std::uint8_t>{7, 20}))
      << "dark images are not stretched";
}

TEST(Color, ChannelsAreThoseOfTheEncoding) {
  using Bytes = std::vector<std::uint8_t>;
  const std::vector<geometry::Rgb8> expected = {{1, 2, 3}, {200, 100, 0}};
  const std::vector<std::pair<Image, std::vector<geometry::Rgb8>>> images = {
      {image("rgb8", 2, 1, Bytes{1, 2, 3, 200, 100, 0}, 3), expected},
      {image("bgr8", 2, 1, Bytes{3, 2, 1, 0, 100, 200}, 3), expected},
      {image("rgba8", 2, 1, Bytes{1, 2, 3, 9, 200, 100, 0, 9}, 4), expected},
      {image("bgra8", 2, 1, Bytes{3, 2, 1, 9, 0, 100, 200, 9}, 4), expected},
      {image("mono8", 2, 1, Bytes{7, 8}), {{7, 7, 7}, {8, 8, 8}}}};
  for (const auto& [message, pixels] : images) {
    const auto color = to_color(message);
    ASSERT_TRUE(color) << color.reason;
    EXPECT_EQ(color->pixels, pixels) << message.encoding();
  }
  EXPECT_THAT(to_color(image("32FC1", 1, 1, Bytes{0, 0, 0, 0})).reason, HasSubstr("colour encoding '32FC1'"));
  EXPECT_THAT(to_color(image("rgb8", 2, 1, Bytes{1, 2, 3}, 3)).reason, HasSubstr("step x height"));
}

TEST(Color, Yuv422IsThatOfBt601) {
  using Bytes = std::vector<std::uint8_t>;
  // White, black; pure red (81, 90, 240), twice.
  const std::vector<geometry::Rgb8> expected = {{255, 255, 255}, {0, 0, 0}, {254, 0, 0}, {254, 0, 0}};
  const auto is_near = [&](const Converted<geometry::ColorImage>& color) {
    ASSERT_TRUE(color) << color.reason;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(color->pixels[i].r, expected[i].r, 1) << i;
      EXPECT_NEAR(color->pixels[i].g, expected[i].g, 1) << i;
      EXPECT_NEAR(color->pixels[i].b, expected[i].b, 1) << i;
    }
  };
  is_near(to_color(image("yuv422", 4, 1, Bytes{128, 235, 128, 16, 90, 81, 240, 81}, 2)));
  is_near(to_color(image("yuv422_yuy2", 4, 1, Bytes{235, 128, 16, 128, 81, 90, 81, 240}, 2)));
  EXPECT_THAT(to_color(image("yuv422", 1, 1, Bytes{128, 235}, 2)).reason, HasSubstr("odd width"));
}

TEST(Color, ACompressedImageThatAnnouncesTooManyPixelsIsNotDecoded) {
  sensor_msgs::msg::CompressedImage message;
  message.data(
      {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0, 0, 0x20, 0, 0, 0, 0x10, 1});
  EXPECT_THAT(to_color(message).reason, HasSubstr("more than 2^25 pixels"));  // 8192 x 4097
  message.data()[22] = 0x0F;
  EXPECT_THAT(to_color(message).reason, HasSubstr("is damaged"));
  message.data({1, 2, 3});
  EXPECT_THAT(to_color(message).reason, HasSubstr("neither JPEG nor PNG"));
}

TEST(Gray, RowPaddingIsSkipped) {
  Image padded = image<std::uint8_t>("mono8", 2, 2, {1, 2, 99, 99, 3, 4, 99, 99});
  padded.step(4);
  EXPECT_EQ(to_gray(padded)->pixels, (std::vector<std::uint8_t>{1, 2, 3, 4}));
}

TEST(Depth, MillimetresBecomeMetres) {
  const auto depth = to_depth(depth_mm({0, 1, 1500, 65534, 65535}));
  ASSERT_TRUE(depth);
  EXPECT_THAT(depth->pixels, ::testing::ElementsAre(0.0f, ::testing::FloatEq(0.001f), ::testing::FloatEq(1.5f),
                                                    ::testing::FloatEq(65.534f), 0.0f));
}

TEST(Depth, MetresThatAreNoMeasurementBecomeZero) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const auto depth = to_depth(image<float>("32FC1", 6, 1, {1.25f, nan, infinity, -infinity, -1.0f, 0.0f}));
  ASSERT_TRUE(depth);
  EXPECT_EQ(depth->pixels, (std::vector<float>{1.25f, 0, 0, 0, 0, 0}));
}

TEST(Depth, EveryBitPatternGivesANumberThatIsUsable) {
  std::vector<std::uint32_t> patterns;
  for (std::uint64_t bits = 0; bits <= 0xFFFFFFFFu; bits += 0x10101)
    patterns.push_back(static_cast<std::uint32_t>(bits));
  std::vector<float> floats(patterns.size());
  std::memcpy(floats.data(), patterns.data(), 4 * patterns.size());
  const auto width = static_cast<std::uint32_t>(patterns.size() / 8);
  floats.resize(8u * width);
  const auto depth = to_depth(image("32FC1", width, 8, floats));
  ASSERT_TRUE(depth) << depth.reason;
  for (const float metres : depth->pixels) ASSERT_TRUE(std::isfinite(metres) && metres >= 0.0f);
}

TEST(Labels, LargestIdOfTheTypeMeansUnlabelled) {
  EXPECT_EQ(to_labels(image<std::uint8_t>("mono8", 3, 1, {0, 40, 255}))->pixels,
            (std::vector<std::uint16_t>{0, 40, 0}));
  EXPECT_EQ(to_labels(image<std::uint8_t>("8UC1", 1, 1, {7}))->pixels, (std::vector<std::uint16_t>{7}));
  EXPECT_EQ(to_labels(image<std::uint16_t>("mono16", 3, 1, {255, 300, 65535}))->pixels,
            (std::vector<std::uint16_t>{255, 300, 0}));
  EXPECT_EQ(to_labels(image<std::uint16_t>("16UC1", 1, 1, {9}))->pixels, (std::vector<std::uint16_t>{9}));
}

TEST(Labels, AMessageOfLabelsGivesTheSameLabels) {
  geometry::LabelImage labels(3, 2);
  labels.pixels = {0, 1, 254, 3, 2, 0};
  EXPECT_EQ(to_label_image(labels, {}).encoding(), "mono8");
  EXPECT_EQ(to_labels(to_label_image(labels, {}))->pixels, labels.pixels);
  labels(1, 1) = 255;  // would mean unlabelled in mono8
  EXPECT_EQ(to_label_image(labels, {}).encoding(), "mono16");
  EXPECT_EQ(to_labels(to_label_image(labels, {}))->pixels, labels.pixels);
}

TEST(Confidence, IsAShareOfCertainty) {
  EXPECT_EQ(to_confidence(image<std::uint8_t>("mono8", 3, 1, {0, 40, 255}))->pixels,
            (std::vector<std::uint8_t>{0, 40, 255}));
  EXPECT_EQ(to_confidence(image<float>("32FC1", 5, 1, {0.0f, 0.5f, 1.0f, 7.0f, NAN}))->pixels,
            (std::vector<std::uint8_t>{0, 128, 255, 255, 0}));
}

TEST(BadImage, WrongEncodingIsNamed) {
  Image message = image<std::uint8_t>("bayer_rggb8", 2, 2, {0, 0, 0, 0});
  EXPECT_THAT(to_gray(message).reason, HasSubstr("'bayer_rggb8'"));
  EXPECT_THAT(to_depth(message).reason, HasSubstr("'bayer_rggb8'"));
  EXPECT_THAT(to_labels(message).reason, HasSubstr("'bayer_rggb8'"));
  message.encoding("");
  EXPECT_FALSE(to_gray(message) || to_depth(message) || to_labels(message) || to_confidence(message));
}

// All three conversions share the layout check; each kind of wrong layout is tried on each of them.
void expect_refused(const Image& message, const std::string& reason) {
  for (const char* encoding : {"rgb8", "mono8", "bgr8", "rgba8", "bgra8"}) {
    Image color = message;
    color.encoding(encoding);
    EXPECT_THAT(to_gray(color).reason, HasSubstr(reason)) << encoding;
  }
  for (const char* encoding : {"16UC1", "32FC1"}) {
    Image depth = message;
    depth.encoding(encoding);
    EXPECT_THAT(to_depth(depth).reason, HasSubstr(reason)) << encoding;
  }
  for (const char* encoding : {"mono8", "mono16"}) {
    Image labels = message;
    labels.encoding(encoding);
    EXPECT_THAT(to_labels(labels).reason, HasSubstr(reason)) << encoding;
  }
  for (const char* encoding : {"mono8", "32FC1"}) {
    Image confidence = message;
    confidence.encoding(encoding);
    EXPECT_THAT(to_confidence(confidence).reason, HasSubstr(reason)) << encoding;
  }
}

TEST(BadImage, EmptyOrHugeOrTruncated) {
  Image empty;
  expect_refused(empty, "empty");

  Image huge;
  huge.width(0xFFFFFFFFu);
  huge.height(0xFFFFFFFFu);
  huge.step(0xFFFFFFFFu);
  expect_refused(huge, "larger than 16384 pixels");

  Image narrow;
  narrow.width(100);
  narrow.height(2);
  narrow.step(99);
  narrow.data().resize(198);
  expect_refused(narrow, "rows are shorter");

  Image truncated;
  truncated.width(10);
  truncated.height(10);
  truncated.step(40);
  truncated.data().resize(399);
  expect_refused(truncated, "image has not step x height bytes");
  truncated.data().resize(401);
  expect_refused(truncated, "image has not step x height bytes");
  truncated.data().clear();
  expect_refused(truncated, "image has not step x height bytes");
}

TEST(BadImage, BigEndianIsRefusedWhereItMatters) {
  Image wide = depth_mm({1, 2});
  wide.is_bigendian(1);
  EXPECT_THAT(to_depth(wide).reason, HasSubstr("big-endian"));
  Image bytes = image<std::uint8_t>("mono8", 1, 1, {5});
  bytes.is_bigendian(1);
  EXPECT_TRUE(to_labels(bytes));
}

}  // namespace
}  // namespace lapis::messages
