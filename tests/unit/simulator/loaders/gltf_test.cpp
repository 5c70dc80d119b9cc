#include "simulator/core/loaders/gltf.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;
using test::Bytes;
using test::Files;
using test::GltfBuilder;
using test::MemoryStore;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

GltfModel load(const Files& files, const std::string& name) { return read_gltf(MemoryStore(files), name); }

GltfModel load(const GltfBuilder& builder) { return load({{"a.glb", builder.glb()}}, "a.glb"); }

std::string load_error(const Files& files, const std::string& name) {
  return test::error_of([&] { read_gltf(MemoryStore(files), name); });
}

std::string load_error(const GltfBuilder& builder) { return load_error({{"a.glb", builder.glb()}}, "a.glb"); }

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.texture_coordinates, b.texture_coordinates);
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) EXPECT_EQ(a.triangles[i].vertices, b.triangles[i].vertices);
}

GltfBuilder triangle_scene() {
  GltfBuilder builder;
  builder.add_node({{"mesh", add_triangle_mesh(builder)}});
  return builder;
}

TEST(Gltf, OneFileSeveralFilesAndDataAddressesHoldTheSame) {
  const GltfBuilder builder = test::labelled_gltf();
  const GltfModel binary = load(builder);
  expect_same(binary.model.mesh, load(builder.separate("my house"), "my house.gltf").model.mesh);
  expect_same(binary.model.mesh, load({{"a.gltf", builder.embedded()}}, "a.gltf").model.mesh);
  Files deep;
  for (const auto& [name, bytes] : builder.separate("b")) deep["x/" + name] = bytes;
  expect_same(binary.model.mesh, load(deep, "x/b.gltf").model.mesh);
}

TEST(Gltf, NodesAreGroupsWithParentsAndClasses) {
  const GltfModel scene = load(test::labelled_gltf());
  EXPECT_THAT(scene.model.groups, ElementsAre("house", "chair", "wall"));
  EXPECT_THAT(scene.parents, ElementsAre(-1, 0, 0));
  EXPECT_THAT(scene.classes, ElementsAre("", "chair", ""));
  ASSERT_EQ(scene.model.mesh.triangles.size(), 2U);
  EXPECT_EQ(scene.model.mesh.triangles[0].part + scene.model.mesh.triangles[1].part, 3U);
  EXPECT_FLOAT_EQ(bounds(scene.model.mesh).max().z(), 3.0F);
}

TEST(Gltf, TransformsOfParentAndChildAreChained) {
  GltfBuilder builder;
  const double half = std::sqrt(0.5);
  builder.add_node(
      {{"translation", {1, 2, 3}}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}, {"children", {1}}});
  builder.root["nodes"].push_back({{"mesh", add_triangle_mesh(builder)}, {"translation", {1, 0, 0}}});
  const Mesh mesh = load(builder).model.mesh;
  // By hand: (x, y, z) -> 2 * (-y, x + 1, z) + (1, 2, 3)
  ASSERT_EQ(mesh.positions.size(), 3U);
  EXPECT_LT((mesh.positions[0] - Eigen::Vector3f(1, 4, 3)).norm(), 1e-6F);
  EXPECT_LT((mesh.positions[1] - Eigen::Vector3f(1, 6, 3)).norm(), 1e-6F);
  EXPECT_LT((mesh.positions[2] - Eigen::Vector3f(-1, 4, 3)).norm(), 1e-6F);
}

TEST(Gltf, AMatrixIsColumnByColumn) {
  GltfBuilder builder;
  builder.add_node(
      {{"mesh", add_triangle_mesh(builder)}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}});
  const Mesh mesh = load(builder).model.mesh;
  EXPECT_EQ(mesh.positions[0], Eigen::Vector3f(5, 6, 7));
  EXPECT_EQ(mesh.positions[1], Eigen::Vector3f(5, 8, 7));
  EXPECT_EQ(mesh.positions[2], Eigen::Vector3f(3, 6, 7));
}

TEST(Gltf, AMeshMayBeShownTwice) {
  GltfBuilder builder;
  const std::size_t mesh = add_triangle_mesh(builder);
  builder.add_node({{"mesh", mesh}});
  builder.add_node({{"mesh", mesh}, {"translation", {0, 0, 1}}});
  const GltfModel scene = load(builder);
  EXPECT_EQ(scene.model.mesh.triangles.size(), 2U);
  EXPECT_EQ(scene.model.groups[0], "node 0");
}

