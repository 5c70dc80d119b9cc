#include <gmock/gmock.h>

#include <map>

#include "simulator/core/loaders/load_scene.hpp"
#include "simulator/core/loaders/ply.hpp"
#include "tests/support/test_data.hpp"
#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using ::testing::IsEmpty;

struct Expected {
  std::string folder;
  std::size_t triangles, instances, classes;
  Eigen::Vector3f lowest, highest;
};

void expect_near(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 2e-3F) << a.transpose() << " and " << b.transpose();
}

// Boxes of the classes' triangles, and their areas.
struct Surface {
  Eigen::AlignedBox3f box;
  double area_m2 = 0;
};

void add(Surface& surface, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  for (const auto& p : {a, b, c}) surface.box.extend(p);
  surface.area_m2 += (b - a).cast<double>().cross((c - a).cast<double>()).norm() / 2;
}

void check(const Expected& expected) {
  const auto folder = lapis::test::find_test_data(expected.folder);
  if (!folder) GTEST_SKIP() << lapis::test::missing_test_data(expected.folder);
  const PlyMesh ply = read_ply(test::read_file(*folder / "scene_labelled.ply"), "ply", {"class_id", "instance_id"});
  EXPECT_EQ(ply.triangles.size(), expected.triangles);
  const Scene scene = load_scene(*folder, {});
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_EQ(problem_of(scene.mesh), "");
  EXPECT_EQ(scene.instances.size(), expected.instances);
  EXPECT_EQ(scene.labels.size(), expected.classes);
  EXPECT_NEAR(scene.floor_z_m, 0.0, 1e-9);
  expect_near(bounds(scene.mesh).min(), expected.lowest);
  expect_near(bounds(scene.mesh).max(), expected.highest);

  // Models may leave out triangles without area and have four decimals; surface and box of every instance stay.
  std::map<std::pair<std::int64_t, std::int64_t>, Surface> in_file, in_scene;
  for (std::size_t i = 0; i < ply.triangles.size(); ++i) {
    const auto& [a, b, c] = ply.triangles[i];
    add(in_file[{ply.face_labels[1][i], ply.face_labels[0][i]}], ply.positions[a], ply.positions[b], ply.positions[c]);
  }
  for (const auto& triangle : scene.mesh.triangles) {
    const Instance& instance = scene.instances[triangle.part];
    const auto& p = scene.mesh.positions;
    const auto& [a, b, c] = triangle.vertices;
    add(in_scene[{instance.id, instance.class_id}], p[a], p[b], p[c]);
  }
  ASSERT_EQ(in_scene.size(), in_file.size());
  for (const auto& [key, surface] : in_file) {
    const Surface& other = in_scene.at(key);
    expect_near(other.box.min(), surface.box.min());
    expect_near(other.box.max(), surface.box.max());
    EXPECT_NEAR(other.area_m2, surface.area_m2, 2e-3 * surface.area_m2) << "instance " << key.first;
  }
}

TEST(SharedData, SmallHouse) {
  check({"environments/aws_small_house", 145844, 85, 19, {-9.5F, -5.7F, 0}, {9.5F, 5.7F, 3}});
}

TEST(SharedData, Duplex) {
  check({"environments/ifc_duplex", 26720, 215, 16, {-0.2415F, -22.1827F, -1.55F}, {9.0415F, 4.3827F, 6.6348F}});
}

TEST(SharedData, SmallHouseIsTextured) {
  const auto folder = lapis::test::find_test_data("environments/aws_small_house");
  if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("environments/aws_small_house");
  const Scene scene = load_scene(*folder, {});
  std::size_t textured = 0;
  for (const auto& triangle : scene.mesh.triangles) textured += scene.mesh.materials[triangle.material].texture >= 0;
  EXPECT_GT(textured, scene.mesh.triangles.size() / 2);
}

}  // namespace
}  // namespace lapis::simulator
