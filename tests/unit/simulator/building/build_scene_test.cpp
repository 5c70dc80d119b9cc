#include "simulator/core/building/build_scene.hpp"

#include <gtest/gtest.h>

#include "simulator/core/furniture/parametric_furniture.hpp"
#include "simulator/core/scene/polygon.hpp"
#include "small_building.hpp"

namespace lapis::simulator {
namespace {

SceneSpec furnished() {
  SceneSpec spec = test::two_rooms();
  const char* classes[] = {"sofa", "table", "cabinet"};
  for (int i = 0; i < 3; ++i) {
    FurnitureSpec item;
    item.class_name = classes[i];
    item.model = i == 2 ? "" : "Library#" + std::to_string(i);
    item.place = AtPoint{{1.0 + i, 1.5}, 0.0};
    item.is_movable = true;
    spec.furniture.push_back(item);
  }
  PictureSpec picture;
  picture.room = "left";
  picture.edge = 2;
  for (const double along : {0.5, 1.5, 2.5, 3.5}) {
    picture.along_m = along;
    spec.pictures.push_back(picture);
  }
  return spec;
}

Eigen::AlignedBox3f bounds_of(const Scene& scene, const std::string& name) {
  Eigen::AlignedBox3f box;
  for (const auto& t : scene.mesh.triangles) {
    if (scene.instances[t.part].name != name) continue;
    for (const auto v : t.vertices) box.extend(scene.mesh.positions[v]);
  }
  return box;
}

int count_of(const Scene& scene, const std::string& class_name) {
  int count = 0;
  for (const auto& instance : scene.instances) count += scene.labels.name(instance.class_id) == class_name ? 1 : 0;
  return count;
}

/// A box of 1 m with the given names.
SourcedModel box_model(const std::string& material, double elevation_m) {
  TextureLibrary textures;
  SourcedModel model;
  model.mesh = make_furniture("beam", {1, 1, 1}, 0, textures);
  model.mesh.materials[0].name = material;
  model.groups = {"body"};
  model.elevation_m = elevation_m;
  model.credit = Credit{"Box", "Somebody", "CC0"};
  return model;
}

TEST(BuildScene, IsAFunctionOfItsArguments) {
  const Scene a = build_scene(furnished(), {}, {.seed = 3}), b = build_scene(furnished(), {}, {.seed = 3});
  EXPECT_EQ(problem_of(a.mesh), "");
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.texture_coordinates, b.mesh.texture_coordinates);
  ASSERT_EQ(a.mesh.textures.size(), b.mesh.textures.size());
  for (std::size_t i = 0; i < a.mesh.textures.size(); ++i)
    EXPECT_EQ(a.mesh.textures[i]->pixels, b.mesh.textures[i]->pixels);
  EXPECT_NE(build_scene(furnished(), {}, {.seed = 4}).mesh.positions, a.mesh.positions);
  EXPECT_EQ(build_scene(furnished(), {}, {.seed = 3, .with_jitter = false}).mesh.positions,
            build_scene(furnished(), {}, {.seed = 4, .with_jitter = false}).mesh.positions);
}

TEST(BuildScene, EveryTriangleBelongsToAnInstanceWithAClass) {
  const Scene scene = build_scene(furnished(), {});
  for (const auto& t : scene.mesh.triangles) ASSERT_LT(t.part, scene.instances.size());
  for (const auto& instance : scene.instances) EXPECT_TRUE(scene.labels.contains(instance.class_id)) << instance.name;
}

TEST(BuildScene, WithoutACatalogueOneWarningAndFurnitureOfTheSameSize) {
  SceneSpec spec = furnished();
  spec.furniture[0].size_m = Eigen::Vector3d(1.5, 0.8, 0.7);
  const Scene scene = build_scene(spec, {}, {.with_jitter = false});
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_NE(scene.warnings[0].find("sweethome3d-furniture"), std::string::npos);
  EXPECT_TRUE(bounds_of(scene, "sofa#1").sizes().isApprox(Eigen::Vector3f(1.5F, 0.8F, 0.7F), 1e-4F));
  EXPECT_TRUE(bounds_of(scene, "table#2").sizes().isApprox(default_size_m("table").cast<float>(), 1e-4F));
}

TEST(BuildScene, ModelsAreFittedCreditedAndRefusedWithOneWarningPerCause) {
  SceneSpec spec = furnished();
  spec.furniture[0].size_m = Eigen::Vector3d(1.5, 0.8, 0.7);
  spec.furniture.push_back(spec.furniture[1]);
  std::get<AtPoint>(spec.furniture.back().place).at = {5, 1.5};
  const FurnitureSource source = [](const FurnitureSpec& item) -> std::variant<SourcedModel, SourceRefusal> {
    if (item.model == "Library#1") return SourceRefusal{"the catalogue has no Library#1"};
    return box_model("oak", 0.3);
  };
  const Scene scene = build_scene(spec, source, {.with_jitter = false});
  EXPECT_EQ(scene.warnings, std::vector<std::string>{"the catalogue has no Library#1"});
  EXPECT_EQ(scene.credits, (std::vector<Credit>{{"Box", "Somebody", "CC0"}}));
  const auto sofa = bounds_of(scene, "sofa#1");
  EXPECT_TRUE(sofa.sizes().isApprox(Eigen::Vector3f(1.5F, 0.8F, 0.7F), 1e-4F));
  EXPECT_NEAR(sofa.min().z(), 0.3, 1e-5);
}

TEST(BuildScene, PartsOfAModelMayHaveAnotherClass) {
  SceneSpec spec = furnished();
  spec.furniture.resize(1);
  const FurnitureSource source = [](const FurnitureSpec&) { return box_model("glass", 0.0); };
  spec.furniture[0].parts = {{"glass", "mirror"}};
  EXPECT_EQ(count_of(build_scene(spec, source), "mirror"), 1);
  spec.furniture[0].parts = {{"body", "mirror"}};
  EXPECT_EQ(count_of(build_scene(spec, source), "mirror"), 1);
  spec.furniture[0].parts = {{"legs", "mirror"}};
  const Scene scene = build_scene(spec, source);
  EXPECT_EQ(count_of(scene, "mirror"), 0);
  EXPECT_EQ(scene.warnings, std::vector<std::string>{R"(item "sofa#1": Library#0 has no part legs)"});
}

TEST(BuildScene, PicturesHangOnTheirWallAndDensityLeavesSomeOut) {
  const Scene scene = build_scene(furnished(), {});
  EXPECT_EQ(count_of(scene, "picture"), 4);
  const auto first = bounds_of(scene, "left/picture 1");  // wall 2 runs from x = 4 to x = 0 at y = 3
  EXPECT_NEAR(first.center().x(), 3.5, 0.101);
  EXPECT_NEAR(first.max().y(), 3.0, 0.003);
  EXPECT_LT(first.max().y(), 3.0F);
  EXPECT_NEAR(first.sizes().y(), 0.02, 0.002);
  EXPECT_EQ(count_of(build_scene(furnished(), {}, {.pictures_density = 0.0}), "picture"), 0);
  int hung = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed)
    hung += count_of(build_scene(furnished(), {}, {.seed = seed, .pictures_density = 0.5}), "picture");
  EXPECT_NEAR(hung, 60, 22);  // four standard deviations
}

TEST(BuildScene, LampsHangInTheirRoomsOnePerTwelveSquareMetres) {
  SceneSpec spec = furnished();
  spec.rooms[0].polygon = {{-8, 0}, {4, 0}, {4, 3}, {-5, 3}, {-5, 6}, {-8, 6}};  // 45 m2 with a bend
  const Scene scene = build_scene(spec, {});
  int inside = 0;
  for (const auto& lamp : scene.lamps)
    inside += contains(spec.rooms[0].polygon, Eigen::Vector2d(lamp.position.head<2>().cast<double>())) ? 1 : 0;
  EXPECT_EQ(inside, 4);
  EXPECT_EQ(scene.lamps.size(), 5U);
  spec.lamps = {{{1, 1}, 2.0, 0.7}};
  const Scene one = build_scene(spec, {});
  ASSERT_EQ(one.lamps.size(), 1U);
  EXPECT_NEAR(one.lamps[0].position.z(), 2.0, 0.06);
  EXPECT_FLOAT_EQ(one.lamps[0].intensity, 0.7F);
}

}  // namespace
}  // namespace lapis::simulator
