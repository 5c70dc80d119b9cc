#include "simulator/core/loaders/labelled_ply.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using test::Files;
using test::MemoryStore;
using test::PlyFormat;
using test::PlySource;
using test::to_bytes;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Scene load_labelled(const Files& files) { return load_labelled_ply(MemoryStore(files), "scene_labelled.ply", {}); }

std::string labelled_error(const Files& files) {
  return test::error_of([&] { load_labelled(files); });
}

PlySource labelled_source() {
  PlySource source = test::floor_and_block();
  source.labels = {"class_id", "instance_id"};
  source.label_values = {{1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2}, {1, 1, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7}};
  return source;
}

Files with_ply(const PlySource& source) {
  Files files = test::labelled_ply_files();
  files["scene_labelled.ply"] = write_ply(source, PlyFormat::kBigEndian);
  return files;
}

std::size_t triangles_of(const Scene& scene, std::uint16_t id) {
  return static_cast<std::size_t>(
      std::count_if(scene.mesh.triangles.begin(), scene.mesh.triangles.end(),
                    [&](const Triangle& triangle) { return scene.instances[triangle.part].id == id; }));
}

TEST(LabelledPly, HasClassesInstancesAndColorsOfTheClasses) {
  const Scene scene = load_labelled(test::labelled_ply_files());
  EXPECT_EQ(problem_of(scene.mesh), "");
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[1].id, 7);
  EXPECT_EQ(scene.instances[1].class_id, 2);
  EXPECT_EQ(scene.instances[1].name, "block, red");
  EXPECT_EQ(scene.labels.name(2), "chair");
  EXPECT_EQ(triangles_of(scene, 1), 2U);
  EXPECT_EQ(triangles_of(scene, 7), 10U);
  const auto& material = scene.mesh.materials[scene.mesh.triangles.back().material];
  EXPECT_EQ(material.color, mapping::default_color(2));
  EXPECT_EQ(scene.floor_z_m, 0.0);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(LabelledPly, ColorsOfFacesDivideVertices) {
  PlySource source = labelled_source();
  source.face_colors.assign(12, {1, 2, 3});
  source.face_colors[0] = {9, 9, 9};
  source.vertex_colors.assign(source.positions.size(), {50, 50, 50});
  const Scene scene = load_labelled(with_ply(source));
  EXPECT_EQ(scene.mesh.positions.size(), source.positions.size() + 2);  // two corners of the floor are shared
  for (std::size_t i = 0; i < 12; ++i) {
    for (const std::uint32_t v : scene.mesh.triangles[i].vertices)
      EXPECT_EQ(scene.mesh.colors[v], source.face_colors[i]);
  }
}

TEST(LabelledPly, FacesDecideTheClassOfPartsOfAnInstance) {
  PlySource source = labelled_source();
  source.label_values[0][11] = 1;  // of instance 7, which is a chair
  const Scene scene = load_labelled(with_ply(source));
  ASSERT_EQ(scene.instances.size(), 3U);
  EXPECT_EQ(triangles_of(scene, 7), 9U);
  EXPECT_EQ(scene.instances[2].class_id, 1);
  EXPECT_EQ(scene.instances[2].id, 2);  // the lowest free one
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("another class"));
}

TEST(LabelledPly, FacesWithoutInstanceAreHeldByClass) {
  PlySource source = labelled_source();
  for (std::size_t i = 0; i < 4; ++i) source.label_values[1][i] = 0;
  source.label_values[0][3] = 0;
  const Scene scene = load_labelled(with_ply(source));
  ASSERT_EQ(scene.instances.size(), 5U);  // ground, block; floor, chair, unlabelled without instance
  const auto part = [&](std::size_t i) { return scene.instances[scene.mesh.triangles[i].part]; };
  std::size_t unlabelled = 0, floors = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    unlabelled += part(i).class_id == 0 ? 1U : 0U;
    floors += part(i).class_id == 1 ? 1U : 0U;
  }
  EXPECT_EQ(unlabelled, 1U);
  EXPECT_EQ(floors, 2U);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

