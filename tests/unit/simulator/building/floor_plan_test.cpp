#include "simulator/core/building/floor_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/scene/polygon.hpp"
#include "small_building.hpp"

namespace lapis::simulator {
namespace {

using Change = std::function<void(SceneSpec&)>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

FurnitureSpec item(const std::string& id, const std::string& class_name, const Eigen::Vector2d& at) {
  FurnitureSpec spec;
  spec.id = id;
  spec.class_name = class_name;
  spec.place = AtPoint{at, 0.0};
  return spec;
}

TEST(FloorPlan, OpeningsAreCutIntoBothWalls) {
  const auto plan = plan_walls(normalised(test::two_rooms()));
  const Wall &left = plan[0].walls[1], &right = plan[1].walls[3];
  ASSERT_EQ(left.openings.size(), 1U);
  ASSERT_EQ(right.openings.size(), 1U);
  EXPECT_NEAR(left.openings[0].depth_m, 0.06, 1e-9);
  // Seen from both sides it is the same hole.
  EXPECT_TRUE(left.at(left.openings[0].from_m, -0.06).isApprox(right.at(right.openings[0].to_m, -0.06), 1e-9));
  ASSERT_EQ(plan[0].walls[0].openings.size(), 1U);
  EXPECT_NEAR(plan[0].walls[0].openings[0].depth_m, 0.12, 1e-9);
}

TEST(FloorPlan, ClockwiseRoomsKeepTheMeaningOfTheirWalls) {
  SceneSpec spec = test::two_rooms();
  FurnitureSpec table;
  table.class_name = "table";
  table.place = AgainstWall{"left", 1, 0.8, 0.02, 0.0};
  spec.furniture = {table};
  SceneSpec clockwise = spec;
  clockwise.rooms[0].polygon = {{0, 3}, {4, 3}, {4, 0}, {0, 0}};  // wall 1 still is the eastern one, from the north
  std::get<AgainstWall>(clockwise.furniture[0].place).along_m = 3.0 - 0.8;
  const SceneSpec a = normalised(spec), b = normalised(clockwise);
  EXPECT_GT(signed_area(b.rooms[0].polygon), 0.0);
  const auto where = [](const SceneSpec& s) {
    const auto& place = std::get<AgainstWall>(s.furniture[0].place);
    return plan_walls(s)[0].walls[static_cast<std::size_t>(place.edge)].at(place.along_m, 0.0);
  };
  EXPECT_TRUE(where(a).isApprox(where(b), 1e-9)) << where(a).transpose() << " / " << where(b).transpose();
}

TEST(FloorPlan, MotifsThatAreLeftOutAreFreeNumbers) {
  SceneSpec spec = test::two_rooms();
  PictureSpec picture;
  picture.room = "right";
  picture.edge = 2;
  picture.along_m = 1.0;
  spec.pictures = {picture, picture, picture};
  spec.pictures[1].motif = 0;
  const SceneSpec result = normalised(spec);
  EXPECT_EQ(result.pictures[0].motif, 1U);
  EXPECT_EQ(result.pictures[1].motif, 0U);
  EXPECT_EQ(result.pictures[2].motif, 2U);
}

/// What is wrong, and what the message has to name.
struct Mistake {
  std::string named;
  Change make;
};

void against(SceneSpec& spec, const std::string& room, int edge, double along) {
  spec.furniture = {item("desk", "table", {1, 1})};
  spec.furniture[0].place = AgainstWall{room, edge, along, 0.02, 0.0};
}

void add_picture(SceneSpec& spec, int edge, double along) {
  PictureSpec picture;
  picture.room = "left";
  picture.edge = edge;
  picture.along_m = along;
  spec.pictures.push_back(picture);
}

std::vector<Mistake> mistakes() {
  return {
      {R"(room "left": its outline)",
       [](SceneSpec& s) {
         s.rooms[0].polygon = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
       }},
      {R"(room "left": must have at most 100 m)", [](SceneSpec& s) { s.rooms[0].polygon[1].x() = 1e9; }},
      {R"(room "left": must have)",
       [](SceneSpec& s) {
         s.rooms[0].polygon = {{0, 0}, {60, 0}, {60, 40}, {0, 40}};
       }},
      {R"(room "left": must have)", [](SceneSpec& s) { s.rooms[0].polygon[1].x() = std::nan(""); }},
      {R"(room "left": the id occurs twice)", [](SceneSpec& s) { s.rooms[1].id = "left"; }},
      {R"(no texture is called "marble")", [](SceneSpec& s) { s.rooms[1].floor.texture = "marble"; }},
      {R"(room "right": height)", [](SceneSpec& s) { s.rooms[1].height_m = 0.5; }},
      {"rooms: there are none", [](SceneSpec& s) { s.rooms.clear(); }},
      {R"(no class "wall")",
       [](SceneSpec& s) {
         s.labels = mapping::LabelList::from_names({{1, "chair"}});
       }},
      {"opening 1: no wall",
       [](SceneSpec& s) {
         s.openings[0].at = {2, 1.5};
       }},
      {"opening 1: leaves",
       [](SceneSpec& s) {
         s.openings[0].at = {4.06, 0.2};
       }},
      {"opening 1: is wider", [](SceneSpec& s) { s.openings[0].width_m = 3.5; }},
      {"opening 1: leads outside",
       [](SceneSpec& s) {
         s.openings[0].at = {2, 3};
       }},
      {"opening 1: is higher", [](SceneSpec& s) { s.openings[0].top_m = 2.7; }},
      {"opening 4: meets opening 1", [](SceneSpec& s) { s.openings.push_back(s.openings[0]); }},
      {"opening 2: top", [](SceneSpec& s) { s.openings[1].top_m = 0.5; }},
      {R"(no room "attic")", [](SceneSpec& s) { against(s, "attic", 0, 1); }},
      {R"(item "desk": room "left" has no wall 4)", [](SceneSpec& s) { against(s, "left", 4, 1); }},
      {R"(item "desk": wall 0)", [](SceneSpec& s) { against(s, "left", 0, 4.5); }},
      {R"(no class "throne")",
       [](SceneSpec& s) {
         s.furniture = {item("a", "throne", {1, 1})};
       }},
      {R"(item "a": the id occurs twice)",
       [](SceneSpec& s) {
         s.furniture = {item("a", "chair", {1, 1}), item("a", "chair", {2, 2})};
       }},
      {R"(no item "desk")",
       [](SceneSpec& s) {
         s.furniture = {item("lamp", "lighting", {1, 1})};
         s.furniture[0].place = OnItem{"desk", {0, 0}, 0.0};
       }},
      {"picture 1: meets opening 1", [](SceneSpec& s) { add_picture(s, 1, 1.0); }},
      {"picture 1: leaves its wall", [](SceneSpec& s) { add_picture(s, 2, 0.1); }},
      {"picture 1: meets picture 2",
       [](SceneSpec& s) {
         add_picture(s, 2, 2.0);
         add_picture(s, 2, 2.2);
       }},
      {"start 1: lies in no room",
       [](SceneSpec& s) {
         s.starts = {{{4.06, 1.0}, 0.0}};
       }},
      {"tour point 2",
       [](SceneSpec& s) {
         s.tour = {{1, 1}, {9, 9}};
       }},
      {"lamp 1: lies in no room",
       [](SceneSpec& s) {
         s.lamps = {{{9, 9}, {}, 1.0}};
       }},
      {"lamp 1: height must be from 0.1 to 2.6",
       [](SceneSpec& s) {
         s.lamps = {{{1, 1}, 1e8, 1.0}};
       }},
      {"lamp 1: intensity must be from 0 to 1000",
       [](SceneSpec& s) {
         s.lamps = {{{1, 1}, {}, kNan}};
       }},
      {R"(item "a": at must be from -1000 to 1000)",
       [](SceneSpec& s) {
         s.furniture = {item("a", "chair", {1, 1e8})};
       }},
      {R"(item "a": elevation must be from -50 to 50)",
       [](SceneSpec& s) {
         s.furniture = {item("a", "chair", {1, 1})};
         s.furniture[0].elevation_m = kNan;
       }},
      {R"(item "desk": gap must be from -1 to 100)",
       [](SceneSpec& s) {
         against(s, "left", 0, 1);
         std::get<AgainstWall>(s.furniture[0].place).gap_m = 1e8;
       }},
      {R"(item "b": offset must be from -50 to 50)",
       [](SceneSpec& s) {
         s.furniture = {item("a", "chair", {1, 1}), item("b", "chair", {1, 1})};
         s.furniture[1].place = OnItem{"a", {0, -1e8}, 0.0};
       }},
  };
}

TEST(FloorPlan, MistakesAreNamedInOneLine) {
  for (const Mistake& mistake : mistakes()) {
    SceneSpec spec = test::two_rooms();
    mistake.make(spec);
    const std::string error = test::error_of([&] { build_scene(spec, {}); });
    EXPECT_EQ(error.rfind("two_rooms.yaml: ", 0), 0U) << error;
    EXPECT_NE(error.find(mistake.named), std::string::npos) << "expected \"" << mistake.named << "\" in: " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace lapis::simulator
