#include "simulator/core/assets/obj.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "simulator/core/assets/mtl.hpp"
#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using test::error_of;
using test::Files;
using test::MemoryStore;
using test::to_bytes;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kCube = R"(# a unit cube of quads, all outwards
mtllib cube.mtl
o Cube
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl oak wood
f 1/1 4/2 3/3 2/4
f 5/1 6/2 7/3 8/4
f 1/1 2/2 6/3 5/4
usemtl metal
f 3//1 4//1 8//1 7//1
f 1 5 8 4
f 2 3 7 6
)";
constexpr const char* kCubeMtl =
    "newmtl oak wood\nKd 0.2 0.4 0.6\nmap_Kd oak.png\nnewmtl metal\n  Kd 1.0 0.5 0\nd 1.0\n";

Files cube_files() {
  return {
      {"m/cube.obj", to_bytes(kCube)}, {"m/cube.mtl", to_bytes(kCubeMtl)}, {"m/oak.png", test::png(4, 4, {1, 2, 3})}};
}

Model read(const std::string& obj, const std::string& mtl = {}) {
  return read_obj(MemoryStore({{"a.obj", to_bytes(obj)}, {"a.mtl", to_bytes(mtl)}}), "a.obj");
}

const Eigen::Vector3f& corner(const Mesh& mesh, const Triangle& triangle, std::size_t i) {
  return mesh.positions[triangle.vertices[i]];
}

float area(const Mesh& mesh) {
  float sum = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f ab = corner(mesh, t, 1) - corner(mesh, t, 0), ac = corner(mesh, t, 2) - corner(mesh, t, 0);
    sum += 0.5F * ab.cross(ac).norm();
  }
  return sum;
}

// By the divergence theorem; its sign says whether the triangles turn outwards.
float volume(const Mesh& mesh) {
  float sum = 0;
  for (const auto& t : mesh.triangles)
    sum += corner(mesh, t, 0).dot(corner(mesh, t, 1).cross(corner(mesh, t, 2))) / 6.0F;
  return sum;
}

const Material& material_named(const Mesh& mesh, std::string_view name) {
  for (const auto& material : mesh.materials) {
    if (material.name == name) return material;
  }
  throw std::logic_error("no material " + std::string(name));
}

TEST(Obj, CubeKeepsAreaVolumeAndLooks) {
  const Model model = read_obj(MemoryStore(cube_files()), "m/cube.obj");
  const Mesh& mesh = model.mesh;
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_FLOAT_EQ(area(mesh), 6.0F);
  EXPECT_FLOAT_EQ(volume(mesh), 1.0F);
  EXPECT_EQ(problem_of(mesh), "");
  EXPECT_THAT(model.groups, ElementsAre("Cube"));
  EXPECT_THAT(model.warnings, IsEmpty());
  const Material& wood = material_named(mesh, "oak wood");
  ASSERT_EQ(wood.texture, 0);
  EXPECT_EQ((*mesh.textures[0])(0, 0), (Rgba8{1, 2, 3, 255}));
  EXPECT_EQ(wood.color, (geometry::Rgb8{255, 255, 255})) << "the texture replaces Kd";
  const Material& metal = material_named(mesh, "metal");
  EXPECT_EQ(metal.texture, -1);
  EXPECT_EQ(metal.color, (geometry::Rgb8{255, 128, 0}));
}

TEST(Obj, MergesVerticesPerPositionAndTextureCoordinate) {
  const Mesh mesh = read_obj(MemoryStore(cube_files()), "m/cube.obj").mesh;
  std::set<std::vector<float>> pairs;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector3f& p = mesh.positions[i];
    const Eigen::Vector2f& uv = mesh.texture_coordinates[i];
    pairs.insert({p.x(), p.y(), p.z(), uv.x(), uv.y()});
  }
  // 1/1, 4/2, 3/3, 2/4, 5/1, 6/2, 7/3, 8/4, 2/2, 6/3, 5/4 and the eight without
  EXPECT_EQ(mesh.positions.size(), 11U + 8U);
  EXPECT_EQ(pairs.size(), 11U + 8U - 2U) << "1 and 5 without texture coordinate count as (0, 0)";
}

TEST(Obj, NegativeIndicesCountFromTheEnd) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
  const Mesh forward = read(vertices + "f 1/1 2/2 3/3\nv 9 9 9\n").mesh;
  const Mesh backward = read(vertices + "f -3/-3 -2/-2 -1/-1\nv 9 9 9\n").mesh;
  EXPECT_EQ(forward.positions, backward.positions);
  EXPECT_EQ(forward.texture_coordinates, backward.texture_coordinates);
}

TEST(Obj, PolygonsKeepTheirArea) {
  for (int n = 3; n < 20; ++n) {
    std::ostringstream obj;
    std::string face = "f";
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      obj << "v " << std::cos(angle) << ' ' << std::sin(angle) << " 0\n";
      face += " " + std::to_string(i + 1);
    }
    const Mesh mesh = read(obj.str() + face).mesh;
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(n - 2));
    EXPECT_NEAR(area(mesh), 0.5 * n * std::sin(2 * std::numbers::pi / n), 1e-4) << n;
  }
}

