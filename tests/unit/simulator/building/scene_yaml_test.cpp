#include "simulator/scene_yaml.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <tuple>

#include "common/mapping/file/label_list_file.hpp"
#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/building/floor_plan.hpp"
#include "small_building.hpp"

namespace lapis::simulator {
namespace {

using test::SceneFolder;

const std::string kRooms =
    "rooms:\n"
    "  - {id: a, rect: [0, 0, 4, 3]}\n"
    "  - {id: b, polygon: [[5, 0], [5, 3], [8, 3], [8, 0]]}\n";  // clockwise

std::string example_of_the_document() {
  std::ifstream in(test::source_folder() / "docs/scenes.md");
  std::stringstream all;
  all << in.rdbuf();
  const std::string text = all.str(), fence = "```yaml\n";
  const auto begin = text.find(fence) + fence.size();
  return text.substr(begin, text.find("```", begin) - begin);
}

TEST(SceneYaml, ExampleOfTheDocumentIsAScene) {
  const SceneFolder folder;
  const SceneSpec spec = read_scene_yaml(folder.write(example_of_the_document()));
  EXPECT_EQ(spec.name, "scene");
  ASSERT_EQ(spec.rooms.size(), 2U);
  EXPECT_EQ(spec.rooms[0].wall.color, (geometry::Rgb8{236, 228, 214}));
  EXPECT_EQ(spec.rooms[1].height_m, 2.4);
  EXPECT_EQ(spec.openings.size(), 3U);
  EXPECT_EQ(spec.openings[1].kind, OpeningKind::kWindow);
  EXPECT_EQ(spec.furniture.size(), 8U);
  const auto& sofa = std::get<AgainstWall>(spec.furniture[0].place);
  EXPECT_EQ(sofa.edge, 2);
  EXPECT_NEAR(sofa.along_m, 5.2 - 2.6, 1e-9);
  EXPECT_NEAR(std::get<AtPoint>(spec.furniture[4].place).yaw_rad, -std::numbers::pi / 2, 1e-9);
  EXPECT_TRUE(std::get<AtPoint>(spec.furniture[7].place).at.isApprox(Eigen::Vector2d(4.2, 1.0)));
  EXPECT_EQ(spec.pictures[1].class_name, "mirror");
  EXPECT_EQ(spec.starts.size(), 1U);
  EXPECT_EQ(spec.tour.size(), 3U);
  EXPECT_EQ(build_scene(spec, {}).rooms.size(), 2U);
}

TEST(SceneYaml, PlacesOnWallsMeanTheSamePoint) {
  const SceneFolder folder;
  const std::string items =
      "furniture:\n"
      "  - {class: chair, room: ROOM, wall: east, y: 1.0}\n"
      "  - {class: chair, room: ROOM, wall: NUMBER, along: ALONG}\n"
      "  - {class: chair, room: ROOM, wall: NUMBER, along: BACK}\n";
  for (const auto& [room, number, along, back] :
       {std::array{"a", "1", "1", "-2"}, std::array{"b", "2", "2", "-1"}}) {  // b runs clockwise
    std::string text = kRooms + items;
    for (const auto& [key, value] : {std::pair{"ROOM", room}, {"NUMBER", number}, {"ALONG", along}, {"BACK", back}}) {
      for (auto at = text.find(key); at != std::string::npos; at = text.find(key))
        text.replace(at, std::strlen(key), value);
    }
    const SceneSpec spec = normalised(read_scene_yaml(folder.write(text)));
    const auto plan = plan_walls(spec);
    for (const auto& item : spec.furniture) {
      const auto& place = std::get<AgainstWall>(item.place);
      const auto& walls = plan[room[0] == 'a' ? 0 : 1].walls;
      const Eigen::Vector2d at = walls[static_cast<std::size_t>(place.edge)].at(place.along_m, 0.0);
      EXPECT_TRUE(at.isApprox(Eigen::Vector2d(room[0] == 'a' ? 4 : 8, 1.0), 1e-9)) << room << ": " << at.transpose();
    }
  }
}

TEST(SceneYaml, RowsRepeatItems) {
  const SceneFolder folder;
  const SceneSpec spec = read_scene_yaml(
      folder.write(kRooms + "furniture:\n"
                            "  - {id: desk, class: table, room: a, wall: 0, along: 0.5, row: {count: 3, step: 1.1}}\n"
                            "pictures:\n"
                            "  - {room: a, wall: 2, along: 0.5, motif: 7, row: {count: 2, step: 0.9}}\n"));
  ASSERT_EQ(spec.furniture.size(), 3U);
  EXPECT_EQ(spec.furniture[2].id, "desk.3");
  EXPECT_NEAR(std::get<AgainstWall>(spec.furniture[2].place).along_m, 2.7, 1e-9);
  ASSERT_EQ(spec.pictures.size(), 2U);
  EXPECT_NEAR(spec.pictures[1].along_m, 1.4, 1e-9);
  EXPECT_EQ(spec.pictures[1].motif, 8U);
}

TEST(SceneYaml, MistakesNameFileAndLine) {
  const SceneFolder folder;
  const std::vector<std::pair<std::string, std::string>> cases{
      {"colour: red\n", ":4: scene: unknown key \"colour\""},
      {"openings:\n  - {door: [4, 1], widht: 2}\n", ":5: opening: unknown key \"widht\"; known are"},
      {"openings:\n  - {width: 2}\n", ":5: opening: give one of"},
      {"openings:\n  - {door: [4]}\n", ":5: door: must be 2 numbers"},
      {"furniture:\n  - {at: [1, 1]}\n", ":5: item: key \"class\" is missing"},
      {"furniture:\n  - {class: chair, at: [1, x]}\n", ":5: at: must be a number, not \"x\""},
      {"furniture:\n  - {class: chair, at: [1, .nan]}\n", ":5: at: must be a number"},
      {"furniture:\n  - {class: chair, at: [1, 1], room: a, wall: 0}\n", ":5: item: give one of at, room, on"},
      {"furniture:\n  - {class: chair, room: a}\n", ":5: item: key \"wall\" is missing"},
      {"furniture:\n  - {class: chair, room: c, wall: 0}\n", ":5: item: there is no room \"c\""},
      {"furniture:\n  - {class: chair, room: a, wall: 9}\n", ":5: item: room \"a\" has no wall 9"},
      {"furniture:\n  - {class: chair, room: a, wall: up}\n", ":5: item: wall must be a number, north"},
      {"furniture:\n  - {class: chair, room: a, wall: 0, y: 2}\n", ":5: item: y does not change along that wall"},
      {"furniture:\n  - {class: chair, at: [1, 1], movable: maybe}\n", ":5: movable: must be true or false"},
      {"furniture:\n  - {class: chair, at: [1, 1], at: [2, 2]}\n", ":5: key \"at\" occurs twice"},
      {"furniture:\n  - {class: chair, at: [1, 1], row: {count: 0, step: [1, 0]}}\n", ":5: row: count"},
      {"furniture:\n  - {class: chair, at: [1, 1], row: {count: 1001, step: [1, 0]}}\n", ":5: row: count"},
      {"furniture:\n  - {class: chair, at: [1, 1e300]}\n", ":5: at: must be a number, not \"1e300\""},
      {"furniture:\n  - {class: chair, at: [1, 1], elevation: .inf}\n", ":5: elevation: must be a number"},
      {"furniture:\n  - {class: chair, at: [1, 1], variant: -1}\n", ":5: item: variant must not be negative"},
      {"tour: [[1, 2], 3]\n", ":4: tour: must be 2 numbers"},
      {"openings: {door: [4, 1]}\n", ":4: openings: must be a list"},
      {"labels: nowhere.yaml\n", "nowhere.yaml: not found"},
      {"tour: [[1, 2]\n", "not valid YAML"},
  };
  for (const auto& [text, expected] : cases) {
    const auto file = folder.write(kRooms + text);
    const std::string error = test::error_of([&] { read_scene_yaml(file); });
    EXPECT_NE(error.find(expected), std::string::npos) << "expected \"" << expected << "\" in: " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  EXPECT_NE(test::error_of([] { read_scene_yaml("/nowhere/scene.yaml"); }).find("/nowhere/scene.yaml: not found"),
            std::string::npos);
  EXPECT_NE(test::error_of([] { read_scene_yaml("/dev/null"); }).find("/dev/null: is not a file"), std::string::npos);
}

TEST(SceneYaml, PolygonsHaveThreeToTwoHundredCorners) {
  const SceneFolder folder;
  std::string many = "[0, 0]";
  for (int i = 1; i <= 200; ++i) many += ", [" + std::to_string(i) + ", 1]";
  for (const std::string& corners : {std::string(), std::string("[0, 0], [1, 1]"), many}) {
    const auto file = folder.write("rooms:\n  - {id: a, polygon: [" + corners +
                                   "]}\nfurniture:\n  - {class: chair, room: a, wall: 0}\n");
    const std::string error = test::error_of([&] { read_scene_yaml(file); });
    EXPECT_EQ(error, file.string() + ":2: room: polygon must have from 3 to 200 corners");
  }
}

TEST(SceneYaml, HugeListsAreRefused) {
  const SceneFolder folder;
  std::string text = kRooms + "furniture:\n";
  for (int i = 0; i < 11; ++i) text += "  - {class: chair, at: [1, 1], row: {count: 1000, step: [0, 0]}}\n";
  const std::string error = test::error_of([&] { read_scene_yaml(folder.write(text)); });
  EXPECT_NE(error.find(":15: item: there are more than 10000"), std::string::npos) << error;
}

TEST(SceneYaml, EmptyAndForeignFilesAreRefused) {
  const SceneFolder folder;
  for (const char* text : {"", "just words\n", "[1, 2]\n", "\x01\x02"}) {
    const auto file = folder.write(text);
    const std::string error = test::error_of([&] { read_scene_yaml(file); });
    EXPECT_EQ(error.rfind(file.string(), 0), 0U) << error;
  }
}

TEST(LabelList, HasTheCategoriesOfMatterport) {
  const auto labels = test::indoor_labels();
  ASSERT_EQ(labels.size(), 41U);
  EXPECT_EQ(labels.max_id(), 41);
  EXPECT_EQ(labels.name(1), "wall");
  EXPECT_EQ(labels.name(22), "tv_monitor");
  EXPECT_EQ(labels.name(41), "unlabeled");
  std::set<std::tuple<int, int, int>> colors;
  for (const auto& label : labels.labels()) colors.insert({label.color.r, label.color.g, label.color.b});
  EXPECT_EQ(colors.size(), 41U);
}

TEST(LabelList, MistakesNameTheFile) {
  const SceneFolder folder;
  for (const auto& [text, expected] : {std::pair{"labels:\n  - {id: 0, name: void}\n", "id must be"},
                                       {"labels:\n  - {id: 1, name: a}\n  - {id: 1, name: b}\n", "id 1 twice"},
                                       {"labels: []\n", "lists no labels"},
                                       {"labels:\n  - {id: 1, name: a, color: [300, 0, 0]}\n", "color must be"}}) {
    const auto file = folder.write(text);
    const std::string error = test::error_of([&] { mapping::read_label_list(file); });
    EXPECT_EQ(error.rfind(file.string(), 0), 0U) << error;
    EXPECT_NE(error.find(expected), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace lapis::simulator
