#include "simulator/core/truth/mesh_voxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "box_world.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

using Labels = std::map<mapping::VoxelIndex, std::uint16_t>;

Labels labels(const Scene& scene, const geometry::Pose& T_map_world, double resolution_m) {
  const VoxelBox box = voxel_box(scene, T_map_world, resolution_m);
  Labels out;
  for (const auto& voxel : surface_voxels(scene, T_map_world, box)) out[box.index_of(voxel.cell)] = voxel.label;
  return out;
}

Scene random_triangles(std::uint64_t seed, int count, double size_m) {
  const Random random(seed, RandomStream::kTruth);
  Scene scene;
  scene.mesh.materials.push_back({"grey", {}});
  std::uint64_t next = 0;
  const auto draw = [&](double low, double high) { return static_cast<float>(random.uniform(next++, low, high)); };
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const Eigen::Vector3f middle(draw(-1, 1), draw(-1, 1), draw(0, 1));
    const auto size = static_cast<float>(size_m);
    for (int k = 0; k < 3; ++k) {
      scene.mesh.positions.emplace_back(middle +
                                        Eigen::Vector3f(draw(-size, size), draw(-size, size), draw(-size, size)));
    }
    scene.instances.push_back({static_cast<std::uint16_t>(i + 1), static_cast<std::uint16_t>(i % 4), ""});
    scene.mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, 0, i});
  }
  return scene;
}

TEST(SurfaceVoxels, OfARoomAreItsShell) {
  // All walls run through the middle of voxels: 17 x 13 x 11 voxels, all but the inner ones.
  const auto shell = labels(test::room({4, 3, 2.5}), test::translation(0.125, 0.125, 0.125), 0.25);
  EXPECT_EQ(shell.size(), 17U * 13 * 11 - 15U * 11 * 9);
  for (const auto& [voxel, label] : shell) EXPECT_EQ(label, 1);
}

std::string error_of(const Scene& scene, double resolution_m) {
  try {
    surface_voxels(scene, geometry::Pose::Identity(), voxel_box(scene, geometry::Pose::Identity(), resolution_m));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(SurfaceVoxels, OfAScenePastAllBoundsAreRefusedWithItsExtent) {
  for (const double size_m : {100.0, 3e4, 1e5}) {
    const Eigen::Vector3d size(size_m, size_m, size_m);
    EXPECT_NE(error_of(test::room(size.cast<float>()), 0.1).find("measures"), std::string::npos) << size_m;
  }
  EXPECT_NE(error_of(test::room({100, 200, 300}), 0.1).find("100 200 300 m, too much for voxels of 0.1 m"),
            std::string::npos);
  EXPECT_EQ(error_of(test::room({10, 20, 30}), 0.1), "");
  Scene none = test::room({1, 1, 1});
  none.mesh = {};
  EXPECT_NE(error_of(none, 0.1), "");
}

TEST(SurfaceVoxels, TooMuchSurfaceIsRefused) {
  Scene scene = test::room({60, 60, 0.1F});
  const std::vector<Triangle> once = scene.mesh.triangles;
  EXPECT_EQ(error_of(scene, 0.05), "");
  for (int i = 0; i < 40; ++i) scene.mesh.triangles.insert(scene.mesh.triangles.end(), once.begin(), once.end());
  EXPECT_NE(error_of(scene, 0.05).find("too much surface for voxels of 0.05 m"), std::string::npos);
}

TEST(SurfaceVoxels, ASurfaceInTheFaceBetweenTwoVoxelsIsInBoth) {
  // The shell inside, and six sheets outside, which have no edges.
  const auto shell = labels(test::room({4, 3, 2.5}), geometry::Pose::Identity(), 0.25);
  EXPECT_EQ(shell.size(), (16U * 12 * 10 - 14U * 10 * 8) + 2 * (12U * 10 + 16U * 10 + 16U * 12));
  EXPECT_TRUE(shell.contains({8, 6, 0}) && shell.contains({8, 6, -1}));
}

TEST(SurfaceVoxels, HaveTheClassOfTheLargestArea) {
  // In one voxel of 1 m: class 7 with 0.4 m2 in two parts, class 3 with 0.3 m2, unlabelled with 0.6 m2.
  Scene scene = test::room({0, 0, 0});
  scene.mesh = {};
  scene.mesh.materials.push_back({"grey", {}});
  scene.instances = {{1, 7, ""}, {2, 3, ""}, {3, 0, ""}, {4, 7, ""}};
  const auto sheet = [&](float y, float width, std::uint32_t part) {
    test::add_quad(scene, {{{0.2F, y, 0.25F}, {0.2F + width, y, 0.25F}, {0.2F + width, y, 0.75F}, {0.2F, y, 0.75F}}}, 0,
                   part);
  };
  sheet(0.1F, 0.4F, 0);
  sheet(0.2F, 0.6F, 1);
  sheet(0.3F, 0.6F, 2);
  sheet(0.4F, 0.6F, 2);
  sheet(0.5F, 0.4F, 3);
  for (auto& p : scene.mesh.positions) p *= 0.5F;
  EXPECT_EQ(labels(scene, geometry::Pose::Identity(), 0.5), (Labels{{{0, 0, 0}, 7}}));
  scene.instances[0].class_id = scene.instances[1].class_id = scene.instances[3].class_id = 0;
  EXPECT_EQ(labels(scene, geometry::Pose::Identity(), 0.5), (Labels{{{0, 0, 0}, 0}}));
}

TEST(SurfaceVoxels, CutTrianglesAsDensePointsDo) {
  constexpr double kResolution_m = 0.25;
  constexpr int kSteps = 400;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Scene scene = random_triangles(seed, 30, seed % 2 == 0 ? 0.1 : 0.8);
    std::map<mapping::VoxelIndex, std::array<double, 4>> areas;  // by class [faces of a voxel]
    for (const auto& triangle : scene.mesh.triangles) {
      const auto p = [&](std::size_t i) -> Eigen::Vector3d {
        return scene.mesh.positions[triangle.vertices[i]].cast<double>() / kResolution_m;
      };
      const Eigen::Vector3d a = p(1) - p(0), b = p(2) - p(0);
      const double area = a.cross(b).norm() / (kSteps * kSteps);  // of a point; half of the square is used
      for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; i + j < kSteps; ++j) {
          const Eigen::Vector3d q = (p(0) + (i + 0.33) / kSteps * a + (j + 0.33) / kSteps * b).array().floor();
          areas[{static_cast<int>(q.x()), static_cast<int>(q.y()), static_cast<int>(q.z())}]
               [scene.instances[triangle.part].class_id] += area;
        }
      }
    }
    const auto found = labels(scene, geometry::Pose::Identity(), kResolution_m);
    int compared = 0;
    for (const auto& [voxel, by_class] : areas) {
      const double total = by_class[0] + by_class[1] + by_class[2] + by_class[3];
      ASSERT_TRUE(total < kLeastArea * 1.1 || found.contains(voxel));
      if (total < kLeastArea * 0.5) continue;  // near the limit, either is right
      for (std::uint16_t c = 1; c < 4; ++c) {
        bool is_clear = by_class[c] > 0.02;
        for (std::uint16_t other = 1; other < 4; ++other) is_clear &= other == c || by_class[c] > 1.2 * by_class[other];
        if (!is_clear) continue;
        ASSERT_EQ(found.at(voxel), c);
        ++compared;
      }
    }
    EXPECT_GT(compared, 20);
    for (const auto& [voxel, label] : found) {
      double near = 0.0;  // with what touches the voxel from its neighbours
      for (int i = 0; i < 27; ++i) {
        const auto it = areas.find({voxel.x + i % 3 - 1, voxel.y + i / 3 % 3 - 1, voxel.z + i / 9 - 1});
        if (it != areas.end()) near += it->second[0] + it->second[1] + it->second[2] + it->second[3];
      }
      EXPECT_GT(near, kLeastArea * 0.9);
    }
  }
}

