#include "segmenter/core/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>

#include "segmenter/core/segmenter.hpp"
#include "segmenter/model_yaml.hpp"
#include "tests/support/color_network.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmenter/error_of.hpp"

namespace lapis::segmenter {
namespace {

using lapis::test::ColorNetwork;
using lapis::test::TemporaryFolder;
using lapis::test::write_color_model;
using ::testing::HasSubstr;

constexpr int kOldestOpset = 7;
constexpr int kHighestOpset = 24;  // components/segmenter/README.md names it

const std::vector<geometry::Rgb8> kColors = {{200, 30, 30}, {30, 190, 40}, {20, 40, 210}, {220, 220, 60}};

/// An image whose pixels are near the colours, and the label of each.
std::pair<geometry::ColorImage, geometry::LabelImage> speckled(int width, int height) {
  std::mt19937 engine(11);
  geometry::ColorImage image(width, height);
  geometry::LabelImage labels(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::size_t index = engine() % kColors.size();
    const auto near = [&](std::uint8_t value) { return static_cast<std::uint8_t>(value + engine() % 21 - 10); };
    image.pixels[i] = {near(kColors[index].r), near(kColors[index].g), near(kColors[index].b)};
    labels.pixels[i] = static_cast<std::uint16_t>(index + 1);
  }
  return {image, labels};
}

class NetworkTest : public ::testing::Test {
 protected:
  Segmentation segment(const ColorNetwork& network, const geometry::ColorImage& image) const {
    return Segmenter(read_model_file(write_color_model(folder_.path(), network)).model).segment(image);
  }
  std::string problem_with(const ColorNetwork& network) const {
    const auto file = write_color_model(folder_.path(), network);
    return test::error_of([&] { Segmenter(read_model_file(file).model); });
  }
  std::string problem_with_bytes(const std::string& bytes) const {
    const auto file = folder_.path() / "bytes.onnx";
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return test::error_of([&] { Network(file, ""); });
  }

