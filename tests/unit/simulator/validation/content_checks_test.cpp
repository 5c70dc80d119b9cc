#include "simulator/core/validation/content_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "simulator/core/validation/overlap.hpp"
#include "simulator/core/validation/solid.hpp"
#include "simulator/core/validation/support.hpp"
#include "small_scenes.hpp"

namespace lapis::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> floating_names(const SceneSpec& spec) {
  const Scene scene = test::build(spec);
  const Inventory inventory = take_inventory(scene);
  std::vector<std::string> names;
  for (const std::size_t i : find_floating(scene, inventory)) names.push_back(inventory.items[i].name);
  return names;
}

std::vector<std::string> overlapping_pairs(const SceneSpec& spec) {
  const Scene scene = test::build(spec);
  const Inventory inventory = take_inventory(scene);
  std::vector<std::string> pairs;
  for (const Overlap& overlap : find_overlaps(scene, inventory))
    pairs.push_back(inventory.items[overlap.first].name + "+" + inventory.items[overlap.second].name);
  return pairs;
}

std::vector<std::string> protruding_names(const SceneSpec& spec) {
  const Scene scene = test::build(spec);
  const Inventory inventory = take_inventory(scene);
  std::vector<std::string> names;
  for (const Protrusion& out : find_protrusions(scene, inventory)) names.push_back(inventory.items[out.item].name);
  return names;
}

TEST(Inventory, HoldsItemsButNotTheBuildingAndKeepsEveryTriangle) {
  const Scene scene = test::build(test::good_spec());
  const Inventory inventory = take_inventory(scene);
  std::vector<std::string> names;
  std::size_t triangles = inventory.structure.size();
  for (const Item& item : inventory.items) {
    names.push_back(item.name);
    triangles += item.triangles.size();
  }
  EXPECT_THAT(names, ElementsAre("desk", "box", "chair", "cupboard", "living/picture 1", "living/picture 2", "lamp 1",
                                 "lamp 2"));
  EXPECT_EQ(triangles, scene.mesh.triangles.size());
}

TEST(Inventory, PartsOfAPieceOfFurnitureAreOneItem) {
  SceneSpec spec = test::two_rooms();
  FurnitureSpec& desk = test::add_item(spec, "desk", "table", {1.2, 0.6, 0.74}, {1.0, 2.65});
  desk.parts = {{"wood", "cabinet"}};
  const Scene scene = test::build(spec);
  const Inventory inventory = take_inventory(scene);
  ASSERT_EQ(inventory.items.size(), 3U) << "a desk and two lamps";
  EXPECT_EQ(inventory.items[0].name, "desk");
  EXPECT_NEAR(inventory.items[0].box.sizes().x(), 1.2, 1e-5);
}

TEST(SurfacePoints, AreNoFartherApartThanAsked) {
  Mesh mesh;
  mesh.materials.push_back({});
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {3, 0.01F, 0}, {0.3F, 2, 1}};
  mesh.triangles = {{{0, 1, 2}, 0, 0}, {{0, 1, 3}, 0, 0}};
  const auto points = surface_points(mesh, {0, 1}, 0.05F);
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.positions[triangle.vertices[0]], b = mesh.positions[triangle.vertices[1]],
                          c = mesh.positions[triangle.vertices[2]];
    for (float u = 0.0F; u <= 1.0F; u += 0.05F) {
      for (float v = 0.0F; u + v <= 1.0F; v += 0.05F) {
        const Eigen::Vector3f p = a + u * (b - a) + v * (c - a);
        float nearest = 1.0F;
        for (const auto& q : points) nearest = std::min(nearest, (q - p).norm());
        EXPECT_LE(nearest, 0.05F);
      }
    }
  }
  EXPECT_LT(surface_points(mesh, {0}, 0.05F).size(), 62U) << "slivers give few points";
}

TEST(Solid, ClosedThingsAreSolidAndOpenOnesAreNot) {
  SceneSpec spec = test::two_rooms();
  test::add_item(spec, "closed", "cabinet", {0.8, 0.6, 1.2}, {1.0, 1.0});
  test::add_item(spec, "open", "table", {0.8, 0.6, 1.2}, {2.5, 1.0});
  const Scene scene = test::build(spec);
  const Inventory inventory = take_inventory(scene);
  const double voxel_m3 = std::pow(Solid::kVoxel_m, 3), box_m3 = 0.8 * 0.6 * 1.2;
  const double closed_m3 = voxel_m3 * static_cast<double>(Solid(scene, inventory.items[0]).count());
  EXPECT_GT(closed_m3, 0.85 * box_m3);
  EXPECT_LT(closed_m3, 1.15 * box_m3) << "one voxel more on each side";
  EXPECT_LT(voxel_m3 * static_cast<double>(Solid(scene, inventory.items[1]).count()), 0.2 * box_m3);
}

