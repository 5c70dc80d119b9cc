#include "simulator/core/loaders/replica.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;
using test::Files;
using test::MemoryStore;
using test::to_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Scene load_replica_files(const Files& files) { return load_replica(MemoryStore(files), ""); }

std::string info_error(const json& info) {
  Files files = test::replica_files();
  files["info_semantic.json"] = to_bytes(info.dump());
  return test::error_of([&] { load_replica_files(files); });
}

TEST(Replica, QuadsBecomeTrianglesWithClassAndColor) {
  const Scene scene = load_replica_files(test::replica_files());
  EXPECT_EQ(problem_of(scene.mesh), "");
  ASSERT_EQ(scene.mesh.triangles.size(), 4U);
  const auto part = [&](std::size_t i) { return scene.instances[scene.mesh.triangles[i].part]; };
  EXPECT_EQ(part(0).id, 1);
  EXPECT_EQ(part(0).class_id, 40);
  EXPECT_EQ(part(3).id, 6);
  EXPECT_EQ(part(3).name, "wall 5");
  EXPECT_EQ(scene.labels.name(93), "wall");
  EXPECT_EQ(scene.mesh.colors[0], (geometry::Rgb8{200, 100, 50}));
  EXPECT_EQ(scene.floor_z_m, 0.0);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(Replica, ObjectsWithoutClassAreUnlabelled) {
  Files files = test::replica_files();
  const json info{{"classes", {{{"id", 0}, {"name", "undefined"}}, {{"id", 40}, {"name", "floor"}}}},
                  {"objects", {{{"id", 0}, {"class_id", -1}}}}};
  files["info_semantic.json"] = to_bytes(info.dump());
  const Scene scene = load_replica_files(files);
  for (const auto& instance : scene.instances) EXPECT_EQ(instance.class_id, 0);
  EXPECT_EQ(scene.labels.size(), 1U);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("1 objects are not in the list"), HasSubstr("class 'floor'")));
}

TEST(Replica, ErrorsNameFileAndRemedy) {
  EXPECT_THAT(info_error({{"classes", {{{"id", 1}, {"name", "a"}}, {{"id", 1}, {"name", "b"}}}}}),
              HasSubstr("class 1"));
  EXPECT_THAT(info_error({{"classes", 5}}), HasSubstr("info_semantic.json: 'classes' must be an array"));
  EXPECT_THAT(info_error({{"objects", {{{"class_id", 1}}}}}), HasSubstr("no id"));
  EXPECT_THAT(info_error({{"objects", {{{"id", "x"}}}}}), HasSubstr("'id' must be a whole number"));
  EXPECT_THAT(info_error(json::array()), HasSubstr("no JSON object"));
  for (const char* name : {"mesh_semantic.ply", "info_semantic.json"}) {
    Files files = test::replica_files();
    files.erase(name);
    EXPECT_THAT(test::error_of([&] { load_replica_files(files); }), HasSubstr(std::string("memory/") + name));
  }
}

}  // namespace
}  // namespace lapis::simulator