TEST(SurfaceVoxels, InTheMapFrameAreThoseOfTheMovedMesh) {
  Scene scene = random_triangles(11, 200, 0.3);
  const geometry::Pose T = test::planar_pose(3.3, -1.7, 0.7);
  const auto in_map = labels(scene, T, 0.1);
  Mesh moved;
  append(moved, scene.mesh, Eigen::Affine3f(T.cast<float>()), 0);
  for (std::size_t i = 0; i < moved.triangles.size(); ++i) moved.triangles[i].part = scene.mesh.triangles[i].part;
  scene.mesh = moved;
  EXPECT_EQ(in_map, labels(scene, geometry::Pose::Identity(), 0.1));
  EXPECT_GT(in_map.size(), 500U);
}

TEST(SurfaceVoxels, ASceneInMillimetresIsRefused) {
  Scene scene = test::room({40000, 30000, 2600});
  EXPECT_THROW(voxel_box(scene, geometry::Pose::Identity(), 0.05), std::runtime_error);
}

TEST(VoxelBoxTest, CellsAndIndicesAreInverse) {
  const VoxelBox box(Eigen::AlignedBox3d(Eigen::Vector3d(-1, -2, 0), Eigen::Vector3d(1, 0.3, 0.9)), 0.25);
  VoxelSet set(box);
  for (std::size_t cell = 0; cell < box.size(); cell += 3) {
    EXPECT_EQ(box.cell(box.offset_of(cell)), cell);
    set.insert(cell);
  }
  EXPECT_EQ(set.cells().size(), set.count());
  EXPECT_EQ(set.count(), (box.size() + 2) / 3);
  const Eigen::Vector3d p(-0.9, 0.1, 0.6);
  const Eigen::Vector3i v = box.to_box(p).array().floor().cast<int>();
  EXPECT_EQ(box.index_of(box.cell(v)), mapping::VoxelMap(0.25).index_of(p));
}

}  // namespace
}  // namespace lapis::simulator
