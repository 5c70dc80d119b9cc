#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>

#include "common/mapping/file/label_list_file.hpp"
#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/generator/generate_building.hpp"
#include "simulator/core/generator/layout.hpp"
#include "simulator/core/generator/round_trip.hpp"
#include "simulator/core/scene/polygon.hpp"
#include "simulator/core/validation/content_checks.hpp"
#include "simulator/core/validation/drive_checks.hpp"
#include "simulator/scene_yaml.hpp"
#include "simulator/scene_yaml_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::simulator {
namespace {

constexpr double kRadius_m = 0.2;
constexpr std::uint64_t kUsualSeeds = 3;

const mapping::LabelList& labels() {
  static const mapping::LabelList list =
      mapping::read_label_list(std::filesystem::path(LAPIS_SOURCE_DIR) / "config/labels/mpcat40.yaml");
  return list;
}

/// How many seeds of each kind are tried: LAPIS_GENERATED_SEEDS, for more, or with sanitizers fewer, than usual.
std::uint64_t seeds() {
  const char* text = std::getenv("LAPIS_GENERATED_SEEDS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : kUsualSeeds;
}

std::string text_of(const Check& check) {
  std::string text = check.name + ": " + check.figures;
  for (const auto& line : check.details) text += "\n  " + line;
  return text;
}

/// With simple shapes in place of the catalogue's models, and without textures, which take time.
Scene built(SceneSpec spec) {
  for (RoomSpec& room : spec.rooms) {
    for (SurfaceSpec* surface : {&room.floor, &room.wall, &room.ceiling}) surface->texture = "blank";
  }
  BuildOptions options;
  options.pictures_density = 0.0;
  return build_scene(spec, {}, options);
}

class GeneratedBuildings : public testing::TestWithParam<std::string> {
 protected:
  static BuildingName name(std::uint64_t seed) {
    return parse_building_name(GetParam() + '_' + std::to_string(seed)).value();
  }
};

TEST_P(GeneratedBuildings, PassTheValidator) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE(to_string(name(seed)));
    const Scene scene = built(generate_building(name(seed), labels()));
    const NavMap map = build_nav_map(scene);
    const Inventory inventory = take_inventory(scene);
    TourConfig tour;
    tour.path.radius_m = kRadius_m;
    EXPECT_GE(scene.starts.size(), 3U);
    for (const Check& check : {check_starts(scene, map, kRadius_m), check_rooms(scene, map, kRadius_m),
                               check_tour(scene, map, tour), check_doors(scene, map), check_floating(scene, inventory),
                               check_overlaps(scene, inventory), check_walls(scene, inventory)}) {
      EXPECT_EQ(check.verdict, Verdict::kOk) << text_of(check);
    }
    const Check corridors = check_corridors(scene, map);
    EXPECT_NE(corridors.verdict, Verdict::kFail) << text_of(corridors);
  }
}

TEST_P(GeneratedBuildings, AreAsLargeAsTheirKind) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const double area_m2 = floor_area_m2(lay_out(name(seed)));
    EXPECT_GE(area_m2, 60.0) << seed;
    EXPECT_LE(area_m2, GetParam() == "flat" ? 130.0 : 900.0) << seed;
  }
}

TEST_P(GeneratedBuildings, RoomsLeaveTheWallsBetweenThem) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    const BuildingPlan plan = lay_out(name(seed));
    std::vector<Polygon> floors;
    for (const PlannedRoom& room : plan.rooms) {
      Polygon& floor = floors.emplace_back();
      for (const auto& corner : room.polygon) floor.push_back(room.frame.at(corner));
      EXPECT_TRUE(is_simple(floor)) << room.id;
    }
    for (std::size_t a = 0; a < floors.size(); ++a) {
      for (std::size_t b = 0; b < floors.size(); ++b) {
        if (a == b) continue;
        for (const auto& corner : floors[a]) {
          EXPECT_FALSE(contains(floors[b], corner)) << plan.rooms[a].id << " in " << plan.rooms[b].id;
          EXPECT_GE(distance_to_border(floors[b], corner), plan.wall_m - 0.011)
              << plan.rooms[a].id << ' ' << plan.rooms[b].id;
        }
      }
    }
  }
}