/// A scene that holds one square in the plane z = 0.
Scene square(float edge_m) {
  Scene scene;
  scene.labels = test::small_labels();
  scene.mesh.positions = {{0, 0, 0}, {edge_m, 0, 0}, {edge_m, edge_m, 0}, {0, edge_m, 0}};
  scene.mesh.materials.resize(1);
  scene.mesh.triangles = {{{0, 1, 2}, 0, 0}, {{0, 2, 3}, 0, 1}};
  scene.instances = {{1, 7, "a"}, {2, 8, "b"}};
  return scene;
}

TEST(Overlaps, ThingsPastAllBoundsAreNotFilledWithVoxels) {
  const Scene scene = square(1e4F);
  EXPECT_THAT(find_overlaps(scene, take_inventory(scene)), IsEmpty());
}

TEST(SurfacePoints, OfAThingPastAllBoundsAreRefusedWithItsExtent) {
  const Scene scene = square(1e4F);
  EXPECT_THAT(
      [&] {
        surface_points(scene.mesh, {0, 1}, 0.02F);
      },
      testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("measures 10000 10000")));
}

TEST(Floating, NothingFloatsInAGoodScene) { EXPECT_THAT(floating_names(test::good_spec()), IsEmpty()); }

TEST(Floating, ItemsFloatFromThreeCentimetresOn) {
  for (const double elevation_m : {-0.005, 0.0, 0.025, 0.035, 0.5}) {
    SceneSpec spec = test::two_rooms();
    test::add_item(spec, "desk", "table", {1.2, 0.6, 0.74}, {2.0, 1.5}, elevation_m);
    EXPECT_EQ(floating_names(spec).size(), elevation_m > 0.03 ? 1U : 0U) << elevation_m << " m above the floor";
  }
}

TEST(Floating, AWallHoldsWhatHangsAtIt) {
  for (const double gap_m : {0.0, 0.02, 0.05, 0.3}) {
    for (const double turn_rad : {0.0, 0.3}) {
      SceneSpec spec = test::two_rooms();
      RoomSpec& room = spec.rooms[0];  // its west wall slants
      room.polygon[3].x() = std::tan(turn_rad) * 3.0;
      FurnitureSpec& board = test::add_item(spec, "board", "cabinet", {0.8, 0.3, 0.4}, {0, 0}, 1.2);
      board.place = AgainstWall{"living", 3, 1.5, gap_m};
      EXPECT_EQ(floating_names(spec).size(), gap_m > 0.03 ? 1U : 0U) << gap_m << " m from the wall";
    }
  }
}

TEST(Floating, TheCeilingHoldsWhatHangsFromIt) {
  SceneSpec spec = test::two_rooms();
  test::add_item(spec, "hanging", "objects", {0.3, 0.3, 0.5}, {1, 1}, 2.09);
  EXPECT_THAT(floating_names(spec), IsEmpty());
  spec.furniture[0].elevation_m = 1.9;
  EXPECT_THAT(floating_names(spec), ElementsAre("hanging"));
}

TEST(Floating, WhatStandsOnAFloatingThingFloatsToo) {
  SceneSpec spec = test::good_spec();
  spec.furniture[0].elevation_m = 0.2;
  spec.furniture[0].place = AtPoint{{1.0, 2.55}, 0.0};  // clear of chair and wall
  EXPECT_THAT(floating_names(spec), ElementsAre("desk", "box"));
  const Scene scene = test::build(spec);
  const Check check = check_floating(scene, take_inventory(scene));
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_THAT(check.details.at(0), ::testing::HasSubstr("desk"));
}

TEST(Overlaps, NothingOverlapsInAGoodScene) { EXPECT_THAT(overlapping_pairs(test::good_spec()), IsEmpty()); }

TEST(Overlaps, SixCentimetresAreContactAndMoreThanTenAreNot) {
  for (const double start_m : {0.0, 0.007, 0.013}) {  // wherever the voxels begin
    for (const double depth_m : {-0.001, 0.0, 0.06, 0.11, 0.3}) {
      SceneSpec spec = test::two_rooms();
      test::add_item(spec, "a", "cabinet", {0.8, 0.4, 1.2}, {1.0 + start_m, 1.5});
      test::add_item(spec, "b", "cabinet", {0.8, 0.4, 0.9}, {1.8 + start_m - depth_m, 1.5});
      EXPECT_EQ(overlapping_pairs(spec).size(), depth_m > 0.1 ? 1U : 0U) << depth_m << " m deep, from " << start_m;
    }
  }
}

