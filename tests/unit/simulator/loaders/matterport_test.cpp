#include "simulator/core/loaders/matterport.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using test::Files;
using test::MemoryStore;
using test::to_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Scene load_matterport_files(const Files& files, const mapping::LabelList& labels = {}) {
  return load_matterport(MemoryStore(files), "m", {labels, 64});
}

std::string house_error(const std::string& records) {
  return test::error_of([&] { parse_house("ASCII 1.1\n" + records, "m.house"); });
}

TEST(Matterport, ObjectsLeadToClassesByWayOfCategories) {
  const Scene scene = load_matterport_files(test::matterport_files());
  EXPECT_EQ(problem_of(scene.mesh), "");
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  EXPECT_FALSE(scene.is_lit);
  const auto part = [&](std::size_t i) { return scene.instances[scene.mesh.triangles[i].part]; };
  EXPECT_EQ(part(0).id, 1);  // object 0
  EXPECT_EQ(part(0).name, "floor boards 0");
  EXPECT_EQ(scene.labels.name(part(0).class_id), "floor");
  EXPECT_EQ(scene.labels.name(part(5).class_id), "chair");
  EXPECT_EQ(part(10).class_id, 0);  // category -1
  EXPECT_EQ(part(10).id, 3);
  EXPECT_EQ(part(11).class_id, 0);  // object -1
  EXPECT_NE(part(11).id, 3);
  EXPECT_EQ(scene.mesh.colors[0], (geometry::Rgb8{10, 20, 30}));
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("colours are those of its vertices")));
}

TEST(Matterport, ClassesAreThoseOfTheLabelList) {
  const auto labels = mapping::LabelList::from_names({{1, "wall"}, {3, "chair"}});
  const Scene scene = load_matterport_files(test::matterport_files(), labels);
  EXPECT_EQ(scene.labels, labels);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[5].part].class_id, 3);
  EXPECT_EQ(scene.instances[scene.mesh.triangles[0].part].class_id, 0);
  EXPECT_THAT(scene.warnings, testing::Contains(HasSubstr("'floor' for one")));
}

TEST(Matterport, WarnsOfObjectsAndCountsThatDoNotFit) {
  Files files = test::matterport_files();
  const std::string house(files["m.house"].begin(), files["m.house"].end());
  files["m.house"] = to_bytes(house.substr(0, house.find("O 1 ")));
  EXPECT_THAT(load_matterport_files(files).warnings,
              ElementsAre(HasSubstr("has 1 objects and 2 categories, its header promises 3 and 2"),
                          HasSubstr("2 objects are not in the list"), HasSubstr("colours")));
}

TEST(Matterport, ErrorsNameFileAndLine) {
  EXPECT_THAT(house_error("\nO 1 0\n"), HasSubstr("m.house: line 3: a whole number is missing"));
  EXPECT_THAT(house_error("O 1\n"), HasSubstr("too short"));
  EXPECT_THAT(house_error("C 1 2 chair 3\n"), HasSubstr("a name is missing"));
  EXPECT_THAT(house_error("C 1 2 chair 3 chair\nC 1 2 chair 3 chair\n"),
              HasSubstr("line 3: this category occurs twice"));
  EXPECT_THAT(house_error("O 1 0 0\nO 1 0 0\n"), HasSubstr("this object occurs twice"));
  EXPECT_THAT(test::error_of([] { parse_house("PLY", "m.house"); }), HasSubstr("no Matterport3D house"));
  for (const char* name : {"m.house", "m_semantic.ply"}) {
    Files files = test::matterport_files();
    files.erase(name);
    EXPECT_THAT(test::error_of([&] { load_matterport_files(files); }), HasSubstr(std::string("memory/") + name));
    files[name] = {};
    EXPECT_THAT(test::error_of([&] { load_matterport_files(files); }), HasSubstr("0 bytes"));
  }
}

TEST(Matterport, ObjectIdsAreAtMost65534) {
  test::PlySource source = test::floor_and_block();
  source.labels = {"object_id"};
  source.label_values = {std::vector<std::int32_t>(12, 65535)};
  Files files = test::matterport_files();
  files["m_semantic.ply"] = write_ply(source, test::PlyFormat::kAscii);
  files["m.house"] = to_bytes("ASCII 1.1\nO 65535 0 -1\n");
  EXPECT_THAT(test::error_of([&] { load_matterport_files(files); }), HasSubstr("instance 65536"));
}

}  // namespace
}  // namespace lapis::simulator