/// Bytes of two runs are equal, and the file says all that the building is.
TEST_P(GeneratedBuildings, AreTheirSceneFile) {
  const test::TemporaryFolder folder;
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    const std::string text = to_scene_yaml(generate_building(name(seed), labels()));
    EXPECT_EQ(text, to_scene_yaml(generate_building(name(seed), labels())));
    const auto file = folder.path() / "scene.yaml";
    std::ofstream(file) << text;
    const SceneSpec read =
        read_scene_yaml(file, std::filesystem::path(LAPIS_SOURCE_DIR) / "config/labels/mpcat40.yaml");
    EXPECT_EQ(to_scene_yaml(read), text);
    const Scene a = built(read), b = built(generate_building(name(seed), labels()));
    ASSERT_EQ(a.mesh.positions.size(), b.mesh.positions.size());
    float most = 0.0F;
    for (std::size_t i = 0; i < a.mesh.positions.size(); ++i)
      most = std::max(most, (a.mesh.positions[i] - b.mesh.positions[i]).cwiseAbs().maxCoeff());
    EXPECT_LE(most, 1e-5F);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GeneratedBuildings, testing::ValuesIn(building_kinds()),
                         [](const auto& kind) { return kind.param; });

/// Distances of every item's front and middle from the room's corners: equal for copies, however they lie.
std::vector<double> shape_of(const SceneSpec& spec, const std::string& room) {
  std::vector<double> out;
  const auto it = std::find_if(spec.rooms.begin(), spec.rooms.end(), [&](const RoomSpec& r) { return r.id == room; });
  for (const FurnitureSpec& item : spec.furniture) {
    const auto* at = std::get_if<AtPoint>(&item.place);
    if (at == nullptr || item.id.rfind(room + '.', 0) != 0) continue;
    const Eigen::Vector2d front = at->at + 0.1 * Eigen::Vector2d(std::sin(at->yaw_rad), -std::cos(at->yaw_rad));
    for (const auto& corner : it->polygon) {
      out.push_back((at->at - corner).norm());
      out.push_back((front - corner).norm());
    }
  }
  return out;
}

TEST(GeneratedCopies, AreAlikeInAllButTheirPlace) {
  int copies = 0, mirrored = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const BuildingName name{BuildingKind::kClinic, seed};
    const BuildingPlan plan = lay_out(name);
    const SceneSpec spec = generate_building(name, labels());
    for (const PlannedRoom& room : plan.rooms) {
      if (!room.copy_of) continue;
      const PlannedRoom& original = plan.rooms[*room.copy_of];
      SCOPED_TRACE(room.id + " of " + to_string(name));
      ++copies;
      mirrored += room.frame.is_mirrored() != original.frame.is_mirrored() ? 1 : 0;
      EXPECT_THAT(shape_of(spec, room.id), testing::Pointwise(testing::DoubleNear(0.011), shape_of(spec, original.id)));
      std::vector<std::uint64_t> motifs, of_original;
      for (const PictureSpec& picture : spec.pictures) {
        if (picture.room == room.id) motifs.push_back(*picture.motif);
        if (picture.room == original.id) of_original.push_back(*picture.motif);
      }
      EXPECT_EQ(motifs, of_original);
    }
  }
  EXPECT_GE(copies, 50);
  EXPECT_GE(mirrored, 15);
}

/// Boxes of what stands in a room, in the room's frame, by the item's number.
std::map<std::string, Eigen::AlignedBox3f> boxes_in(const Scene& scene, const PlannedRoom& room) {
  std::map<std::string, Eigen::AlignedBox3f> boxes;
  for (const Triangle& triangle : scene.mesh.triangles) {
    const std::string& name = scene.instances[triangle.part].name;
    if (name.rfind(room.id + '.', 0) != 0) continue;
    for (const std::uint32_t vertex : triangle.vertices) {
      const Eigen::Vector3f p = scene.mesh.positions[vertex];
      const Eigen::Vector2d local = room.frame.local(p.head<2>().cast<double>());
      boxes[name.substr(room.id.size())].extend(
          Eigen::Vector3f(static_cast<float>(local.x()), static_cast<float>(local.y()), p.z()));
    }
  }
  return boxes;
}

Scene jittered(const SceneSpec& spec, std::uint64_t seed) {
  BuildOptions options;
  options.seed = seed;
  return build_scene(spec, {}, options);
}

TEST(GeneratedCopies, StayAlikeWhenTheSeedMovesWhatIsMovable) {
  const BuildingName name{BuildingKind::kOffice, 2};
  const BuildingPlan plan = lay_out(name);
  const SceneSpec spec = generate_building(name, labels());
  const Scene scene = jittered(spec, 5), other = jittered(spec, 6);
  EXPECT_NE(scene.mesh.positions, other.mesh.positions) << "nothing is movable, so this shows nothing";
  int copies = 0;
  for (const PlannedRoom& room : plan.rooms) {
    if (!room.copy_of) continue;
    ++copies;
    SCOPED_TRACE(room.id);
    const auto boxes = boxes_in(scene, room), originals = boxes_in(scene, plan.rooms[*room.copy_of]);
    ASSERT_GE(originals.size(), 3U);
    ASSERT_EQ(boxes.size(), originals.size());
    for (const auto& [item, box] : boxes) {
      EXPECT_TRUE(box.min().isApprox(originals.at(item).min(), 1e-2F) &&
                  (box.max() - originals.at(item).max()).norm() < 0.02F)
          << item;
    }
  }
  EXPECT_GE(copies, 4);
}

