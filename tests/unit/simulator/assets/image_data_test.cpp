#include "simulator/core/assets/image_data.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using test::Bytes;

Bytes encoded(const std::string& ending, const cv::Mat& image) {
  Bytes bytes;
  cv::imencode(ending, image, bytes);
  return bytes;
}

// Upper half red, lower half blue, with the channel order of OpenCV.
cv::Mat red_over_blue(int width, int height) {
  cv::Mat image(height, width, CV_8UC3, cv::Scalar(0, 0, 255));
  image.rowRange(height / 2, height).setTo(cv::Scalar(255, 0, 0));
  return image;
}

TEST(DecodeTexture, KeepsColoursAndRowsOfEveryFormat) {
  for (const auto* ending : {".png", ".jpg", ".bmp"}) {
    const auto texture = decode_texture(encoded(ending, red_over_blue(32, 16)), 512);
    ASSERT_TRUE(texture) << ending;
    ASSERT_EQ(texture->width, 32);
    ASSERT_EQ(texture->height, 16);
    const Rgba8 top = (*texture)(16, 2), bottom = (*texture)(16, 13);
    EXPECT_NEAR(top.r, 255, 3) << ending;
    EXPECT_NEAR(top.b, 0, 3) << ending;
    EXPECT_NEAR(bottom.r, 0, 3) << ending;
    EXPECT_NEAR(bottom.b, 255, 3) << ending;
    EXPECT_EQ(top.a, 255);
  }
}

TEST(DecodeTexture, EightBitsFromSixteenAndFromGrey) {
  for (int value = 0; value < 256; value += 15) {
    const auto deep = decode_texture(encoded(".png", cv::Mat(2, 2, CV_16UC3, cv::Scalar::all(value * 257))), 512);
    const auto grey = decode_texture(encoded(".png", cv::Mat(2, 2, CV_8UC1, cv::Scalar(value))), 512);
    ASSERT_TRUE(deep && grey);
    const auto byte = static_cast<std::uint8_t>(value);
    const Rgba8 expected{byte, byte, byte, 255};
    EXPECT_EQ((*deep)(0, 0), expected) << value;
    EXPECT_EQ((*grey)(1, 1), expected) << value;
  }
}

TEST(DecodeTexture, ShrinksByAveraging) {
  cv::Mat image(600, 900, CV_8UC3);
  cv::randu(image, 0, 256);
  const cv::Scalar mean = cv::mean(image);
  const auto texture = decode_texture(encoded(".png", image), 90);
  ASSERT_TRUE(texture);
  EXPECT_EQ(texture->width, 90);
  EXPECT_EQ(texture->height, 60);
  double red = 0;
  for (const auto& texel : texture->pixels) red += texel.r;
  EXPECT_NEAR(red / static_cast<double>(texture->pixels.size()), mean[2], 0.6);
  const auto thin = decode_texture(encoded(".png", cv::Mat(1, 1000, CV_8UC1, cv::Scalar(7))), 10);
  ASSERT_TRUE(thin);
  EXPECT_EQ(thin->height, 1);
}

TEST(DecodeTexture, HolesAreTexelsBelowHalfAlpha) {
  for (const int alpha : {0, 127, 128, 255}) {
    const auto texture = decode_texture(test::png(3, 3, {9, 8, 7, static_cast<std::uint8_t>(alpha)}), 512);
    ASSERT_TRUE(texture);
    EXPECT_EQ((*texture)(1, 1), (Rgba8{9, 8, 7, static_cast<std::uint8_t>(alpha)}));
    EXPECT_EQ(has_holes(*texture), alpha < 128);
  }
}

TEST(DecodeTexture, IgnoresTheOrientationInExif) {
  Bytes jpeg = encoded(".jpg", red_over_blue(32, 16));
  const Bytes exif{0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0, 0, 'M', 'M', 0, 42, 0, 0, 0, 8,
                   0,    1,    1, 18, 0,   3,   0,   0,   0, 1, 0,   6,   0, 0,  0, 0, 0, 0};  // rotate by 90 degrees
  jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
  const cv::Mat turned = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  ASSERT_EQ(turned.rows, 32) << "the tag is meant to be valid";
  const auto texture = decode_texture(jpeg, 512);
  ASSERT_TRUE(texture);
  EXPECT_EQ(texture->width, 32);
}

TEST(DecodeTexture, RefusesWhatIsNoImage) {
  EXPECT_FALSE(decode_texture({}, 512));
  EXPECT_FALSE(decode_texture(test::to_bytes("GIF89a is not read"), 512));
  EXPECT_FALSE(decode_texture(test::to_bytes("P6 2 2 255 aaaabbbbcccc"), 512));
  Bytes png = test::png(4, 4, {});
  const auto big_endian_at = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) png[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  };
  big_endian_at(16, 30000);  // a header that promises 900 million pixels
  big_endian_at(20, 30000);
  EXPECT_FALSE(decode_texture(png, 512));
}

// A decoder may make something of what is there; it must not fall over.
TEST(DecodeTexture, SurvivesTruncation) {
  for (const auto* ending : {".png", ".jpg", ".bmp"}) {
    const Bytes whole = encoded(ending, red_over_blue(16, 8));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const auto texture = decode_texture(std::span(whole).first(size), 512);
      EXPECT_TRUE(!texture || texture->pixels.size() == 16U * 8U) << ending << " of " << size << " bytes";
    }
  }
}

}  // namespace
}  // namespace lapis::simulator
