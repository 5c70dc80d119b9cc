#include "simulator/core/loaders/semantics_json.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <map>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;
using test::Files;
using test::GltfBuilder;
using test::MemoryStore;
using test::to_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const mapping::LabelList kLabels = mapping::LabelList::from_names({{1, "wall"}, {3, "chair"}, {5, "table"}});
const auto kNoFloor = HasSubstr("nothing level has the class 'floor'; the lowest point is taken");

Scene load_listed(const GltfBuilder& builder, const json& semantics, const LoadOptions& options = {kLabels, 64}) {
  Files files{{"a.glb", builder.glb()}};
  if (!semantics.is_null()) files["semantics.json"] = to_bytes(semantics.dump());
  return load_model_scene(MemoryStore(files), "a.glb", options);
}

std::string listed_error(const json& semantics) {
  return test::error_of([&] { load_listed(test::labelled_gltf(), semantics); });
}

// Instance of the triangle that is shown by a material.
Instance instance_of(const Scene& scene, const std::string& material) {
  for (const auto& triangle : scene.mesh.triangles) {
    if (scene.mesh.materials[triangle.material].name == material) return scene.instances[triangle.part];
  }
  return {};
}

json entry(int id, const std::string& class_name, const std::string& key, const std::string& name) {
  return {{"id", id}, {"class", class_name}, {key, name}};
}

TEST(Semantics, NodesMaterialsAndExtrasNameInstances) {
  const json semantics{{"instances", {entry(9, "wall", "node", "wall")}}};
  const Scene scene = load_listed(test::labelled_gltf(), semantics);
  EXPECT_EQ(instance_of(scene, "paint").id, 9);
  EXPECT_EQ(instance_of(scene, "paint").class_id, 1);
  EXPECT_EQ(instance_of(scene, "wood").class_id, 3);  // extras.class
  EXPECT_EQ(instance_of(scene, "wood").name, "chair");
  EXPECT_EQ(scene.labels, kLabels);
  EXPECT_THAT(scene.warnings, ElementsAre(kNoFloor));

  const Scene by_material =
      load_listed(test::labelled_gltf(), {{"instances", {entry(9, "table", "material", "wood")}}});
  EXPECT_EQ(instance_of(by_material, "wood").class_id, 5);
  EXPECT_EQ(instance_of(by_material, "paint").class_id, 0);
}

TEST(Semantics, WhatHangsBelowANodeBelongsToIt) {
  GltfBuilder builder = test::labelled_gltf();
  const Scene scene = load_listed(builder, {{"instances", {entry(4, "table", "node", "house")}}});
  EXPECT_EQ(instance_of(scene, "wood").id, 4);
  EXPECT_EQ(instance_of(scene, "paint").id, 4);
  builder.root["nodes"][0]["extras"] = {{"class", "wall"}};
  const Scene by_extras = load_listed(builder, nullptr);
  EXPECT_EQ(instance_of(by_extras, "paint").class_id, 1);
  EXPECT_EQ(instance_of(by_extras, "wood").class_id, 3);  // the nearest node counts
}

TEST(Semantics, TheFirstEntryThatFitsCounts) {
  json both = entry(2, "table", "node", "house");
  both["material"] = "wood";
  const Scene scene = load_listed(test::labelled_gltf(), {{"instances", {both, entry(3, "wall", "node", "house")}}});
  EXPECT_EQ(instance_of(scene, "wood").id, 2);
  EXPECT_EQ(instance_of(scene, "paint").id, 3);
}

TEST(Semantics, UpIsYUnlessTheFileSaysOtherwise) {
  const auto top = [](const json& semantics) {
    return bounds(load_listed(test::labelled_gltf(), semantics).mesh).max();
  };
  // The points (0,0,0), (1,0,0), (0,1,0) of the file, and the same at z = 3.
  EXPECT_EQ(top(nullptr), Eigen::Vector3f(1, 0, 1));
  EXPECT_EQ(top({{"up", "y"}}), Eigen::Vector3f(1, 0, 1));
  EXPECT_EQ(top({{"up", "z"}}), Eigen::Vector3f(1, 1, 3));
}