constexpr const char* kTwoTriangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\nvt 0 0\nvt 1 0\nvt 0 1\n";

TEST(Obj, GroupsAreNamedByTheirLastLine) {
  const Model model = read(std::string(kTwoTriangles) + "f 1 2 3\no empty\ng back rest \nf 1 2 4\ng\nf 1 3 4\n" +
                           "g back rest\nf 2 3 4\n");
  EXPECT_THAT(model.groups, ElementsAre("default", "back rest"));
  std::vector<std::uint32_t> parts;
  for (const auto& triangle : model.mesh.triangles) parts.push_back(triangle.part);
  EXPECT_THAT(parts, ElementsAre(0, 1, 0, 1));
}

TEST(Obj, GlassIsLeftOutButCountsForTheBounds) {
  const std::string faces = "mtllib a.mtl\nusemtl pane\nf 1 2 4\nusemtl solid\nf 1 2 3\n";
  for (const auto* opacity : {"d 0.34", "Tr 0.7", "d 0"}) {
    const Mesh mesh = read(kTwoTriangles + faces, std::string("newmtl pane\n") + opacity + "\nnewmtl solid\n").mesh;
    EXPECT_EQ(mesh.triangles.size(), 1U) << opacity;
    EXPECT_EQ(bounds(mesh).max().z(), 5.0F);
  }
  for (const auto* opacity : {"d 0.35", "Tr 0.6", "d 1"})
    EXPECT_EQ(
        read(kTwoTriangles + faces, std::string("newmtl pane\n") + opacity + "\nnewmtl solid\n").mesh.triangles.size(),
        2U)
        << opacity;
}

TEST(Obj, FacesWithoutTextureCoordinatesShowTheColour) {
  const std::string mtl = "newmtl w\nKd 0 0 1\nmap_Kd t.png\n";
  const auto files = [&](const std::string& faces) {
    return MemoryStore({{"a.obj", to_bytes("mtllib a.mtl\n" + std::string(kTwoTriangles) + "usemtl w\n" + faces)},
                        {"a.mtl", to_bytes(mtl)},
                        {"t.png", test::png(1, 1, {})}});
  };
  const Mesh mixed = read_obj(files("f 1/1 2/2 3/3\nf 1 2 4\nf 1/1 3/2 4\n"), "a.obj").mesh;
  ASSERT_EQ(mixed.materials.size(), 2U);
  EXPECT_EQ(mixed.materials[mixed.triangles[0].material].texture, 0);
  for (const std::size_t bare : {1U, 2U}) {
    EXPECT_EQ(mixed.materials[mixed.triangles[bare].material].texture, -1);
    EXPECT_EQ(mixed.materials[mixed.triangles[bare].material].color, (geometry::Rgb8{0, 0, 255}));
  }
  const Mesh bare = read_obj(files("f 1 2 3\n"), "a.obj").mesh;
  EXPECT_TRUE(bare.textures.empty());
  EXPECT_TRUE(bare.texture_coordinates.empty());
}

// Where a texture named `written` is found among `files` (the red channel distinguishes them); -1: nowhere.
int texture_found(const std::string& written, const std::map<std::string, int>& files) {
  Files all{{"m/a.obj", to_bytes("mtllib a.mtl\n" + std::string(kTwoTriangles) + "usemtl w\nf 1/1 2/2 3/3\n")},
            {"m/a.mtl", to_bytes("newmtl w\nmap_Kd " + written + "\r\n")}};
  for (const auto& [name, red] : files) all[name] = test::png(1, 1, {static_cast<std::uint8_t>(red)});
  const Model model = read_obj(MemoryStore(all), "m/a.obj");
  const bool is_missing = written == "lost.png";
  EXPECT_EQ(model.warnings.size(), is_missing ? 1U : 0U) << "a missing texture is one warning, also with a stand-in";
  return model.mesh.textures.empty() ? -1 : (*model.mesh.textures[0])(0, 0).r;
}

TEST(Obj, FindsTexturesAlthoughTheirNamesAreTheAuthors) {
  const std::map<std::string, int> two{{"m/x.png", 1}, {"m/y z.JPG", 2}};
  EXPECT_EQ(texture_found("x.png", two), 1);
  EXPECT_EQ(texture_found("./x.png", two), 1);
  EXPECT_EQ(texture_found("y z.jpg", two), 2) << "upper and lower case differ";
  EXPECT_EQ(texture_found("C:\\My Documents\\y z.jpg", two), 2);
  EXPECT_EQ(texture_found("/home/author/pictures/X.png", two), 1);
  EXPECT_EQ(texture_found("-s 2 2 1 -o 0.5 0 -clamp on -bm 1 y z.JPG", two), 2);
  EXPECT_EQ(texture_found("-mm 0 1 -blendu off x.png", two), 1);
  EXPECT_EQ(texture_found("lost.png", two), -1) << "which of the two?";
  EXPECT_EQ(texture_found("lost.png", {{"m/only.jpeg", 3}, {"other/x.png", 4}, {"m/deep/x.png", 5}}), 3);
  EXPECT_EQ(texture_found("../t/x.png", {{"t/x.png", 6}, {"m/x.png", 7}}), 6);
  EXPECT_EQ(texture_found("lost.png", {}), -1);
}

