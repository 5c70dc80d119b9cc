#include "simulator/core/loaders/hm3d.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using test::Files;
using test::GltfBuilder;
using test::MemoryStore;
using test::to_bytes;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Mapping = std::optional<std::map<std::string, std::string>>;

Scene load_hm3d_files(const Files& files, const Mapping& mapping = std::nullopt, const LoadOptions& options = {}) {
  return load_hm3d(MemoryStore(files), "h", mapping, options);
}

std::string list_error(const std::string& lines) {
  return test::error_of([&] { parse_hm3d_instances("HM3D Semantic Annotations\n" + lines, "h.semantic.txt"); });
}

TEST(Hm3d, TexelsTellInstances) {
  const Scene scene = load_hm3d_files(test::hm3d_files());
  EXPECT_EQ(problem_of(scene.mesh), "");
  ASSERT_EQ(scene.mesh.triangles.size(), 2U);
  const auto part = [&](std::size_t i) { return scene.instances[scene.mesh.triangles[i].part]; };
  EXPECT_EQ(part(0).id, 1);
  EXPECT_EQ(part(1).id, 2);
  EXPECT_EQ(scene.labels.name(part(1).class_id), "armchair, red");
  EXPECT_EQ(scene.instances.size(), 3U);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("hm3dsem_category_mappings.tsv")));
}

TEST(Hm3d, LooksComeFromTheOtherFile) {
  const Scene scene = load_hm3d_files(test::hm3d_files());
  ASSERT_EQ(scene.mesh.textures.size(), 1U);
  EXPECT_EQ(scene.mesh.textures[0]->pixels[0], (Rgba8{90, 80, 70, 255}));
  EXPECT_FALSE(scene.is_lit);
  Files files = test::hm3d_files();
  files.erase("h.glb");
  const Scene plain = load_hm3d_files(files);
  EXPECT_THAT(plain.mesh.textures, IsEmpty());
  EXPECT_EQ(plain.mesh.materials[plain.mesh.triangles[1].material].color, (geometry::Rgb8{0, 0xFF, 0x20}));
  EXPECT_THAT(plain.warnings, Contains(HasSubstr("no h.glb with the same triangles")));
  EXPECT_EQ(problem_of(plain.mesh), "");
}

TEST(Hm3d, LooksNeedTheSameTriangles) {
  Files files = test::hm3d_files();
  GltfBuilder other;
  other.add_node({{"mesh", add_triangle_mesh(other)}});
  files["h.glb"] = other.glb();
  EXPECT_THAT(load_hm3d_files(files).warnings, Contains(HasSubstr("with the same triangles")));
}

TEST(Hm3d, VertexColorsTellInstancesWhereThereIsNoTexture) {
  Files files = test::hm3d_files();
  GltfBuilder builder;
  const std::size_t mesh = add_triangle_mesh(builder);
  builder.root["meshes"][mesh]["primitives"][0]["attributes"]["COLOR_0"] =
      builder.add_accessor({0, 255, 32, 255, 0, 255, 32, 255, 9, 9, 9, 255}, 5121, "VEC4", 3, 0, true);
  builder.add_node({{"mesh", mesh}});
  files["h.semantic.glb"] = builder.glb();
  const Scene scene = load_hm3d_files(files);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[0].part].id, 2);
}

TEST(Hm3d, ColorsThatAreNotListedAreUnlabelled) {
  Files files = test::hm3d_files();
  files["h.semantic.txt"] = to_bytes("HM3D Semantic Annotations\n1,FF0010,\"floor\",0\n");
  const Scene scene = load_hm3d_files(files);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[1].part].class_id, 0);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[1].part].id, 2);
}

TEST(Hm3d, TheMappingLeadsToTheClassesOfTheList) {
  const auto bytes = test::hm3d_mapping();
  const auto mapping = parse_hm3d_mapping({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "m.tsv");
  const auto labels = mapping::LabelList::from_names({{2, "floor"}, {3, "chair"}});
  const Scene scene = load_hm3d_files(test::hm3d_files(), mapping, {labels, 64});
  EXPECT_EQ(scene.labels, labels);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[1].part].class_id, 3);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("1 categories are not in")));  // the lamp
  EXPECT_THAT(test::error_of([] { parse_hm3d_mapping("a\tb\n", "m.tsv"); }), HasSubstr("m.tsv: line 1"));
}

TEST(Hm3d, UpIsZ) { EXPECT_FLOAT_EQ(bounds(load_hm3d_files(test::hm3d_files()).mesh).max().z(), 0.0F); }

TEST(Hm3d, LooksInTheBasisFormatAreNotRead) {
  Files files = test::hm3d_files();
  files["h.basis.glb"] = files.extract("h.glb").mapped();
  EXPECT_THAT(load_hm3d_files(files).warnings, Contains(HasSubstr(".basis.glb is not read")));
}

TEST(Hm3d, ErrorsNameFileAndLine) {
  EXPECT_THAT(test::error_of([] { parse_hm3d_instances("1,FF0000,\"a\",0\n", "h.semantic.txt"); }),
              HasSubstr("line 1"));
  EXPECT_THAT(list_error("\n1,FF000,\"a\",0\n"), HasSubstr("h.semantic.txt: line 3: must be id,RRGGBB"));
  EXPECT_THAT(list_error("x,FF0000,\"a\",0\n"), HasSubstr("line 2"));
  EXPECT_THAT(list_error("1,FF0000\n"), HasSubstr("line 2"));
  EXPECT_THAT(list_error("1,FF0000,a,0\n2,FF0000,b,0\n"), HasSubstr("FF0000 occurs twice"));
  Files files = test::hm3d_files();
  files["h.semantic.txt"] = to_bytes("HM3D Semantic Annotations\n0,FF0010,a,0\n");
  EXPECT_THAT(test::error_of([&] { load_hm3d_files(files); }), HasSubstr("instance 0"));
  for (const char* name : {"h.semantic.glb", "h.semantic.txt"}) {
    files = test::hm3d_files();
    files.erase(name);
    EXPECT_THAT(test::error_of([&] { load_hm3d_files(files); }), HasSubstr(std::string("memory/") + name));
    files[name] = {};
    EXPECT_THAT(test::error_of([&] { load_hm3d_files(files); }), HasSubstr("0 bytes"));
  }
}

}  // namespace
}  // namespace lapis::simulator