TEST(Semantics, LabelsComeFromTheFileElseTheOptionsElseTheNames) {
  const json instances = json::array({entry(1, "wall", "node", "wall")});
  const json named{{"instances", instances}, {"labels", {"chair", "lamp", "wall"}}};
  EXPECT_EQ(load_listed(test::labelled_gltf(), named).labels.name(3), "wall");
  const json numbered{{"instances", instances},
                      {"labels", {{{"id", 40}, {"name", "wall"}}, {{"id", 7}, {"name", "chair"}}}}};
  EXPECT_EQ(instance_of(load_listed(test::labelled_gltf(), numbered), "paint").class_id, 40);
  const Scene free = load_listed(test::labelled_gltf(), {{"instances", instances}}, {});
  EXPECT_EQ(free.labels.size(), 2U);
  EXPECT_EQ(free.labels.name(instance_of(free, "wood").class_id), "chair");
}

TEST(Semantics, ObjGroupsAndMaterialsNameInstances) {
  Files files{{"a.obj", to_bytes("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\ng seat\nusemtl wood\nf 1 2 3\n"
                                 "g rest\nusemtl paint\nf 3 2 1\n")},
              {"a.mtl", to_bytes("newmtl wood\nKd 1 0 0\nnewmtl paint\n")},
              {"semantics.json", to_bytes(json{{"instances", {entry(6, "chair", "group", "seat")}}}.dump())}};
  const Scene scene = load_model_scene(MemoryStore(files), "a.obj", {kLabels, 64});
  EXPECT_EQ(instance_of(scene, "wood").id, 6);
  EXPECT_EQ(instance_of(scene, "paint").class_id, 0);
  EXPECT_FLOAT_EQ(bounds(scene.mesh).max().y(), 1.0F);  // y up: -z is north
}

TEST(Semantics, WhatDoesNotFitIsAWarning) {
  GltfBuilder builder = test::labelled_gltf();
  builder.root["nodes"][1].erase("extras");
  EXPECT_THAT(load_listed(builder, nullptr).warnings, ElementsAre(HasSubstr("nothing is labelled"), kNoFloor));
  const json semantics{{"instances", {entry(1, "wall", "node", "wal")}}};
  EXPECT_THAT(load_listed(builder, semantics).warnings, ElementsAre(HasSubstr("instance 1 ('wal')"), kNoFloor));
}

TEST(Semantics, TextureCoordinatesThatAreNotFiniteBecomeZero) {
  GltfBuilder builder = test::labelled_gltf();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  builder.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      builder.add_floats({nan, 0.5F, 1e30F, 0.5F, 0.25F, 0.5F}, 2);
  const Scene scene = load_listed(builder, nullptr);
  EXPECT_EQ(problem_of(scene.mesh), "");
  EXPECT_EQ(std::count(scene.mesh.texture_coordinates.begin(), scene.mesh.texture_coordinates.end(),
                       Eigen::Vector2f(0.25F, 0.5F)),
            1);
}

TEST(Semantics, ErrorsNameFileAndEntry) {
  const auto one = [](const json& value) { return listed_error({{"instances", {value}}}); };
  EXPECT_THAT(one(entry(1, "throne", "node", "wall")), HasSubstr("unknown class 'throne'"));
  EXPECT_THAT(one(entry(0, "wall", "node", "wall")), HasSubstr("semantics.json: instances[0]: 'id'"));
  EXPECT_THAT(one(entry(65536, "wall", "node", "wall")), HasSubstr("between 1 and 65535"));
  EXPECT_THAT(one({{"id", 1}, {"class", "wall"}}), HasSubstr("a 'node', a 'group' or a 'material'"));
  EXPECT_THAT(one({{"id", 1}, {"class", 2}, {"node", "x"}}), HasSubstr("'class' must be text"));
  EXPECT_THAT(listed_error({{"instances", {entry(1, "wall", "node", "a"), entry(1, "wall", "node", "b")}}}),
              HasSubstr("two instances 1"));
  EXPECT_THAT(listed_error({{"up", "x"}}), HasSubstr("'up' must be"));
  EXPECT_THAT(listed_error({{"labels", {1}}}), HasSubstr("labels[0]"));
  EXPECT_THAT(listed_error({{"labels", {{{"id", 1}, {"name", "a"}}, {{"id", 1}, {"name", "b"}}}}}),
              HasSubstr("id 1 twice"));
  EXPECT_THAT(listed_error({{"instances", 1}}), HasSubstr("'instances' must be an array"));
}

}  // namespace
}  // namespace lapis::simulator