TEST(Obj, TransparentTexelsMakeACutOut) {
  for (const int alpha : {0, 255}) {
    Files files = cube_files();
    files["m/oak.png"] = test::png(4, 4, {9, 9, 9, static_cast<std::uint8_t>(alpha)});
    const Mesh mesh = read_obj(MemoryStore(files), "m/cube.obj").mesh;
    EXPECT_EQ(material_named(mesh, "oak wood").is_cut_out, alpha == 0);
    EXPECT_FALSE(material_named(mesh, "metal").is_cut_out);
  }
}

TEST(Obj, TrianglesWithoutAreaAreDropped) {
  const Mesh mesh = read("v 0 0 0\nv 1 1 1\nv 2 2 2\nv 0 1 0\nf 1 2 3\nf 1 1 4\nf 1 2\nf 1 2 4 4\n").mesh;
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST(Obj, LineEndsNumbersAndBlanksMayVary) {
  const Mesh plain = read("v 0 0 0\nv 1 0 0\nv 0 0.5 0\nf 1 2 3\n").mesh;
  const Mesh varied = read("  v\t+0 1e-60 -0.0\r\nv  1.0e0 0 0  \r\nv 0 5E-1 0 1.0\r\n\r\nf  1  2 3 \r").mesh;
  ASSERT_EQ(plain.positions.size(), varied.positions.size());
  for (std::size_t i = 0; i < plain.positions.size(); ++i) EXPECT_EQ(plain.positions[i], varied.positions[i]);
}

TEST(Obj, MissingMaterialsAreWarnings) {
  const Model model =
      read(std::string("mtllib none.mtl\n") + kTwoTriangles + "usemtl x\nf 1/1 2/2 3/3\n", "newmtl y\n");
  EXPECT_THAT(model.warnings, ElementsAre(HasSubstr("'x' is not defined")))
      << "a.mtl, called like the model, stands in for none.mtl";
  const Model bare = read_obj(
      MemoryStore({{"b.obj", to_bytes("mtllib p q.mtl\n" + std::string(kTwoTriangles) + "f 1 2 3\n")}}), "b.obj");
  EXPECT_THAT(bare.warnings, ElementsAre(HasSubstr("'p q.mtl' not found")));
}

TEST(Obj, NamesStoreFileLineAndReason) {
  const auto error = [](const std::string& last) { return error_of([&] { read(kTwoTriangles + last); }); };
  const auto names_line_8 = AllOf(HasSubstr("memory: a.obj: line 8: "), HasSubstr("export the model again"));
  for (const auto* bad :
       {"f 0 1 2", "f 1 2 5", "f 1 2 -5", "f 1 2 3/4", "f 1 2 x", "f /1 1 2", "f 1 2 3x", "f 1 2 3/x", "v 1 2",
        "v 1 2 nan", "v inf 0 0", "v 1e39 0 0", "v 1,5 0 0", "vt", "vt 0 nan", "f 1 2 99999999999999999999"})
    EXPECT_THAT(error(bad), names_line_8) << bad;
  EXPECT_THAT(error("# nothing"), HasSubstr("memory: a.obj: no triangles"));
  EXPECT_THAT(error_of([] { read_obj(MemoryStore({}), "lost.obj"); }), HasSubstr("memory: lost.obj: no readable file"));
}

TEST(Obj, ACutFileIsAnErrorOrASoundMesh) {
  const std::string whole = kCube;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Files files = cube_files();
    files["m/cube.obj"] = to_bytes(whole.substr(0, size));
    const auto read_and_check = [&] {
      EXPECT_EQ(problem_of(read_obj(MemoryStore(files), "m/cube.obj").mesh), "") << size;
    };
    const std::string error = error_of(read_and_check);
    EXPECT_TRUE(error.empty() || error.starts_with("memory: m/cube.obj: ")) << size << ": " << error;
  }
}

TEST(Mtl, IgnoresLinesThatMakeNoSense) {
  const auto materials = parse_mtl("Kd 1 1 1\nnewmtl a\nKd 0.5 x 1\nKd 2 -1 0.5\nd\nd abc\nillum\nmap_Kd\nnewmtl\n");
  ASSERT_EQ(materials.size(), 2U);
  const auto& a = materials.at("a");
  EXPECT_EQ(a.color, (geometry::Rgb8{255, 0, 128}));
  EXPECT_EQ(a.opacity, 1.0F);
  EXPECT_EQ(a.texture, "");
}

}  // namespace
}  // namespace lapis::simulator