TEST(Overlaps, ThingsThatLieOnOthersOnlyTouchThem) {
  for (const double start_m : {0.0, 0.007, 0.013}) {
    SceneSpec spec = test::two_rooms();
    test::add_item(spec, "desk", "table", {1.2, 0.6, 0.74 + start_m}, {1.0 + start_m, 1.5});
    test::put_on(spec, "leaflet", "objects", {0.3, 0.2, 0.03}, "desk");
    test::add_item(spec, "stool", "objects", {0.4, 0.4, 0.5}, {1.0, 1.3});  // under the desk
    EXPECT_THAT(overlapping_pairs(spec), IsEmpty()) << start_m;
  }
}

TEST(Overlaps, ACushionMayBePressedInBySixCentimetres) {
  SceneSpec spec = test::two_rooms();
  test::add_item(spec, "bench", "cabinet", {1.2, 0.6, 0.45}, {1.0, 1.5});
  test::put_on(spec, "cushion", "cushion", {0.4, 0.4, 0.16}, "bench", -0.06);
  EXPECT_THAT(overlapping_pairs(spec), IsEmpty());
  spec.furniture.back().elevation_m = -0.14;
  EXPECT_THAT(overlapping_pairs(spec), ElementsAre("bench+cushion"));
}

TEST(Overlaps, WhatPassesThroughAThinThingOrLiesInAThingOverlaps) {
  SceneSpec through = test::two_rooms();  // the back of a chair in a table top
  test::add_item(through, "desk", "table", {1.6, 0.9, 0.74}, {1.0, 1.5});
  test::add_item(through, "chair", "chair", {0.45, 0.45, 1.0}, {1.0, 1.3});
  EXPECT_THAT(overlapping_pairs(through), ElementsAre("desk+chair"));

  SceneSpec twice = test::two_rooms();
  test::add_item(twice, "a", "table", {1.2, 0.6, 0.74}, {1.0, 1.5});
  test::add_item(twice, "b", "table", {1.2, 0.6, 0.74}, {1.0, 1.5});
  EXPECT_THAT(overlapping_pairs(twice), ElementsAre("a+b"));

  SceneSpec inside = test::two_rooms();
  test::add_item(inside, "cupboard", "cabinet", {0.8, 0.5, 1.2}, {1.0, 1.5});
  test::add_item(inside, "box", "objects", {0.3, 0.2, 0.3}, {1.0, 1.5}, 0.5);
  EXPECT_THAT(overlapping_pairs(inside), ElementsAre("cupboard+box"));
  const Scene scene = test::build(inside);
  EXPECT_EQ(check_overlaps(scene, take_inventory(scene)).verdict, Verdict::kFail);
}

TEST(Walls, ThreeCentimetresMayStickIntoWallFloorOrCeiling) {
  for (const double depth_m : {0.0, 0.025, 0.05}) {
    SceneSpec west = test::two_rooms(), below = west, above = west;
    test::add_item(west, "a", "cabinet", {0.8, 0.4, 1.2}, {0.4 - depth_m, 1.5});
    test::add_item(below, "a", "cabinet", {0.8, 0.4, 1.2}, {2.0, 1.5}, -depth_m);
    test::add_item(above, "a", "cabinet", {0.8, 0.4, 1.2}, {2.0, 1.5}, 1.4 + depth_m);
    for (const SceneSpec& spec : {west, below, above})
      EXPECT_EQ(protruding_names(spec).size(), depth_m > 0.03 ? 1U : 0U) << depth_m << " m deep";
  }
}

TEST(Walls, WhatIsOutsideOfTheBuildingIsReportedByName) {
  SceneSpec spec = test::good_spec();
  EXPECT_THAT(protruding_names(spec), IsEmpty());
  test::add_item(spec, "wedge", "objects", {0.3, 0.2, 0.3}, {20.0, 1.5});
  const Scene scene = test::build(spec);
  const Check check = check_walls(scene, take_inventory(scene));
  EXPECT_EQ(check.verdict, Verdict::kFail);
  ASSERT_EQ(check.details.size(), 1U);
  EXPECT_THAT(check.details[0], ::testing::HasSubstr("wedge"));
}

TEST(Classes, AreCountedAndFewOfThemAreANote) {
  const Scene scene = test::build(test::good_spec());
  const Check check = count_classes(scene, take_inventory(scene));
  EXPECT_EQ(check.verdict, Verdict::kNote) << "less than 16 classes";
  EXPECT_THAT(check.figures, ::testing::StartsWith("8 items, 2 pictures among them; "));
  EXPECT_THAT(check.details, ::testing::Contains(::testing::StartsWith("table: 1 item, ")));
}

}  // namespace
}  // namespace lapis::simulator