/// The texture of an instance's first triangle.
const TextureImage* texture_of(const Scene& scene, const std::string& instance) {
  for (const Triangle& triangle : scene.mesh.triangles) {
    if (scene.instances[triangle.part].name != instance) continue;
    const int texture = scene.mesh.materials[triangle.material].texture;
    return texture < 0 ? nullptr : scene.mesh.textures[static_cast<std::size_t>(texture)].get();
  }
  return nullptr;
}

TEST(GeneratedCopies, HaveTheFloorsAndWallsOfTheirOriginal) {
  const BuildingName name{BuildingKind::kOffice, 2};
  const BuildingPlan plan = lay_out(name);
  const Scene scene = jittered(generate_building(name, labels()), 1);
  for (const PlannedRoom& room : plan.rooms) {
    if (!room.copy_of) continue;
    const PlannedRoom& original = plan.rooms[*room.copy_of];
    for (const char* part : {"/floor", "/ceiling", "/wall 0"}) {
      const TextureImage* texture = texture_of(scene, original.id + part);
      ASSERT_NE(texture, nullptr);
      EXPECT_EQ(texture_of(scene, room.id + part), texture) << room.id << part;
    }
  }
}

TEST(GeneratedPanes, StandFreeOnlyWhenAskedFor) {
  for (const std::string& kind : building_kinds()) {
    BuildingName name = parse_building_name(kind + "_1").value();
    EXPECT_EQ(list_panes(built(generate_building(name, labels()))).verdict, Verdict::kOk) << kind;
    name.has_panes = true;
    const Scene scene = built(generate_building(name, labels()));
    const Check panes = list_panes(scene);
    EXPECT_EQ(panes.verdict, Verdict::kNote) << kind;
    EXPECT_GE(panes.details.size(), 3U) << kind;
    const NavMap map = build_nav_map(scene);
    const Check rooms = check_rooms(scene, map, kRadius_m), doors = check_doors(scene, map);
    EXPECT_EQ(rooms.verdict, Verdict::kOk) << text_of(rooms);
    EXPECT_EQ(doors.verdict, Verdict::kOk) << text_of(doors);
  }
}

TEST(RoundTrips, RefuseARoomThatTheRobotDoesNotGetInto) {
  SceneSpec spec = generate_building({BuildingKind::kFlat, 1}, labels());
  const Random random(1, RandomStream::kBuilding);
  EXPECT_NO_THROW(plan_round_trip(spec, random));
  const RoomSpec& bath =
      *std::find_if(spec.rooms.begin(), spec.rooms.end(), [](const RoomSpec& room) { return room.id == "bath_1"; });
  Eigen::AlignedBox2d box;
  for (const auto& corner : bath.polygon) box.extend(corner);
  FurnitureSpec block;
  block.place = AtPoint{box.center(), 0.0};
  block.size_m = Eigen::Vector3d(box.sizes().x(), box.sizes().y(), 1.0);
  spec.furniture.push_back(block);
  EXPECT_THAT([&] { plan_round_trip(spec, random); }, testing::ThrowsMessage<std::runtime_error>(testing::AllOf(
                                                          testing::HasSubstr("flat_1"), testing::HasSubstr("bath_1"))));
}

TEST(BuildingNames, AreKindAndSeed) {
  const auto name = parse_building_name("clinic_12");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->kind, BuildingKind::kClinic);
  EXPECT_EQ(name->seed, 12U);
  EXPECT_FALSE(name->has_panes);
  const auto with_panes = parse_building_name("flat_7_panes");
  ASSERT_TRUE(with_panes);
  EXPECT_TRUE(with_panes->has_panes);
  EXPECT_EQ(to_string(*with_panes), "flat_7_panes");
  for (const char* text : {"clinic", "clinic_", "clinic_-1", "clinic_1x", "clinic_01", "castle_1", "_1", "", "flat_7_",
                           "flat_7_pane", "flat_07_panes", "clinic_99999999999999999999"}) {
    EXPECT_FALSE(parse_building_name(text)) << text;
  }
}

}  // namespace
}  // namespace lapis::simulator
