#include "simulator/core/building/structure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/noise/random.hpp"
#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/scene/polygon.hpp"
#include "small_building.hpp"

namespace lapis::simulator {
namespace {

bool is_near(float a, double b) { return std::abs(a - b) < 1e-4; }

Scene built(const SceneSpec& spec) { return build_scene(spec, {}); }

/// Rays in all directions from points in all rooms.
void expect_closed(const Scene& scene) {
  const SceneRaycaster caster(scene.mesh);
  const Random random(1, RandomStream::kTexture);
  Eigen::AlignedBox3f box;
  for (const auto& room : scene.rooms) {
    for (const auto& corner : room.polygon) {
      box.extend(Eigen::Vector3f(static_cast<float>(corner.x()), static_cast<float>(corner.y()), 0.0F));
      box.extend(Eigen::Vector3f(static_cast<float>(corner.x()), static_cast<float>(corner.y()), 2.6F));
    }
  }
  std::uint64_t draw = 0;
  int casts = 0;
  while (casts < 20000) {
    const Eigen::Vector3d from(random.uniform(draw, box.min().x(), box.max().x()),
                               random.uniform(draw + 1, box.min().y(), box.max().y()),
                               random.uniform(draw + 2, 0.1, 2));
    const Eigen::Vector3d along(random.normal(draw + 3), random.normal(draw + 5), random.normal(draw + 7));
    draw += 9;
    const auto holds = [&](const Room& room) {
      return contains(room.polygon, Eigen::Vector2d(from.head<2>())) &&
             distance_to_border(room.polygon, from.head<2>()) > 0.05;
    };
    if (std::none_of(scene.rooms.begin(), scene.rooms.end(), holds)) continue;
    ++casts;
    const Ray ray{from.cast<float>(), along.normalized().cast<float>()};
    const auto hit = caster.cast(ray, 100.0F);
    ASSERT_TRUE(hit) << "from " << from.transpose() << " along " << along.normalized().transpose();
    const Eigen::Vector3f at = ray.origin + hit->distance * ray.direction;
    EXPECT_LT(box.exteriorDistance(at), 0.13F) << at.transpose();  // a pane lies in the wall
  }
}

TEST(Structure, WallsFloorAndCeilingHaveTheAreaOfTheRoom) {
  const Scene scene = built(test::two_rooms());
  const auto wall_area = [&](int axis, double at) {
    const auto is_on_it = [&](const Eigen::Vector3f& p) { return is_near(p[axis], at) && p.x() < 4.01F; };
    return test::area_of(scene, "wall", is_on_it);
  };
  EXPECT_NEAR(wall_area(0, 0), 3 * 2.6, 1e-3);
  EXPECT_NEAR(wall_area(0, 4), 3 * 2.6 - 0.9 * 2.05, 1e-3);
  EXPECT_NEAR(wall_area(1, 0), 4 * 2.6 - 1.2 * 1.2, 1e-3);
  EXPECT_NEAR(wall_area(1, 3), 4 * 2.6, 1e-3);
  const auto anywhere = [](const Eigen::Vector3f&) { return true; };
  // Half of the doorway's floor belongs to either room, and the closed door's to the right one.
  EXPECT_NEAR(test::area_of(scene, "floor", anywhere), 4 * 3 + 2.88 * 3 + 0.9 * 0.12 + 0.9 * 0.12, 1e-3);
  EXPECT_NEAR(test::area_of(scene, "ceiling", anywhere), 4 * 3 + 2.88 * 3, 1e-3);
}

TEST(Structure, RoomsAreClosed) { expect_closed(built(test::two_rooms())); }

TEST(Structure, RoomsWithSlantingWallsAndReentrantCornersAreClosed) {
  SceneSpec spec = test::two_rooms();
  spec.rooms[0].polygon = {{0, 0}, {4, 0}, {4, 3}, {2.5, 3}, {2.5, 2}, {1.2, 2.9}, {-0.7, 2.1}};
  spec.openings[1].at = {3, 0};
  const Scene scene = built(spec);
  expect_closed(scene);
  const auto is_left = [](const Eigen::Vector3f& p) { return p.x() < 4.01F; };
  EXPECT_NEAR(test::area_of(scene, "ceiling", is_left), signed_area(spec.rooms[0].polygon), 1e-3);
}

TEST(Structure, OneInstancePerPartOfARoomAndPerOpening) {
  const Scene scene = built(test::two_rooms());
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    EXPECT_EQ(scene.instances[i].id, i + 1);
    ++counts[scene.labels.name(scene.instances[i].class_id)];
  }
  const std::map<std::string, int> expected{{"wall", 8}, {"floor", 2},  {"ceiling", 2},
                                            {"door", 2}, {"window", 1}, {"lighting", 2}};
  EXPECT_EQ(counts, expected);
}

TEST(Structure, SurfacesLookIntoTheRoom) {
  const Scene scene = built(test::two_rooms());
  const Eigen::Vector3f middle(2, 1.5F, 1.3F);
  for (const auto& t : scene.mesh.triangles) {
    const std::string name = scene.instances[t.part].name;
    const bool is_plain = name.rfind("left/wall", 0) == 0 || name == "left/floor" || name == "left/ceiling";
    const auto &a = scene.mesh.positions[t.vertices[0]], &b = scene.mesh.positions[t.vertices[1]],
               &c = scene.mesh.positions[t.vertices[2]];
    if (!is_plain) continue;
    EXPECT_GT((b - a).cross(c - a).dot(middle - a), 0.0F) << name << " at " << a.transpose();
  }
}

TEST(Structure, CellsAreSmallEnoughToCarryLight) {
  const Scene scene = built(test::two_rooms());
  for (const auto& t : scene.mesh.triangles) {
    if (scene.instances[t.part].name != "left/floor") continue;
    for (const int i : {0, 1, 2}) {
      const auto k = static_cast<std::size_t>(i);
      const auto edge = scene.mesh.positions[t.vertices[k]] - scene.mesh.positions[t.vertices[(k + 1) % 3]];
      EXPECT_LT(edge.norm(), 0.46F);
    }
  }
}

}  // namespace
}  // namespace lapis::simulator
