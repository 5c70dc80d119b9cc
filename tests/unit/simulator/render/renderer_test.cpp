#include "simulator/core/render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "box_scene.hpp"
#include "common/geometry/camera_mount.hpp"
#include "simulator/core/noise/random.hpp"
#include "simulator/core/render/light.hpp"

namespace lapis::simulator {
namespace {

constexpr geometry::PinholeCamera kCamera{162, 90, 81.0, 80.0, 80.5, 44.5};  // not a multiple of the tile

/// Pose of a camera in the room, by its counter.
geometry::Pose some_pose(std::uint64_t i) {
  const Random random(7, RandomStream::kTruth, i);
  const Eigen::Vector3d position(random.uniform(0, 0.3, 3.7), random.uniform(1, 0.3, 2.7), random.uniform(2, 0.3, 2.2));
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(random.uniform(3, -3.1, 3.1), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(random.uniform(4, -0.8, 0.8), Eigen::Vector3d::UnitY()));
  return geometry::make_pose(position, rotation) * geometry::T_link_optical();
}

struct Side {
  double distance = INFINITY;  // along the ray
  int id = 0;
};

/// Where a ray from inside leaves the box of box_scene().
Side exit_of(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d size(4.0, 3.0, 2.5);
  Side best;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_far = direction[axis] > 0.0;
    const double distance = ((is_far ? size[axis] : 0.0) - origin[axis]) / direction[axis];
    if (distance < best.distance) best = {distance, 2 * axis + (is_far ? 2 : 1)};
  }
  return best;
}

TEST(Renderer, DepthLabelsAndAnglesOfABoxAreThoseOfTheClosedForm) {
  const Scene scene = test::box_scene();
  const SceneRaycaster raycaster(scene.mesh);
  const Renderer renderer(scene, raycaster, {});
  for (std::uint64_t i = 0; i < 8; ++i) {
    const auto T = some_pose(i);
    const auto frame = renderer.render(kCamera, T, false);
    int wrong_labels = 0;
    for (int row = 0; row < kCamera.height; ++row) {
      for (int column = 0; column < kCamera.width; ++column) {
        const Eigen::Vector3d direction = T.linear() * kCamera.unproject(column, row, 1.0);
        const Side side = exit_of(T.translation(), direction);
        ASSERT_NEAR(frame.depth(column, row), side.distance, 1e-4)
            << "frame " << i << " pixel " << column << "," << row;
        if (frame.labels(column, row) != side.id) {
          ++wrong_labels;
          continue;
        }
        EXPECT_EQ(frame.instances(column, row), side.id);
        const double cosine = std::abs(direction[(side.id - 1) / 2]) / direction.norm();
        EXPECT_NEAR(frame.cosines(column, row), cosine, 1e-4);
      }
    }
    EXPECT_LE(wrong_labels, 3) << "only rays that hit an edge exactly may differ";
    EXPECT_TRUE(frame.color.empty());
  }
}

TEST(Renderer, ImagesDoNotDependOnTheNumberOfThreads) {
  const Scene scene = test::box_scene();
  const SceneRaycaster raycaster(scene.mesh);
  const auto light = bake_light(scene, raycaster, 1);
  EXPECT_EQ(light, bake_light(scene, raycaster, 3));
  const Renderer one(scene, raycaster, light), three(scene, raycaster, light, {3});
  const auto a = one.render(kCamera, some_pose(1)), b = three.render(kCamera, some_pose(1));
  EXPECT_EQ(a.color.pixels, b.color.pixels);
  EXPECT_EQ(a.depth.pixels, b.depth.pixels);
  EXPECT_EQ(a.labels.pixels, b.labels.pixels);
  EXPECT_EQ(a.instances.pixels, b.instances.pixels);
  EXPECT_EQ(a.cosines.pixels, b.cosines.pixels);
}

/// A camera 1 m in front of a square of 2 m x 2 m in the plane x = 1, looking along +x.
geometry::Pose in_front() {
  return geometry::make_pose({0, 0, 0}, Eigen::Quaterniond::Identity()) * geometry::T_link_optical();
}

Scene textured_square(TextureImage image, bool is_cut_out) {
  Scene scene;
  add_material(scene.mesh, {"m", {255, 255, 255}, -1, is_cut_out}, std::make_shared<TextureImage>(std::move(image)));
  scene.instances.push_back({9, 4, "square"});
  test::add_quad(scene, {{{1, 1, -1}, {1, -1, -1}, {1, -1, 1}, {1, 1, 1}}}, 0, 0);
  return scene;
}

/// Largest difference of a channel.
int difference(const geometry::Rgb8& a, const geometry::Rgb8& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

TEST(Renderer, TextureStandsUpright) {
  TextureImage image(2, 2);
  image(0, 0) = {255, 0, 0};  // upper left
  image(1, 0) = {0, 255, 0};
  image(0, 1) = {0, 0, 255};
  image(1, 1) = {255, 255, 255};
  const Scene scene = textured_square(image, false);
  const SceneRaycaster raycaster(scene.mesh);
  const auto frame = Renderer(scene, raycaster, {}).render({100, 100, 50.0, 50.0, 49.5, 49.5}, in_front());
  EXPECT_LE(difference(frame.color(25, 25), {255, 0, 0}), 6);
  EXPECT_LE(difference(frame.color(75, 25), {0, 255, 0}), 6);
  EXPECT_LE(difference(frame.color(25, 75), {0, 0, 255}), 6);
  EXPECT_LE(difference(frame.color(75, 75), {255, 255, 255}), 6);
}

TEST(Renderer, FarTexturesAreTheirMean) {
  TextureImage board(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) board(x, y) = (x + y) % 2 == 0 ? Rgba8{200, 200, 200} : Rgba8{100, 100, 100};
  }
  const Scene scene = textured_square(board, false);
  const SceneRaycaster raycaster(scene.mesh);
  const auto far = geometry::make_pose({-19, 0, 0}, Eigen::Quaterniond::Identity()) * geometry::T_link_optical();
  const auto frame = Renderer(scene, raycaster, {}).render({101, 101, 300.0, 300.0, 50.0, 50.0}, far);
  for (int column = 40; column <= 60; ++column) EXPECT_NEAR(frame.color(column, 50).r, 150, 2);
}

TEST(Renderer, HolesOfCutOutTexturesShowWhatIsBehind) {
  TextureImage image(2, 2);
  image(0, 0).a = 0;  // upper left
  Scene scene = textured_square(image, true);
  scene.mesh.materials.push_back({"wall", {10, 20, 30}});
  scene.instances.push_back({10, 1, "behind"});
  test::add_quad(scene, {{{3, 9, -9}, {3, -9, -9}, {3, -9, 9}, {3, 9, 9}}}, 1, 1);
  const SceneRaycaster raycaster(scene.mesh);
  const auto frame = Renderer(scene, raycaster, {}).render({100, 100, 50.0, 50.0, 49.5, 49.5}, in_front());
  EXPECT_NEAR(frame.depth(25, 25), 3.0, 1e-5);
  EXPECT_EQ(frame.labels(25, 25), 1);
  EXPECT_EQ(frame.color(25, 25), (geometry::Rgb8{10, 20, 30}));
  EXPECT_NEAR(frame.depth(75, 75), 1.0, 1e-5);
  EXPECT_EQ(frame.instances(75, 75), 9);
  const auto occluded = [&](float z, float y) {
    const Ray ray{{0, y, z}, {1, 0, 0}};
    const float length = 2.0F;
    return raycaster.occluded({&ray, 1}, {&length, 1}) == 1U;
  };
  EXPECT_FALSE(occluded(0.5F, 0.5F)) << "upper left";
  EXPECT_TRUE(occluded(-0.5F, 0.5F));
}

TEST(Renderer, NothingHitIsZeroEverywhere) {
  const Scene scene = textured_square(TextureImage(1, 1), false);
  const SceneRaycaster raycaster(scene.mesh);
  const auto away = in_front() * geometry::make_pose({0, 0, 0}, Eigen::Quaterniond(0, 0, 1, 0));
  const auto frame = Renderer(scene, raycaster, {}).render({20, 20, 10.0, 10.0, 9.5, 9.5}, away);
  EXPECT_EQ(frame.depth.pixels, geometry::DepthImage(20, 20).pixels);
  EXPECT_EQ(frame.labels.pixels, geometry::LabelImage(20, 20).pixels);
  EXPECT_EQ(frame.instances.pixels, geometry::LabelImage(20, 20).pixels);
}

TEST(Light, OpenFloorIsBrighterThanACornerAndShadowsAreDarker) {
  Scene scene = test::box_scene();
  scene.lamps.push_back({{2.0F, 1.5F, 2.2F}, 1.0F});
  scene.mesh.materials.push_back({"table", {90, 90, 90}});
  scene.instances.push_back({7, 7, "table"});
  test::add_quad(scene, {{{1.5F, 1.0F, 1.0F}, {2.5F, 1.0F, 1.0F}, {2.5F, 2.0F, 1.0F}, {1.5F, 2.0F, 1.0F}}}, 1, 6);
  const auto sense = [&](const Eigen::Vector3f& p) {  // a tiny triangle; its first corner
    const auto first = static_cast<std::uint32_t>(scene.mesh.positions.size());
    for (const Eigen::Vector3f& offset : {Eigen::Vector3f(0, 0, 0), {0.001F, 0, 0}, {0, 0.001F, 0}}) {
      scene.mesh.positions.emplace_back(p + offset);
      scene.mesh.texture_coordinates.emplace_back(0, 0);
    }
    scene.mesh.triangles.push_back({{first, first + 1, first + 2}, 0, 4});
    return 3 * (scene.mesh.triangles.size() - 1);
  };
  const auto open = sense({1.0F, 1.5F, 0.0F}), corner = sense({0.02F, 0.02F, 0.0F}), shadow = sense({2.0F, 1.5F, 0.0F});
  const SceneRaycaster raycaster(scene.mesh);
  const auto light = bake_light(scene, raycaster, 1);
  EXPECT_GT(light[open], light[corner] + 20);
  EXPECT_GT(light[open], light[shadow] + 20);
  EXPECT_GT(light[shadow], 60) << "nothing is black";
}

TEST(Light, UnlitScenesAreNotBaked) {
  Scene scene = test::box_scene();
  scene.is_lit = false;
  const SceneRaycaster raycaster(scene.mesh);
  EXPECT_TRUE(bake_light(scene, raycaster, 1).empty());
}

}  // namespace
}  // namespace lapis::simulator