TEST(Gltf, OnlyTheDefaultSceneIsShown) {
  GltfBuilder builder = triangle_scene();
  builder.add_node({{"mesh", 0}});
  builder.root["scenes"] = json::array({{{"nodes", {0}}}, {{"nodes", {1}}}});
  builder.root["scene"] = 1;
  const GltfModel scene = load(builder);
  ASSERT_EQ(scene.model.mesh.triangles.size(), 1U);
  EXPECT_EQ(scene.model.mesh.triangles[0].part, 1U);
  builder.root.erase("scenes");
  builder.root.erase("scene");
  EXPECT_EQ(load(builder).model.mesh.triangles.size(), 2U);  // all nodes without parent
}

TEST(Gltf, InterleavedAndNormalisedNumbersAreRead) {
  GltfBuilder builder;
  // x, y, z as float, then u, v as ushort: a stride of 16 bytes
  Bytes bytes(3 * 16, 0);
  const auto put = [&](std::size_t at, const auto& value) { std::memcpy(bytes.data() + at, &value, sizeof(value)); };
  for (std::size_t i = 0; i < 3; ++i) {
    put(i * 16, static_cast<float>(i));
    put(i * 16 + 4, static_cast<float>(i * i));
    put(i * 16 + 12, static_cast<std::uint16_t>(i == 1 ? 65535 : 0));
    put(i * 16 + 14, static_cast<std::uint16_t>(i == 2 ? 13107 : 0));
  }
  const std::size_t positions = builder.add_accessor(bytes, 5126, "VEC3", 3, 16);
  json coordinates = builder.root["accessors"][positions];
  coordinates.update({{"componentType", 5123}, {"type", "VEC2"}, {"byteOffset", 12}, {"normalized", true}});
  builder.root["accessors"].push_back(coordinates);
  builder.add_node(
      {{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", positions + 1}}}})}});
  const Mesh mesh = load(builder).model.mesh;
  EXPECT_THAT(mesh.positions,
              ElementsAre(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 1, 0), Eigen::Vector3f(2, 4, 0)));
  EXPECT_FLOAT_EQ(mesh.texture_coordinates[1].x(), 1.0F);
  EXPECT_FLOAT_EQ(mesh.texture_coordinates[2].y(), 0.8F);  // glTF counts from the upper edge
}

TEST(Gltf, StripsAndFansBecomeTriangles) {
  using Corners = std::array<std::uint32_t, 3>;
  const auto triangles = [](int mode) {
    GltfBuilder builder;
    const std::size_t positions = builder.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0}, 3);
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}},
                                                 {"indices", builder.add_indices({0, 1, 2, 3, 4})},
                                                 {"mode", mode}})}});
    std::vector<Corners> result;
    for (const auto& triangle : load(builder).model.mesh.triangles) result.push_back(triangle.vertices);
    return result;
  };
  EXPECT_THAT(triangles(4), ElementsAre(Corners{0, 1, 2}));
  EXPECT_THAT(triangles(5), ElementsAre(Corners{0, 1, 2}, Corners{1, 3, 2}, Corners{2, 3, 4}));
  EXPECT_THAT(triangles(6), ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 3, 4}));
}

TEST(Gltf, ColorsAreLinearInTheFileAndSrgbAfterwards) {
  GltfBuilder builder = test::labelled_gltf();
  const Bytes colors{0, 55, 255, 255, 0, 0, 55, 0, 0};
  builder.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      builder.add_accessor(colors, 5121, "VEC3", 3, 0, true);
  GltfModel scene = load(builder);
  EXPECT_EQ(scene.model.mesh.colors[0].g + scene.model.mesh.colors[3].g, 55 + 255);  // the other triangle is white
  finish_looks(scene, 64);
  const auto& painted =
      scene.model.mesh.triangles[0].part == 2 ? scene.model.mesh.triangles[0] : scene.model.mesh.triangles[1];
  // IEC 61966-2-1: 55/255 -> 128/255, 0.5 -> 188/255
  EXPECT_EQ(scene.model.mesh.colors[painted.vertices[0]], (geometry::Rgb8{0, 128, 255}));
  EXPECT_EQ(scene.model.mesh.materials[painted.material].color, (geometry::Rgb8{255, 188, 0}));
}

