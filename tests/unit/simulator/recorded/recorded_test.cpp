// Recorded frames against the renderer: the loop in data/rgbd was drawn by another renderer from the same house.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "sensor_replay/camera_yaml.hpp"
#include "sensor_replay/core/tum_dataset.hpp"
#include "simulator/core/loaders/load_scene.hpp"
#include "simulator/core/render/renderer.hpp"
#include "tests/support/test_data.hpp"

namespace lapis::simulator {
namespace {

constexpr double kTolerance_m = 0.02;
constexpr std::size_t kEvery = 8;  // frames

struct Agreement {
  std::size_t pixels = 0;  // that have depth in either image
  std::size_t near = 0;
  std::size_t labelled = 0;  // pixels of both images that have depth
  std::size_t same_label = 0;
};

void compare(const sensor_replay::ReplayFrame& recorded, const RenderedFrame& rendered, Agreement& sum) {
  for (std::size_t i = 0; i < rendered.depth.pixels.size(); ++i) {
    const double a = recorded.depth->pixels[i] * 1e-3, b = rendered.depth.pixels[i];
    if (a == 0.0 && b == 0.0) continue;
    ++sum.pixels;
    if (a == 0.0 || b == 0.0) continue;
    if (std::abs(a - b) <= kTolerance_m) ++sum.near;
    ++sum.labelled;
    if (recorded.label->pixels[i] == rendered.labels.pixels[i]) ++sum.same_label;
  }
}

TEST(RecordedFrames, DepthAndLabelsOfTheHouseAreReproduced) {
  const auto house = test::find_test_data("environments/aws_small_house/scene_labelled.ply");
  const auto recording = test::find_test_data("rgbd/aws_small_house_loop");
  if (!house || !recording) GTEST_SKIP() << test::missing_test_data("environments/aws_small_house");
  const Scene scene = load_scene(*house, {});
  const SceneRaycaster raycaster(scene.mesh);
  const Renderer renderer(scene, raycaster, {});
  const sensor_replay::TumDataset loop({*recording, {}, 0.02}, sensor_replay::read_camera_file);
  Agreement sum;
  for (std::size_t i = 0; i < loop.size(); i += kEvery) {
    const auto loaded = loop.load_frame(i);
    const auto& recorded = std::get<sensor_replay::ReplayFrame>(loaded);
    compare(recorded, renderer.render(loop.camera().camera, *recorded.T_world_camera, false), sum);
  }
  const double near = static_cast<double>(sum.near) / static_cast<double>(sum.pixels);
  const double same = static_cast<double>(sum.same_label) / static_cast<double>(sum.labelled);
  RecordProperty("within_2_cm", std::to_string(near));
  RecordProperty("labels_equal", std::to_string(same));
  std::cout << "depth within 2 cm: " << near << ", labels equal: " << same << "\n";
  EXPECT_GE(near, 0.99);
  EXPECT_GE(same, 0.99);
}

TEST(RecordedFrames, TheDuplexLoadsAndRenders) {
  const auto duplex = test::find_test_data("environments/ifc_duplex");
  if (!duplex) GTEST_SKIP() << test::missing_test_data("environments/ifc_duplex");
  const Scene scene = load_scene(*duplex, {});
  const SceneRaycaster raycaster(scene.mesh);
  const Renderer renderer(scene, raycaster, {});
  // In the foyer of dwelling A (rooms.csv), 1 m above its floor, looking along +y.
  geometry::Pose T = geometry::Pose::Identity();
  T.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  T.translation() << 7.3, -16.0, 1.02;
  const auto frame = renderer.render({64, 36, 32.0, 32.0, 31.5, 17.5}, T);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < frame.depth.pixels.size(); ++i) {
    if (frame.depth.pixels[i] > 0.0F && frame.labels.pixels[i] > 0) ++seen;
  }
  EXPECT_GT(seen, frame.depth.pixels.size() * 9 / 10) << "a foyer is closed all around";
}

}  // namespace
}  // namespace lapis::simulator
