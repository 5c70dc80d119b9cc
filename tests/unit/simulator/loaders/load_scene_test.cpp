#include "simulator/core/loaders/load_scene.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;
using test::Files;
using ::testing::HasSubstr;

class LoadScene : public testing::Test {
 protected:
  fs::path write(const std::string& folder, const Files& files) const {
    for (const auto& [name, bytes] : files) test::write_file(temporary_.path() / folder / name, bytes);
    return temporary_.path() / folder;
  }
  static std::string error(const fs::path& path) {
    return test::error_of([&] { load_scene(path, {}); });
  }
  test::TemporaryFolder temporary_;
};

TEST_F(LoadScene, LabelledPlyByFolderAndByFile) {
  Files files = test::labelled_ply_files();
  files["other.obj"] = test::to_bytes("v 0 0 0\n");
  const fs::path folder = write("home", files);
  const Scene scene = load_scene(folder, {});
  EXPECT_EQ(scene.name, "home");
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  EXPECT_EQ(load_scene(folder / "scene_labelled.ply", {}).mesh.triangles.size(), 12U);
  EXPECT_EQ(load_scene(folder / "", {}).name, "home");
}

TEST_F(LoadScene, MatterportByFolderAndByEveryFile) {
  Files files = test::matterport_files();
  files["m.glb"] = test::labelled_gltf().glb();
  const fs::path folder = write("scan", files);
  for (const char* file : {"", "m.house", "m_semantic.ply", "m.glb"}) {
    const Scene scene = load_scene(folder / file, {});
    EXPECT_EQ(scene.name, "m");
    EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  }
  fs::remove(folder / "m_semantic.ply");
  EXPECT_THAT(error(folder), HasSubstr("m_semantic.ply: no readable file"));
}

TEST_F(LoadScene, Hm3dByFolderAndByEveryFile) {
  const fs::path folder = write("val/00800-h", test::hm3d_files());
  test::write_file(temporary_.path() / "hm3dsem_category_mappings.tsv", test::hm3d_mapping());
  for (const char* file : {"", "h.semantic.glb", "h.semantic.txt", "h.glb"}) {
    const Scene scene = load_scene(folder / file, {});
    EXPECT_EQ(scene.name, "h");
    EXPECT_EQ(scene.labels.name(scene.instances[1].class_id), "chair");  // by the table two folders above
  }
}

TEST_F(LoadScene, ReplicaByEitherFolderAndByFile) {
  const fs::path folder = write("room_0/habitat", test::replica_files());
  write("room_0", {{"mesh.ply", test::to_bytes("ply\n")}});
  for (const fs::path& path : {folder, folder.parent_path(), folder / "mesh_semantic.ply"}) {
    const Scene scene = load_scene(path, {});
    EXPECT_EQ(scene.name, "room_0");
    EXPECT_EQ(scene.mesh.triangles.size(), 4U);
  }
}

TEST_F(LoadScene, ModelsByFolderAndByFile) {
  const fs::path folder = write("models", test::labelled_gltf().separate("house"));
  EXPECT_EQ(load_scene(folder, {}).name, "house");
  write("models", {{"b.glb", test::labelled_gltf().glb()}});
  EXPECT_THAT(error(folder), HasSubstr("several scenes in it, 'b.glb' and 'house.gltf'"));
  EXPECT_EQ(load_scene(folder / "b.glb", {}).name, "b");
}

TEST_F(LoadScene, ErrorsNameThePath) {
  EXPECT_THAT(error(temporary_.path() / "gone"), HasSubstr("gone: there is no such file or folder"));
  EXPECT_THAT(error(temporary_.path()), HasSubstr("there is no scene in it"));
  EXPECT_THAT(error(write("x", {{"a.txt", {}}}) / "a.txt"), HasSubstr("a.txt: is no kind of scene"));
  EXPECT_THAT(error(write("x", {{"a.glb", {}}}) / "a.glb"), HasSubstr("a.glb: the file is empty (0 bytes)"));
}

}  // namespace
}  // namespace lapis::simulator
