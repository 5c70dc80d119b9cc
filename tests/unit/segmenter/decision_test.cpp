#include "segmenter/core/decision.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/segmenter/error_of.hpp"

namespace lapis::segmenter {
namespace {

using ::testing::HasSubstr;

constexpr int kClasses = 5, kWidth = 7, kHeight = 4;
const ClassTable kTable({{0, 3}, {2, 8}, {3, 3}, {4, 300}});  // two classes have one label, class 1 has none

std::size_t position(const std::vector<int>& shape, Layout layout, int c, int row, int column) {
  const int at =
      layout == Layout::kNchw ? (c * shape[2] + row) * shape[3] + column : (row * shape[2] + column) * shape[3] + c;
  return static_cast<std::size_t>(at);
}

Tensor random_scores(Layout layout, Values values) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> logit(-4.0F, 4.0F);
  Tensor tensor{
      layout == Layout::kNchw ? std::vector{1, kClasses, kHeight, kWidth} : std::vector{1, kHeight, kWidth, kClasses},
      std::vector<float>(kClasses * kHeight * kWidth)};
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      float sum = 0.0F;
      for (int c = 0; c < kClasses; ++c) {
        float& v = tensor.values[position(tensor.shape, layout, c, row, column)];
        v = values == Values::kLogits ? logit(engine) : std::exp(logit(engine));
        sum += v;
      }
      if (values == Values::kLogits) continue;
      for (int c = 0; c < kClasses; ++c) tensor.values[position(tensor.shape, layout, c, row, column)] /= sum;
    }
  }
  return tensor;
}

TEST(Decision, IsThatOfTheDefinitionForEachLayout) {
  for (const Layout layout : {Layout::kNchw, Layout::kNhwc}) {
    for (const Values values : {Values::kLogits, Values::kProbabilities}) {
      const Tensor scores = random_scores(layout, values);
      const auto out = decide(scores, {"", layout, values}, kTable);
      ASSERT_EQ(out.labels.width, kWidth);
      ASSERT_EQ(out.confidence.height, kHeight);
      EXPECT_EQ(out.unusable, 0u);
      for (int row = 0; row < kHeight; ++row) {
        for (int column = 0; column < kWidth; ++column) {
          std::vector<double> p;
          double sum = 0.0;
          for (int c = 0; c < kClasses; ++c) {
            const double v = scores.values[position(scores.shape, layout, c, row, column)];
            p.push_back(values == Values::kLogits ? std::exp(v) : v);
            sum += p.back();
          }
          const auto best = static_cast<std::size_t>(std::max_element(p.begin(), p.end()) - p.begin());
          double share = 0.0;
          for (std::size_t c = 0; c < p.size(); ++c) {
            if (kTable.label_of(c) == kTable.label_of(best)) share += p[c] / sum;
          }
          EXPECT_EQ(out.labels(column, row), kTable.label_of(best));
          EXPECT_NEAR(out.confidence(column, row), 255.0 * share, 0.51);
        }
      }
    }
  }
}

TEST(Decision, TheFirstOfEqualClassesWins) {
  const Tensor equal{{1, kClasses, 1, 1}, std::vector<float>(kClasses, 0.5F)};
  const auto out = decide(equal, {}, kTable);
  EXPECT_EQ(out.labels(0, 0), 3);
  EXPECT_EQ(out.confidence(0, 0), 102);  // two of five
}

TEST(Decision, LargeLogitsDoNotOverflowAndWhatIsNotANumberIsUnlabelled) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::vector<float>> pixels = {{1e30F, 0, 0, 0, 0},
                                                  {0, -kInfinity, 50, -kInfinity, 0},
                                                  {kNan, 0, 9, 0, 0},
                                                  {0, 0, kInfinity, 0, 0},
                                                  {kNan, kNan, kNan, kNan, kNan}};
  Tensor scores{{1, 1, static_cast<int>(pixels.size()), kClasses}, {}};
  for (const auto& pixel : pixels) scores.values.insert(scores.values.end(), pixel.begin(), pixel.end());
  const auto out = decide(scores, {"", Layout::kNhwc, Values::kLogits}, kTable);
  EXPECT_EQ(out.labels.pixels, (std::vector<std::uint16_t>{3, 8, 0, 0, 0}));
  EXPECT_EQ(out.confidence.pixels, (std::vector<std::uint8_t>{255, 255, 0, 0, 0}));
  EXPECT_EQ(out.unusable, 3u);
}

TEST(Decision, LabelsOfTheNetworkGoThroughTheTable) {
  const Tensor indices{{1, 1, 2, 3}, {0, 1, 2, 4, 5, -1}};
  const auto out = decide(indices, {"", Layout::kNchw, Values::kLabels}, kTable);
  EXPECT_EQ(out.labels.pixels, (std::vector<std::uint16_t>{3, 0, 8, 300, 0, 0}));
  EXPECT_TRUE(out.confidence.empty());
  const Tensor wild{{1, 2}, {std::numeric_limits<float>::quiet_NaN(), 1e20F}};
  EXPECT_THAT(test::error_of([&] { decide(wild, {"", Layout::kNchw, Values::kLabels}, kTable); }), HasSubstr("1 x 2"));
  const Tensor strange{{2, 2}, {std::numeric_limits<float>::quiet_NaN(), 1e20F, -1e20F, 3.0F}};
  const auto of_strange = decide(strange, {"", Layout::kNchw, Values::kLabels}, kTable);
  EXPECT_EQ(of_strange.labels.pixels, (std::vector<std::uint16_t>{0, 0, 0, 3}));
}

TEST(Decision, OutputsThatAreNoImagesAreRefusedWithTheirShape) {
  for (const std::vector<int>& shape : {std::vector{1, 1000}, {2, 5, 4, 7}, {1, 1, 4, 7}, {5, 1, 4, 7, 2}}) {
    const std::string error = test::error_of([&] { output_shape(shape, {}); });
    EXPECT_THAT(error, HasSubstr("output is " + std::to_string(shape[0]) + " x "));
    EXPECT_THAT(error, HasSubstr("output.layout"));
  }
}

TEST(Resized, TakesThePixelInWhichTheCentreLies) {
  geometry::LabelImage small(3, 2);
  for (std::size_t i = 0; i < small.pixels.size(); ++i) small.pixels[i] = static_cast<std::uint16_t>(i);
  for (const auto& [width, height] : {std::pair(3, 2), {9, 8}, {7, 5}, {2, 1}}) {
    const auto other = resized(small, width, height);
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const int x = static_cast<int>(std::floor((column + 0.5) * 3 / width + 1e-9));
        const int y = static_cast<int>(std::floor((row + 0.5) * 2 / height + 1e-9));
        EXPECT_EQ(other(column, row), small(x, y)) << width << " x " << height;
      }
    }
  }
}

}  // namespace
}  // namespace lapis::segmenter