TEST(Gltf, TexturesInsideAndBesideTheFileAreDecoded) {
  GltfBuilder builder;
  const std::size_t inner = builder.add_textured_material(builder.add_image(test::png(4, 4, {1, 2, 3, 255})));
  const std::size_t outer = builder.add_textured_material(builder.root["images"].size());
  builder.root["images"].push_back({{"uri", "my%20wall.png"}});
  builder.add_node({{"mesh", add_triangle_mesh(builder, inner)}});
  builder.add_node({{"mesh", add_triangle_mesh(builder, outer)}});
  GltfModel scene = load({{"a.glb", builder.glb()}, {"my wall.png", test::png(2, 2, {9, 9, 9, 0})}}, "a.glb");
  finish_looks(scene, 2);
  ASSERT_EQ(scene.model.mesh.textures.size(), 2U);
  EXPECT_EQ(scene.model.mesh.textures[0]->width, 2);
  EXPECT_THAT(scene.model.warnings, IsEmpty());
  EXPECT_FALSE(scene.model.mesh.materials[0].is_cut_out);  // alphaMode is OPAQUE
}

TEST(Gltf, HolesNeedAlphaModeAndTexture) {
  GltfBuilder builder;
  const std::size_t leaf = builder.add_textured_material(builder.add_image(test::png(4, 4, {1, 2, 3, 0})));
  builder.root["materials"][leaf]["alphaMode"] = "MASK";
  builder.root["materials"].push_back({{"alphaMode", "MASK"}});
  builder.root["materials"].push_back(
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.1}}}}});
  for (const std::size_t material : {leaf, leaf + 1, leaf + 2})
    builder.add_node({{"mesh", add_triangle_mesh(builder, material)}});
  GltfModel scene = load(builder);
  finish_looks(scene, 64);
  ASSERT_EQ(scene.model.mesh.triangles.size(), 2U);  // glass is left out
  for (const auto& triangle : scene.model.mesh.triangles)
    EXPECT_EQ(scene.model.mesh.materials[triangle.material].is_cut_out, triangle.part == 0);
}

