#include "sensor_replay/core/image_file.hpp"

#include <gtest/gtest.h>

#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::kHeight;
using test::kWidth;

constexpr ImageSize kSize{kWidth, kHeight};

template <class Image>
ImageFault fault_of(const std::variant<Image, ImageFault>& answer) {
  EXPECT_TRUE(std::holds_alternative<ImageFault>(answer)) << "expected a fault";
  const auto* fault = std::get_if<ImageFault>(&answer);
  return fault ? *fault : ImageFault::kNotListed;
}

class ImageFile : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  DepthMillimetres depth_of(std::initializer_list<std::uint16_t> values, double scale) const {
    DepthMillimetres raw(kWidth, kHeight);
    std::copy(values.begin(), values.end(), raw.pixels.begin());
    test::write_gray16(file("d.png"), raw);
    return std::get<DepthMillimetres>(read_depth(file("d.png"), kSize, scale));
  }

  test::TemporaryFolder folder_;
};

TEST_F(ImageFile, ColourComesInRgbOrderAndRowMajor) {
  test::write_dataset(folder_.path(), 1);
  const auto color = std::get<geometry::ColorImage>(read_color(file("rgb/00000.png"), kSize));
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      ASSERT_EQ(color(column, row), test::synthetic_color(0, column, row)) << column << ", " << row;
    }
  }
}

TEST_F(ImageFile, JpegIsReadAsColour) {
  test::write_rgb8(file("c.jpg"), kWidth, kHeight);
  EXPECT_TRUE(std::holds_alternative<geometry::ColorImage>(read_color(file("c.jpg"), kSize)));
}

TEST_F(ImageFile, TruncationIsSeenWhereverItIs) {
  for (const char* name : {"c.jpg", "c.png"}) {
    for (const double share : {0.0, 0.01, 0.3, 0.9, 0.97}) {
      test::write_rgb8(file(name), 4 * kWidth, 4 * kHeight);
      test::truncate(file(name), share);
      EXPECT_EQ(fault_of(read_color(file(name), {4 * kWidth, 4 * kHeight})), ImageFault::kUndecodable)
          << name << " at " << share;
    }
  }
}

TEST_F(ImageFile, GarbageAndMissingFilesAreFaults) {
  test::write_text(file("c.png"), "this is no image");
  EXPECT_EQ(fault_of(read_color(file("c.png"), kSize)), ImageFault::kUndecodable);
  EXPECT_EQ(fault_of(read_color(file("none.png"), kSize)), ImageFault::kMissing);
  EXPECT_EQ(fault_of(read_color(folder_.path(), kSize)), ImageFault::kMissing);
  EXPECT_EQ(fault_of(read_size(file("none.png"))), ImageFault::kMissing);
}

TEST_F(ImageFile, WrongSizeAndPixelTypeAreFaults) {
  test::write_gray8(file("g8.png"), kWidth, kHeight, 3);
  test::write_gray16(file("g16.png"), DepthMillimetres(kWidth, kHeight));
  test::write_rgb8(file("c.png"), kWidth, kHeight);
  const ImageSize other{kWidth, kHeight + 1};
  EXPECT_EQ(fault_of(read_color(file("c.png"), other)), ImageFault::kWrongSize);
  EXPECT_EQ(fault_of(read_depth(file("g16.png"), other, 1000.0)), ImageFault::kWrongSize);
  EXPECT_EQ(fault_of(read_label(file("g8.png"), other)), ImageFault::kWrongSize);
  EXPECT_EQ(fault_of(read_color(file("g8.png"), kSize)), ImageFault::kWrongPixelType);
  EXPECT_EQ(fault_of(read_color(file("g16.png"), kSize)), ImageFault::kWrongPixelType);
  EXPECT_EQ(fault_of(read_depth(file("g8.png"), kSize, 1000.0)), ImageFault::kWrongPixelType);
  EXPECT_EQ(fault_of(read_depth(file("c.png"), kSize, 1000.0)), ImageFault::kWrongPixelType);
  EXPECT_EQ(fault_of(read_label(file("c.png"), kSize)), ImageFault::kWrongPixelType);
}

TEST_F(ImageFile, MillimetresPassUnchangedAndBothNoDepthValuesBecomeZero) {
  const auto depth = depth_of({0, 1, 999, 65534, 65535}, 1000.0);
  const std::vector<std::uint16_t> expected{0, 1, 999, 65534, 0};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), depth.pixels.begin()));
}

TEST_F(ImageFile, OtherDepthScalesAreRoundedToMillimetres) {
  const auto tum = depth_of({0, 2, 3, 5000, 5002, 5003, 65534, 65535}, 5000.0);
  const std::vector<std::uint16_t> expected{0, 0, 1, 1000, 1000, 1001, 13107, 0};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), tum.pixels.begin()));
  const auto centimetres = depth_of({1, 6553, 6554}, 100.0);
  EXPECT_EQ(centimetres(0, 0), 10);
  EXPECT_EQ(centimetres(1, 0), 65530);
  EXPECT_EQ(centimetres(2, 0), 0) << "65.54 m does not fit into 16 bits of millimetres";
}

TEST_F(ImageFile, LabelsOfBothWidths) {
  test::write_gray8(file("l8.png"), kWidth, kHeight, 255);
  EXPECT_EQ(std::get<geometry::LabelImage>(read_label(file("l8.png"), kSize))(kWidth - 1, kHeight - 1), 255);
  geometry::LabelImage wide(kWidth, kHeight, 300);
  wide(3, 2) = 65535;
  test::write_gray16(file("l16.png"), wide);
  EXPECT_EQ(std::get<geometry::LabelImage>(read_label(file("l16.png"), kSize)).pixels, wide.pixels);
}

}  // namespace
}  // namespace lapis::sensor_replay