  TemporaryFolder folder_;
};

TEST_F(NetworkTest, EachEndingAndLayoutFindsTheLabels) {
  const auto [image, labels] = speckled(32, 24);
  for (const char* ending : {"", "Softmax", "ArgMax"}) {
    for (const bool is_nhwc : {false, true}) {
      if (is_nhwc && std::string(ending) == "ArgMax") continue;  // no channels are left
      ColorNetwork network{.colors = kColors, .ending = ending, .is_nhwc = is_nhwc};
      const auto out = segment(network, image);
      EXPECT_EQ(out.labels.pixels, labels.pixels) << ending << is_nhwc;
      EXPECT_EQ(out.confidence.empty(), std::string(ending) == "ArgMax");
    }
  }
}

TEST_F(NetworkTest, ConfidenceIsTheSoftmaxOfTheLogits) {
  const auto [image, labels] = speckled(32, 24);
  const ColorNetwork network{.colors = kColors, .gain = 3.0F};
  const auto out = segment(network, image);
  const auto of_softmax = segment({.colors = kColors, .gain = 3.0F, .ending = "Softmax"}, image);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    std::vector<double> p;
    double sum = 0.0;
    for (const auto& color : kColors) {
      const double r = (color.r - image.pixels[i].r) / 255.0, g = (color.g - image.pixels[i].g) / 255.0,
                   b = (color.b - image.pixels[i].b) / 255.0;
      p.push_back(std::exp(-3.0 * (r * r + g * g + b * b)));
      sum += p.back();
    }
    const double expected = 255.0 * p[labels.pixels[i] - 1u] / sum;
    ASSERT_NEAR(out.confidence.pixels[i], expected, 0.6);
    ASSERT_NEAR(of_softmax.confidence.pixels[i], expected, 0.6);
  }
}

TEST_F(NetworkTest, LabelsHaveTheSizeOfTheImageWhateverThatOfTheNetwork) {
  const auto [image, labels] = speckled(32, 24);
  const auto larger = resized(image, 96, 72);
  const auto out = segment({.colors = kColors}, larger);
  EXPECT_EQ(out.labels.pixels, resized(labels, 96, 72).pixels);
  EXPECT_EQ(out.confidence.width, 96);
}

TEST_F(NetworkTest, ReadsEveryOpsetUpToTheHighestTested) {
  const auto [image, labels] = speckled(32, 24);
  for (int opset = kOldestOpset; opset <= kHighestOpset; ++opset) {
    for (const char* ending : {"", "Softmax", "ArgMax"}) {
      // Resize has its inputs and modes since opset 11.
      const ColorNetwork network{.colors = kColors, .opset = opset, .ending = ending, .has_detour = opset >= 11};
      EXPECT_EQ(segment(network, image).labels.pixels, labels.pixels) << "opset " << opset << ending;
    }
  }
}

TEST_F(NetworkTest, TheSameImageGivesTheSameBytesWithAnyNumberOfThreads) {
  const auto [image, labels] = speckled(64, 48);
  const ColorNetwork network{.colors = kColors, .width = 64, .height = 48, .gain = 2.0F, .has_detour = true};
  const auto model = read_model_file(write_color_model(folder_.path(), network)).model;
  Segmenter segmenter(model);
  const auto first = segmenter.segment(image);
  for (const int threads : {1, 2}) {
    set_threads(threads);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(segmenter.segment(image).confidence.pixels, first.confidence.pixels);
    EXPECT_EQ(Segmenter(model).segment(image).confidence.pixels, first.confidence.pixels);
  }
  set_threads(1);
}

TEST_F(NetworkTest, AnOutputIsChosenByItsName) {
  ColorNetwork network{.colors = kColors, .has_second_output = true};
  EXPECT_EQ(problem_with(network), "");
  const auto file = folder_.path() / "network.onnx";
  const std::string none = test::error_of([&] { Network(file, ""); });
  EXPECT_THAT(none,
              HasSubstr(file.string() + ": the network has several outputs: set output.name to one of others, scores"));
  EXPECT_THAT(test::error_of([&] { Network(file, "other"); }),
              HasSubstr("no output 'other' (output.name); it has others, scores"));
}

TEST_F(NetworkTest, WhatOpenCvDoesNotKnowIsNamed) {
  const std::string problem = problem_with({.colors = kColors, .ending = "NoSuchOperator"});
  EXPECT_THAT(problem, HasSubstr("network.onnx: OpenCV"));
  EXPECT_THAT(problem, HasSubstr("NoSuchOperator"));
  EXPECT_THAT(problem, HasSubstr("export it with another opset"));
}

TEST_F(NetworkTest, ANetworkThatDoesNotFitItsModelIsRefused) {
  const auto file = write_color_model(folder_.path(), {.colors = kColors});
  auto model = read_model_file(file).model;
  model.classes = ClassTable(std::map<int, std::uint16_t>{{4, 1}});
  EXPECT_THAT(test::error_of([&] { Segmenter{model}; }),
              HasSubstr("the network has 4 classes, from 0 on; classes names 4"));
  model = read_model_file(file).model;
  model.input.layout = Layout::kNhwc;
  EXPECT_THAT(test::error_of([&] { Segmenter{model}; }), HasSubstr("input.layout"));
  model = read_model_file(file).model;
  model.output.values = Values::kLabels;
  EXPECT_THAT(test::error_of([&] { Segmenter{model}; }), HasSubstr("output is 1 x 4 x 24 x 32"));
}

TEST_F(NetworkTest, FilesThatAreNoNetworksAreRefused) {
  EXPECT_THAT(test::error_of([&] { Network(folder_.path() / "none.onnx", ""); }), HasSubstr("none.onnx"));
  EXPECT_THAT(test::error_of([&] { Network(folder_.path(), ""); }), HasSubstr(folder_.path().string()));
  for (const std::string& bytes : {std::string(), std::string("no network"), std::string(1000, '\0')}) {
    EXPECT_THAT(problem_with_bytes(bytes), HasSubstr("bytes.onnx: ")) << bytes.size();
  }
  const std::string whole = lapis::test::onnx_file({.colors = kColors, .has_detour = true});
  EXPECT_EQ(problem_with_bytes(whole), "");
  std::size_t accepted = 0;
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    if (problem_with_bytes(whole.substr(0, size)).empty()) ++accepted;
  }
  EXPECT_LE(accepted, 10u) << "only the opset at the end may be missing";
}

TEST_F(NetworkTest, WeightsThatAreNoNumbersLeaveAllUnlabelled) {
  const auto [image, labels] = speckled(32, 24);
  const auto out = segment({.colors = kColors, .gain = std::numeric_limits<float>::quiet_NaN()}, image);
  EXPECT_EQ(out.unusable, image.pixels.size());
  EXPECT_EQ(out.labels.pixels, std::vector<std::uint16_t>(image.pixels.size(), 0));
  EXPECT_EQ(out.confidence.pixels, std::vector<std::uint8_t>(image.pixels.size(), 0));
}

}  // namespace
}  // namespace lapis::segmenter