TEST(Gltf, TexturesThatCannotBeReadAreGreyWithAWarning) {
  GltfBuilder builder;
  const Bytes ktx2{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
  const std::size_t first = builder.add_textured_material(builder.add_image(ktx2));
  const std::size_t second = builder.add_textured_material(builder.add_image(ktx2));
  builder.root["textures"][1] = {{"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}};
  const std::size_t missing = builder.add_textured_material(builder.root["images"].size());
  builder.root["images"].push_back({{"uri", "gone.jpg"}});
  for (const std::size_t material : {first, second, missing})
    builder.add_node({{"mesh", add_triangle_mesh(builder, material)}});
  GltfModel scene = load(builder);
  finish_looks(scene, 64);
  EXPECT_THAT(scene.model.mesh.textures, IsEmpty());
  EXPECT_THAT(scene.model.warnings, ElementsAre(testing::AllOf(HasSubstr("3 textures ('gone.jpg' for one)"),
                                                               HasSubstr("2 of them are in the Basis format"))));
  EXPECT_EQ(problem_of(scene.model.mesh), "");
}

TEST(Gltf, OneTextureThatCannotBeReadIsAWarningToo) {
  const json no_image = {{"sampler", 0}}, other = {{"extensions", {{"MSFT_texture_dds", {{"source", 0}}}}}};
  for (const json& texture : {no_image, other}) {
    GltfBuilder builder;
    const std::size_t material = builder.add_textured_material(builder.add_image(test::png(4, 4, {1, 2, 3, 255})));
    builder.root["textures"][0] = texture;
    builder.add_node({{"mesh", add_triangle_mesh(builder, material)}});
    GltfModel scene = load(builder);
    finish_looks(scene, 64);
    EXPECT_THAT(scene.model.warnings, ElementsAre(HasSubstr("1 textures ('a texture without PNG or JPEG' for one)")));
    EXPECT_EQ(scene.model.mesh.materials[0].color, (geometry::Rgb8{160, 160, 160}));
  }
}

TEST(Gltf, OnlyImagesThatAreShownAreFetchedAndOnce) {
  GltfBuilder builder;
  const std::size_t first = builder.add_textured_material(builder.add_image(test::png(4, 4, {1, 2, 3, 255})));
  const std::size_t second = builder.add_textured_material(0);
  builder.add_textured_material(builder.add_image(test::png(4, 4, {4, 5, 6, 255})));
  for (const std::size_t material : {first, second}) builder.add_node({{"mesh", add_triangle_mesh(builder, material)}});
  GltfModel scene = load(builder);
  EXPECT_EQ(scene.images.size(), 1U);
  finish_looks(scene, 64);
  EXPECT_EQ(scene.model.mesh.textures.size(), 1U);
  EXPECT_EQ(scene.model.mesh.materials[0].texture, 0);
  EXPECT_EQ(scene.model.mesh.materials[1].texture, 0);
}

TEST(Gltf, RequiredExtensionsAreKnownOrRefused) {
  const auto error = [](const std::string& extension) {
    GltfBuilder builder = triangle_scene();
    builder.root["extensionsRequired"] = {"KHR_materials_unlit", extension};
    return load_error(builder);
  };
  EXPECT_EQ(error("KHR_mesh_quantization"), "");
  EXPECT_THAT(error("KHR_draco_mesh_compression"), HasSubstr("export without compression"));
  EXPECT_THAT(error("EXT_meshopt_compression"), HasSubstr("export without compression"));
  EXPECT_THAT(error("KHR_texture_basisu"), HasSubstr("(KTX2: KHR_texture_basisu), which is not read; export them as"));
  EXPECT_THAT(error("KHR_texture_transform"),
              testing::AllOf(HasSubstr("memory/a.glb: the file requires KHR_texture_transform"),
                             HasSubstr("are read: KHR_materials_unlit, KHR_mesh_quantization")));
}

TEST(Gltf, EveryTruncatedFileIsRefused) {
  const Bytes glb = test::labelled_gltf().glb();
  for (std::size_t size = 0; size < glb.size(); ++size) {
    const Bytes part(glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(size));
    const std::string error = load_error({{"a.glb", part}}, "a.glb");
    ASSERT_THAT(error, HasSubstr("memory/a.glb: ")) << size;
    ASSERT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(Gltf, RefusesWhatLeavesItsBuffer) {
  GltfBuilder builder = triangle_scene();
  builder.root["accessors"][0]["count"] = 4;
  EXPECT_THAT(load_error(builder), HasSubstr("accessors[0] leaves its buffer view"));
  builder.root["accessors"][0]["count"] = 18446744073709551615ULL;
  EXPECT_THAT(load_error(builder), HasSubstr("leaves its buffer view"));
  builder = triangle_scene();
  builder.root["accessors"][0]["byteOffset"] = 18446744073709551615ULL;
  EXPECT_THAT(load_error(builder), HasSubstr("leaves its buffer view"));
  builder = triangle_scene();
  builder.root["bufferViews"][0]["byteOffset"] = 1 << 20;
  EXPECT_THAT(load_error(builder), HasSubstr("bufferViews[0] leaves its buffer"));
  builder = triangle_scene();
  builder.root["bufferViews"][0]["byteStride"] = 4;
  EXPECT_THAT(load_error(builder), HasSubstr("leaves its buffer view"));
  builder = triangle_scene();
  builder.root["meshes"][0]["primitives"][0]["indices"] = builder.add_indices({0, 1, 3});
  EXPECT_THAT(load_error(builder), HasSubstr("a vertex that is not there"));
  Files files = triangle_scene().separate("a");
  files["a.bin"].pop_back();
  EXPECT_THAT(load_error(files, "a.gltf"), HasSubstr("buffer 0 ('a.bin') has 35 bytes, not the 36"));
  files.erase("a.bin");
  EXPECT_THAT(load_error(files, "a.gltf"), HasSubstr("'a.bin') is not there"));
}

TEST(Gltf, RefusesNodesThatAreNoTree) {
  GltfBuilder builder = triangle_scene();
  builder.root["nodes"][0]["children"] = {0};
  EXPECT_THAT(load_error(builder), HasSubstr("no tree"));
  builder.root["nodes"] = json::array({{{"mesh", 0}}, {{"children", {0, 2}}}, {{"children", {1}}}});
  EXPECT_THAT(load_error(builder), HasSubstr("no tree"));  // the cycle is above what the scene shows
  builder.root["nodes"] = json::array({{{"mesh", 0}}, {{"children", {0}}}, {{"children", {0}}}});
  EXPECT_THAT(load_error(builder), HasSubstr("no tree"));
  builder.root["nodes"] = json::array({{{"mesh", 0}, {"children", {7}}}});
  EXPECT_THAT(load_error(builder), HasSubstr("no tree"));
  builder.root["nodes"] = json::array({{{"mesh", 0}}});
  builder.root["scenes"][0]["nodes"] = {0, 0};
  EXPECT_THAT(load_error(builder), HasSubstr("twice"));
  builder.root["scenes"][0]["nodes"] = {1};
  EXPECT_THAT(load_error(builder), HasSubstr("not there"));
}

TEST(Gltf, RefusesWhatItDoesNotRead) {
  GltfBuilder builder = triangle_scene();
  builder.root["accessors"][0]["sparse"] = {{"count", 1}};
  EXPECT_THAT(load_error(builder), HasSubstr("sparse"));
  builder = triangle_scene();
  builder.root["asset"]["version"] = "1.0";
  EXPECT_THAT(load_error(builder), HasSubstr("glTF 2.0"));
  builder = triangle_scene();
  builder.root["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_THAT(load_error(builder), HasSubstr("no visible triangles"));
  EXPECT_THAT(load_error({}, "a.glb"), HasSubstr("memory/a.glb: no readable file"));
  EXPECT_THAT(load_error({{"a.gltf", {}}}, "a.gltf"), HasSubstr("0 bytes"));
  EXPECT_THAT(load_error({{"a.gltf", test::to_bytes("{\"asset\": ")}}, "a.gltf"), HasSubstr("no valid JSON"));
  EXPECT_THAT(load_error({{"a.gltf", test::to_bytes("[1]")}}, "a.gltf"), HasSubstr("no JSON object"));
  EXPECT_THAT(load_error({{"a.gltf", test::to_bytes("{\"a\": 1e999}")}}, "a.gltf"), HasSubstr("number"));
}

TEST(Gltf, ValuesMayBeNestedDeep) {
  const Bytes plain = test::labelled_gltf().embedded();
  std::string text(plain.begin(), plain.end());
  const std::string key = R"("name":"paint")";
  const std::size_t at = text.find(key);
  ASSERT_NE(at, std::string::npos);
  constexpr std::size_t kDepth = 300'000;
  text.insert(at, "\"extras\":" + std::string(kDepth, '[') + std::string(kDepth, ']') + ",");
  EXPECT_EQ(load({{"a.gltf", test::to_bytes(text)}}, "a.gltf").model.mesh.triangles.size(), 2U);
}

TEST(Gltf, WrongTypesInTheTextAreErrors) {
  const auto with = [](const json::json_pointer& place, const json& value) {
    GltfBuilder builder = triangle_scene();
    builder.root[place] = value;
    return load_error(builder);
  };
  using Place = json::json_pointer;
  EXPECT_THAT(with(Place("/nodes"), "x"), HasSubstr("'nodes' must be an array"));
  EXPECT_THAT(with(Place("/nodes/0/mesh"), -1), HasSubstr("'mesh' must be a whole number"));
  EXPECT_THAT(with(Place("/nodes/0/mesh"), 7), HasSubstr("no meshes[7]"));
  EXPECT_THAT(with(Place("/nodes/0/translation"), json::array({1, 2})), HasSubstr("'translation' must be 3 numbers"));
  EXPECT_THAT(with(Place("/nodes/0/name"), 5), HasSubstr("'name' must be text"));
  EXPECT_THAT(with(Place("/accessors/0/type"), "MAT4"), HasSubstr("type that is not read"));
  EXPECT_THAT(with(Place("/accessors/0/type"), "VEC2"), HasSubstr("3 components"));
  EXPECT_THAT(with(Place("/meshes/0/primitives/0/material"), 3), HasSubstr("no materials[3]"));
  EXPECT_THAT(with(Place("/extensionsRequired"), json::array({7})), HasSubstr("must be a list of names"));
}

}  // namespace
}  // namespace lapis::simulator
