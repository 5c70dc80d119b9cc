#include "segmenter/model_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmenter/error_of.hpp"

namespace lapis::segmenter {
namespace {

using ::testing::HasSubstr;

const std::string kWhole = R"(network: nets/a.onnx
labels: labels.yaml
input: {width: 320, height: 200, layout: NHWC, channels: bgr, scale: 1, mean: [1, 2, 3], std: [4, 5, 6]}
output: {name: out, layout: NHWC, values: probabilities}
classes:
  0: wall
  5: chair
  7: wall
)";
const std::string kShort =
    "network: a.onnx\nlabels: labels.yaml\ninput: {width: 32, height: 24}\nclasses: {1: chair}\n";

class ModelYaml : public ::testing::Test {
 protected:
  ModelYaml() { write("labels.yaml", "labels:\n  - {id: 1, name: wall}\n  - {id: 300, name: chair}\n"); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  std::string problem_with(const std::string& text) const {
    return test::error_of([&] { read_model_file(write("model.yaml", text)); });
  }
  static std::string changed(const std::string& from, const std::string& to, std::string text = kWhole) {
    return text.replace(text.find(from), from.size(), to);
  }

  lapis::test::TemporaryFolder folder_;
};

TEST_F(ModelYaml, ReadsAllKeys) {
  const auto file = read_model_file(write("model.yaml", kWhole));
  EXPECT_EQ(file.model.network, folder_.path() / "nets/a.onnx");
  EXPECT_EQ(file.labels.name(300), "chair");
  const InputFormat& input = file.model.input;
  EXPECT_EQ(std::pair(input.width, input.height), std::pair(320, 200));
  EXPECT_EQ(std::pair(input.layout, input.channels), std::pair(Layout::kNhwc, Channels::kBgr));
  EXPECT_EQ(input.scale, 1.0);
  EXPECT_EQ(input.mean, (std::array{1.0, 2.0, 3.0}));
  EXPECT_EQ(input.std, (std::array{4.0, 5.0, 6.0}));
  EXPECT_EQ(file.model.output.name, "out");
  EXPECT_EQ(std::pair(file.model.output.layout, file.model.output.values),
            std::pair(Layout::kNhwc, Values::kProbabilities));
  EXPECT_EQ(file.model.classes, ClassTable({{0, 1}, {5, 300}, {7, 1}}));
}

TEST_F(ModelYaml, DefaultsAreThoseOfMostNetworks) {
  const auto file = read_model_file(write("model.yaml", kShort));
  EXPECT_EQ(std::pair(file.model.input.layout, file.model.input.channels), std::pair(Layout::kNchw, Channels::kRgb));
  EXPECT_EQ(file.model.input.scale, 1.0 / 255.0);
  EXPECT_EQ(file.model.output.values, Values::kLogits);
  EXPECT_TRUE(file.model.output.name.empty());
}

TEST_F(ModelYaml, ErrorsNameFileLineKeyAndRemedy) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {changed("network: nets/a.onnx\n", ""), ":1: model: key \"network\" is missing"},
      {changed("labels: labels.yaml", "labels: none.yaml"), "none.yaml: not found"},
      {changed("width: 320", "width: 0"), ":3: input: width: must be the network's width in pixels, from 1 to 4096"},
      {changed("width: 320", "width: many"), ":3: width: must be a number"},
      {changed("layout: NHWC", "layout: HWC"), "layout: must be one of NCHW, NHWC, not \"HWC\""},
      {changed("channels: bgr", "channels: gray"), "channels: must be one of rgb, bgr"},
      {changed("std: [4, 5, 6]", "std: [4, 0, 6]"), "std: must be three numbers above 0"},
      {changed("std: [4, 5, 6]", "std: [4, 5]"), ":3: std: must be 3 numbers"},
      {changed("values: probabilities", "values: scores"), "must be one of logits, probabilities, labels"},
      {changed("5: chair", "5: table"), "5: " + (folder_.path() / "labels.yaml").string() + " has no class \"table\""},
      {changed("5: chair", "five: chair"), "\"five\" is no index of a class of the network"},
      {changed("5: chair", "-5: chair"), "\"-5\" is no index"},
      {changed("5: chair", "999999999999: chair"), "is no index"},
      {changed("5: chair", "0: chair"), "key \"0\" occurs twice"},
      {changed("5: chair", "00: chair"), "the same index twice"},
      {changed("classes: {1: chair}", "classes: {}", kShort), "names no class"},
      {kWhole + "colour: red\n", ":9: model: unknown key \"colour\"; known are"},
      {"- 1\n", "model: must be a list of \"key: value\""},
      {"a: [\n", "not valid YAML"}};
  for (const auto& [text, expected] : cases) {
    const std::string problem = problem_with(text);
    EXPECT_THAT(problem, HasSubstr(expected)) << text;
    EXPECT_THAT(problem, HasSubstr(folder_.path().string()));
  }
}

TEST_F(ModelYaml, NoPrefixOfAFileIsTakenForAWholeOne) {
  for (std::size_t size = 0; size + 30 < kWhole.size(); ++size) EXPECT_NE(problem_with(kWhole.substr(0, size)), "");
}

}  // namespace
}  // namespace lapis::segmenter
