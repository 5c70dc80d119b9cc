#include "common/images/encoded_image.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <vector>

namespace lapis::images {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kWidth = 64, kHeight = 48;

cv::Mat picture(int type) {
  cv::Mat image(kHeight, kWidth, type);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto value = static_cast<std::uint8_t>(2 * x + y);
      if (type == CV_8UC1) image.at<std::uint8_t>(y, x) = value;
      if (type == CV_8UC3) image.at<cv::Vec3b>(y, x) = {value, value, value};
    }
  }
  return image;
}

Bytes encoded(const std::string& extension, int type, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, picture(type), bytes, parameters);
  return bytes;
}

TEST(EncodedImage, SizeAndGreyValuesOfJpegAndPng) {
  const std::vector<std::pair<Bytes, int>> files = {
      {encoded(".png", CV_8UC1), 0},
      {encoded(".png", CV_8UC3), 1},
      {encoded(".jpg", CV_8UC1), 4},
      {encoded(".jpg", CV_8UC3, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}), 4},
  };
  for (const auto& [bytes, tolerance] : files) {
    EXPECT_EQ(encoded_size(bytes), (ImageSize{kWidth, kHeight}));
    const auto gray = decode_gray(bytes);
    ASSERT_TRUE(gray);
    ASSERT_EQ(gray->width, kWidth);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) ASSERT_NEAR((*gray)(x, y), 2 * x + y, tolerance) << x << ", " << y;
    }
  }
}

TEST(EncodedImage, ColoursAreInTheOrderRedGreenBlue) {
  const cv::Mat blue_green_red(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
  Bytes png;
  cv::imencode(".png", blue_green_red, png);
  const auto color = decode_color(png);
  ASSERT_TRUE(color);
  EXPECT_EQ(color->width, 3);
  EXPECT_EQ(color->pixels, std::vector<geometry::Rgb8>(6, {30, 20, 10}));
  const auto gray = decode_color(encoded(".png", CV_8UC1));
  ASSERT_TRUE(gray);
  EXPECT_EQ((*gray)(5, 2), (geometry::Rgb8{12, 12, 12}));
  EXPECT_FALSE(decode_color(Bytes(png.begin(), png.begin() + 40)));
}

TEST(EncodedImage, TruncatedFilesAreDamaged) {
  for (const char* extension : {".png", ".jpg"}) {
    const Bytes whole = encoded(extension, CV_8UC3);
    for (std::size_t size = 0; size < whole.size() - 12; size += 7) {
      EXPECT_FALSE(decode_gray(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))))
          << extension << ", " << size << " bytes of " << whole.size();
    }
  }
}

TEST(EncodedImage, TailOfACameraIsNoTruncation) {
  Bytes bytes = encoded(".jpg", CV_8UC3);
  bytes.insert(bytes.end(), 8, 0);
  EXPECT_TRUE(decode_gray(bytes));
}

TEST(EncodedImage, OtherBytesHaveNoSize) {
  EXPECT_FALSE(encoded_size(Bytes()));
  EXPECT_FALSE(encoded_size(Bytes{0xFF, 0xD8}));
  EXPECT_FALSE(encoded_size(Bytes(100, 0xFF)));
  EXPECT_FALSE(encoded_size(encoded(".bmp", CV_8UC3)));
  EXPECT_FALSE(decode_gray(encoded(".bmp", CV_8UC3)));
}

// What the header says is what would be allocated: it has to be read without decoding.
TEST(EncodedImage, HugeSizesAreReadNotAllocated) {
  Bytes png = encoded(".png", CV_8UC1);
  png[16] = png[20] = 0x7F;  // the highest bytes of width and height
  EXPECT_FALSE(encoded_size(png));
  Bytes jpeg = encoded(".jpg", CV_8UC1);
  for (std::size_t i = 2; i + 9 < jpeg.size(); ++i) {
    if (jpeg[i] != 0xFF || jpeg[i + 1] != 0xC0) continue;
    jpeg[i + 5] = jpeg[i + 7] = 0xFF;
    break;
  }
  EXPECT_EQ(encoded_size(jpeg), (ImageSize{0xFF00 + kWidth, 0xFF00 + kHeight}));
}

TEST(EncodedImage, DamagedBytesNeverGiveAnotherSizeThanTheHeaderSays) {
  std::mt19937 random(3);
  for (const char* extension : {".png", ".jpg"}) {
    const Bytes whole = encoded(extension, CV_8UC3);
    for (int trial = 0; trial < 2000; ++trial) {
      Bytes bytes = whole;
      for (int flip = 0; flip < 3; ++flip) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      const auto size = encoded_size(bytes);
      if (!size || size->width > 4 * kWidth || size->height > 4 * kHeight) continue;
      const auto gray = decode_gray(bytes);
      if (!gray) continue;
      ASSERT_EQ((ImageSize{gray->width, gray->height}), *size) << extension << ", trial " << trial;
    }
  }
}

}  // namespace
}  // namespace lapis::images
