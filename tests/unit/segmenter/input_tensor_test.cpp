#include "segmenter/core/input_tensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lapis::segmenter {
namespace {

geometry::ColorImage random_image(int width, int height) {
  std::mt19937 engine(5);
  geometry::ColorImage image(width, height);
  const auto byte = [&] { return static_cast<std::uint8_t>(engine() % 256); };
  for (auto& pixel : image.pixels) pixel = {byte(), byte(), byte()};
  return image;
}

double component(const geometry::Rgb8& pixel, int c) { return c == 0 ? pixel.r : c == 1 ? pixel.g : pixel.b; }

InputFormat format(int width, int height) {
  InputFormat f;
  f.width = width;
  f.height = height;
  f.mean = {0.485, 0.456, 0.406};
  f.std = {0.229, 0.224, 0.225};
  return f;
}

TEST(InputTensor, NormalisesEachChannelInEitherLayoutAndOrder) {
  const auto image = random_image(7, 5);
  InputFormat f = format(7, 5);
  for (const Layout layout : {Layout::kNchw, Layout::kNhwc}) {
    for (const Channels channels : {Channels::kRgb, Channels::kBgr}) {
      f.layout = layout;
      f.channels = channels;
      const Tensor tensor = to_input(image, f);
      EXPECT_EQ(tensor.shape, layout == Layout::kNchw ? (std::vector{1, 3, 5, 7}) : (std::vector{1, 5, 7, 3}));
      for (int c = 0; c < 3; ++c) {
        for (int row = 0; row < 5; ++row) {
          for (int column = 0; column < 7; ++column) {
            const double value = component(image(column, row), channels == Channels::kRgb ? c : 2 - c);
            const auto k = static_cast<std::size_t>(c);
            const int at = layout == Layout::kNchw ? (c * 5 + row) * 7 + column : (row * 7 + column) * 3 + c;
            ASSERT_NEAR(tensor.values[static_cast<std::size_t>(at)], (value / 255.0 - f.mean[k]) / f.std[k], 1e-5);
          }
        }
      }
    }
  }
}

TEST(InputTensor, SmallerIsTheMeanOfTheArea) {
  const auto image = random_image(12, 9);
  InputFormat f;
  f.width = 4;
  f.height = 3;
  f.scale = 1.0;
  const Tensor tensor = to_input(image, f);
  for (int c = 0; c < 3; ++c) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        double sum = 0.0;
        for (int i = 0; i < 9; ++i) sum += component(image(3 * column + i % 3, 3 * row + i / 3), c);
        EXPECT_NEAR(tensor.values[static_cast<std::size_t>((c * 3 + row) * 4 + column)], sum / 9.0, 0.51);
      }
    }
  }
}

TEST(InputTensor, LargerIsInterpolatedBetweenCentres) {
  const auto image = random_image(6, 4);
  InputFormat f;
  f.width = 15;
  f.height = 13;
  f.scale = 1.0;
  const Tensor tensor = to_input(image, f);
  const auto clamped = [&](double column, double row, int c) {
    const int x = std::min(5, std::max(0, static_cast<int>(column))),
              y = std::min(3, std::max(0, static_cast<int>(row)));
    return component(image(x, y), c);
  };
  for (int c = 0; c < 3; ++c) {
    for (int row = 0; row < 13; ++row) {
      for (int column = 0; column < 15; ++column) {
        const double x = (column + 0.5) * 6 / 15 - 0.5, y = (row + 0.5) * 4 / 13 - 0.5;
        const double left = std::floor(x), top = std::floor(y);
        double expected = 0.0;
        for (const int i : {0, 1}) {
          for (const int j : {0, 1}) {
            expected += clamped(left + i, top + j, c) * (i == 0 ? 1 - (x - left) : x - left) *
                        (j == 0 ? 1 - (y - top) : y - top);
          }
        }
        EXPECT_NEAR(tensor.values[static_cast<std::size_t>((c * 13 + row) * 15 + column)], expected, 1.0);
      }
    }
  }
}

}  // namespace
}  // namespace lapis::segmenter
