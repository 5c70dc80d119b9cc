#include "simulator/core/furniture/parametric_furniture.hpp"

#include <gtest/gtest.h>

#include "small_building.hpp"

namespace lapis::simulator {
namespace {

TEST(ParametricFurniture, FillsItsBoxForEveryClassAndSize) {
  TextureLibrary textures;
  const mapping::LabelList labels = test::indoor_labels();
  for (const auto& label : labels.labels()) {
    const Eigen::Vector3d usual = default_size_m(label.name);
    EXPECT_GT(usual.minCoeff(), 0.0) << label.name;
    for (const Eigen::Vector3d& size : {usual, Eigen::Vector3d(0.3, 0.2, 2.0), Eigen::Vector3d(3.0, 1.0, 0.3)}) {
      const Mesh mesh = make_furniture(label.name, size, 3, textures);
      EXPECT_EQ(problem_of(mesh), "") << label.name;
      const auto box = bounds(mesh);
      const Eigen::Vector3f half = 0.5F * size.cast<float>();
      EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(-half.x(), -half.y(), 0.0F), 1e-4F)) << label.name;
      EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(half.x(), half.y(), 2 * half.z()), 1e-4F)) << label.name;
      EXPECT_GE(mesh.triangles.size(), 12U) << label.name;
      EXPECT_LE(mesh.triangles.size(), 3000U) << label.name;
    }
  }
}

TEST(ParametricFurniture, IsAFunctionOfItsArguments) {
  TextureLibrary first, second;
  for (const char* name : {"shelving", "chair", "clothes"}) {
    const Mesh a = make_furniture(name, default_size_m(name), 1, first);
    const Mesh b = make_furniture(name, default_size_m(name), 1, second);
    EXPECT_EQ(a.positions, b.positions) << name;
    ASSERT_EQ(a.materials.size(), b.materials.size()) << name;
    for (std::size_t i = 0; i < a.materials.size(); ++i) EXPECT_EQ(a.materials[i].color, b.materials[i].color) << name;
  }
  const Mesh books = make_furniture("shelving", default_size_m("shelving"), 1, first);
  EXPECT_NE(books.positions, make_furniture("shelving", default_size_m("shelving"), 2, first).positions);
}

}  // namespace
}  // namespace lapis::simulator