// The block as a model in its own frame, turned by 90 degrees about z when placed.
class LabelledPlyWithModels : public testing::Test {
 protected:
  static Files files(float height) {
    Files files = test::labelled_ply_files();
    std::string obj = "mtllib block.mtl\nusemtl red\nvt 0 0\n";
    const PlySource source = labelled_source();
    for (std::size_t i = 4; i < 12; ++i) {
      const auto& p = source.positions[i];  // world = (-y, x, z) of the model + (2, 0, 0)
      obj += "v " + std::to_string(p.y()) + " " + std::to_string(2 - p.x()) + " " +
             std::to_string(p.z() * height / 0.8F) + "\n";
    }
    for (std::size_t i = 2; i < 12; ++i) {
      obj += "f";
      for (const std::uint32_t v : source.polygons[i]) obj += " " + std::to_string(v - 3) + "/1";
      obj += "\n";
    }
    obj += "f 1/1 1/1 2/1\n";  // no area: left out
    files["models/block.obj"] = to_bytes(obj);
    files["models/block.mtl"] = to_bytes("newmtl red\nKd 1 0 0\nmap_Kd t.png\n");
    files["models/t.png"] = test::png(2, 2, {200, 0, 0, 255});
    files["instances.csv"] = to_bytes(
        "instance_id,name,model,class_id,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23\n"
        "1,ground,,1,1,0,0,0,0,1,0,0,0,0,1,0\n"
        "7,block,block,2,0,-1,0,2,1,0,0,0,0,0,1,0\n");
    return files;
  }
};

TEST_F(LabelledPlyWithModels, ModelsShowInstancesThatTheyFit) {
  const Scene scene = load_labelled(files(0.8F));
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(scene.mesh.textures.size(), 1U);
  EXPECT_EQ(problem_of(scene.mesh), "");
  const Scene plain = load_labelled(test::labelled_ply_files());
  EXPECT_EQ(triangles_of(scene, 7), 10U);
  ASSERT_EQ(scene.mesh.triangles.size(), plain.mesh.triangles.size());
  for (std::size_t i = 0; i < plain.mesh.triangles.size(); ++i) {
    EXPECT_EQ(scene.mesh.triangles[i].part, plain.mesh.triangles[i].part);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& a = scene.mesh.positions[scene.mesh.triangles[i].vertices[k]];
      const auto& b = plain.mesh.positions[plain.mesh.triangles[i].vertices[k]];
      EXPECT_LT((a - b).norm(), 1e-5F);
    }
  }
}

TEST_F(LabelledPlyWithModels, TheSurfaceStaysWhereAModelDiffers) {
  const Scene scene = load_labelled(files(0.81F));
  EXPECT_THAT(scene.mesh.textures, IsEmpty());
  EXPECT_FLOAT_EQ(bounds(scene.mesh).max().z(), 0.8F);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("'block'"));
}

TEST_F(LabelledPlyWithModels, TheSurfaceStaysWhereAModelIsMissing) {
  Files files = LabelledPlyWithModels::files(0.8F);
  files.erase("models/block.obj");
  const Scene scene = load_labelled(files);
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr("models/block.obj"));
}

TEST(LabelledPly, TrianglesThatAreNotFiniteAreLeftOut) {
  PlySource source = labelled_source();
  source.positions[8].y() = std::numeric_limits<float>::quiet_NaN();
  source.positions[9].z() = 1e20F;
  const Scene scene = load_labelled(with_ply(source));
  EXPECT_EQ(problem_of(scene.mesh), "");
  EXPECT_LT(scene.mesh.triangles.size(), 12U);
  EXPECT_LE(bounds(scene.mesh).max().maxCoeff(), 2.0F);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], HasSubstr(std::to_string(12 - scene.mesh.triangles.size()) + " triangles"));
  for (auto& p : source.positions) p.x() = std::numeric_limits<float>::infinity();
  EXPECT_THAT(labelled_error(with_ply(source)), HasSubstr("no triangle has finite coordinates"));
}

TEST(LabelledPly, ErrorsNameFileAndRemedy) {
  for (const char* name : {"scene_labelled.ply", "classes.csv", "instances.csv"}) {
    Files files = test::labelled_ply_files();
    files.erase(name);
    EXPECT_THAT(labelled_error(files), HasSubstr(name));
    files[name] = {};
    EXPECT_THAT(labelled_error(files), HasSubstr(std::string(name) + ": the file is empty (0 bytes)"));
  }
  Files files = test::labelled_ply_files();
  files["classes.csv"] = to_bytes("class_id,class\n1,floor\n");
  EXPECT_THAT(labelled_error(files), HasSubstr("class 2; add it to classes.csv"));
  files = test::labelled_ply_files();
  files["instances.csv"] = to_bytes("instance_id,name,class_id\n1,ground,1\n");
  EXPECT_THAT(labelled_error(files), HasSubstr("instance 7; add it to instances.csv"));
  files["instances.csv"] = to_bytes("instance_id,name,class_id\n1,ground,1\n1,x,1\n");
  EXPECT_THAT(labelled_error(files), HasSubstr("instances.csv: line 3"));
  PlySource source = labelled_source();
  for (auto& polygon : source.polygons) polygon.resize(2);
  EXPECT_THAT(labelled_error(with_ply(source)), HasSubstr("no triangles"));
}

}  // namespace
}  // namespace lapis::simulator
