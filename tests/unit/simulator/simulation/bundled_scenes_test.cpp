#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "simulator/core/validation/drive_checks.hpp"
#include "simulator/furniture.hpp"
#include "simulator/scene_yaml.hpp"

namespace lapis::simulator {
namespace {

constexpr double kRadius_m = 0.2, kRate_hz = 15.0;
constexpr std::uint64_t kSeeds = 20;

std::filesystem::path scene_file(const std::string& name) {
  return std::filesystem::path(LAPIS_SOURCE_DIR) / "config/scenes" / (name + ".yaml");
}

/// Models are read once for all scenes.
const FurnitureSource& furniture() {
  static const FurnitureSource source =
      furniture_from(std::make_shared<const FurnitureCatalog>("/usr/share/sweethome3d/furniture"));
  return source;
}

/// A bundled scene with bare walls and floors: textures take time, and nobody looks at them.
SceneSpec bare(const std::string& name) {
  SceneSpec spec = read_scene_yaml(scene_file(name));
  for (RoomSpec& room : spec.rooms) {
    for (SurfaceSpec* surface : {&room.floor, &room.wall, &room.ceiling}) surface->texture = "blank";
  }
  return spec;
}

Scene furnished(const SceneSpec& spec, std::uint64_t seed) {
  BuildOptions options;
  options.seed = seed;
  options.pictures_density = 0.0;
  return build_scene(spec, furniture(), options);
}

std::string text_of(const Check& check) {
  std::string text = check.name + ": " + check.figures;
  for (const auto& line : check.details) text += "\n  " + line;
  return text;
}

struct Drive {
  std::string problem;  ///< why the tour was given up
  double length_m = 0.0, duration_s = 0.0;
  int contacts = 0;
};

/// The bundled tour, commands taking effect a frame later, as in lock-step.
Drive drive(const Scene& scene, const NavMap& map, const StartPose& from) {
  RobotState start;
  start.position = from.position;
  start.yaw_rad = from.yaw_rad;
  TourFollower follower(map, plan_tour(map, from.position, scene.tour, {}), {});
  Robot robot(map, RobotConfig{}, start);
  Drive out;
  DriveCommand late;
  bool was_in_contact = false;
  for (int tick = 1; !follower.is_finished() && out.problem.empty(); ++tick) {
    const DriveCommand command = follower.command(robot.state());
    out.problem = follower.stalled();
    EXPECT_TRUE(robot.command(late));
    late = command;
    const Motion motion = robot.advance(time::Time::from_seconds(tick / kRate_hz));
    out.contacts += motion.is_in_contact && !was_in_contact ? 1 : 0;
    was_in_contact = motion.is_in_contact;
    out.length_m += std::abs(motion.distance_m);
    out.duration_s = robot.state().stamp.seconds();
  }
  return out;
}

class BundledScenes : public testing::TestWithParam<const char*> {};

TEST_P(BundledScenes, EverySeedLeavesThePathFree) {
  const SceneSpec spec = bare(GetParam());
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Scene scene = furnished(spec, seed);
    const NavMap map = build_nav_map(scene);
    const Check starts = check_starts(scene, map, kRadius_m);
    ASSERT_EQ(starts.verdict, Verdict::kOk) << text_of(starts);
    scene.starts = {scene.starts[seed % scene.starts.size()]};
    const Check rooms = check_rooms(scene, map, kRadius_m), doors = check_doors(scene, map);
    EXPECT_EQ(rooms.verdict, Verdict::kOk) << text_of(rooms);
    EXPECT_EQ(doors.verdict, Verdict::kOk) << text_of(doors);
    const Check corridors = check_corridors(scene, map);
    EXPECT_NE(corridors.verdict, Verdict::kFail) << text_of(corridors);
    if (scene.name == "large_building") {
      EXPECT_EQ(corridors.verdict, Verdict::kOk) << text_of(corridors);
    }
    if (HasFailure()) return;
    const Drive tour = drive(scene, map, scene.starts.front());
    EXPECT_EQ(tour.problem, "");
    EXPECT_EQ(tour.contacts, 0);
    RecordProperty("seed_" + std::to_string(seed),
                   std::to_string(tour.length_m) + " m, " + std::to_string(tour.duration_s) + " s");
  }
}

INSTANTIATE_TEST_SUITE_P(All, BundledScenes, testing::Values("apartment", "large_building", "blank_corridor"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace lapis::simulator
