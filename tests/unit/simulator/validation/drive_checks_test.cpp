#include "simulator/core/validation/drive_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulator/core/robot/starts.hpp"
#include "small_scenes.hpp"

namespace lapis::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRadius_m = 0.2;

struct Place {
  Scene scene;
  NavMap map;
  explicit Place(const SceneSpec& spec) : scene(test::build(spec)), map(build_nav_map(scene)) {}
};

/// A hallway of this width, 5 m long, between a room in the south-west and one in the north-east.
SceneSpec with_hallway(double width_m) {
  SceneSpec spec = test::two_rooms();
  spec.rooms = {test::rectangular_room("south", {0, -3}, {3, -0.12}),
                test::rectangular_room("hallway", {0, 0}, {5, width_m}),
                test::rectangular_room("north", {2, width_m + 0.12}, {5, width_m + 3})};
  OpeningSpec south, north;
  south.at = {1, -0.06};
  north.at = {4, width_m + 0.06};
  spec.openings = {south, north};
  spec.starts = {{{1.5, -1.5}, 0.0}};
  spec.tour = {{3.5, width_m + 1.5}};
  return spec;
}

double number_before(const std::string& text, const std::string& unit) {
  const std::size_t end = text.find(unit), begin = text.rfind(' ', end - 1);
  return std::stod(text.substr(begin + 1, end - begin - 1));
}

TEST(DriveChecks, AGoodScenePassesAll) {
  const Place place(test::good_spec());
  for (const Check& check :
       {check_starts(place.scene, place.map, kRadius_m), check_rooms(place.scene, place.map, kRadius_m),
        check_tour(place.scene, place.map, {}), check_doors(place.scene, place.map)}) {
    EXPECT_EQ(check.verdict, Verdict::kOk) << test::text_of(check);
    EXPECT_FALSE(check.figures.empty()) << check.name;
  }
}

TEST(DriveChecks, AStartInOrNearAnObstacleFails) {
  SceneSpec spec = test::good_spec();
  spec.starts = {{{2.0, 1.5}, 0.0}, {{0.6, 0.05}, 0.0}, {{3.9, 0.5}, 0.0}};
  const Place place(spec);
  const Check check = check_starts(place.scene, place.map, kRadius_m);
  EXPECT_EQ(check.verdict, Verdict::kFail);
  ASSERT_EQ(check.details.size(), 2U) << test::text_of(check);
  EXPECT_THAT(check.details[0], HasSubstr("start 2"));
  EXPECT_THAT(check.details[1], HasSubstr("start 3"));
}

TEST(DriveChecks, WithoutStartsTheMostOpenPlaceStandsIn) {
  SceneSpec spec = test::two_rooms();
  spec.starts.clear();
  const Place place(spec);
  const auto starts = starts_of(place.scene, place.map, kRadius_m);
  ASSERT_EQ(starts.size(), 1U);
  EXPECT_NEAR(place.map.distance_m(starts[0].position), 1.5, 0.06) << "half the width of the living room";
}

TEST(DriveChecks, ARoomBehindABlockedDoorFailsByName) {
  SceneSpec spec = test::good_spec();
  test::add_item(spec, "barrier", "cabinet", {0.5, 1.2, 1.0}, {3.7, 1.5});
  const Place place(spec);
  const Check rooms = check_rooms(place.scene, place.map, kRadius_m);
  EXPECT_EQ(rooms.verdict, Verdict::kFail);
  ASSERT_EQ(rooms.details.size(), 1U) << test::text_of(rooms);
  EXPECT_THAT(rooms.details[0], HasSubstr("hallway cannot be reached from start 1"));
  const Check tour = check_tour(place.scene, place.map, {});
  EXPECT_EQ(tour.verdict, Verdict::kFail);
  EXPECT_THAT(tour.details.at(0), HasSubstr("waypoint 1"));
}

TEST(DriveChecks, LengthOfTheTourIsThatOfTheStraightLine) {
  const Place place(test::two_rooms());
  const Check check = check_tour(place.scene, place.map, {});
  EXPECT_NEAR(number_before(check.figures, " m,"), 2 * 3.1, 0.15) << check.figures;
}

TEST(DriveChecks, DoorsNarrowerThanEightyCentimetresFail) {
  for (const double width_m : {0.6, 0.7, 0.85, 1.0}) {
    SceneSpec spec = test::two_rooms();
    spec.openings[0].width_m = width_m;
    const Place place(spec);
    const Check check = check_doors(place.scene, place.map);
    EXPECT_EQ(check.verdict, width_m < 0.8 ? Verdict::kFail : Verdict::kOk) << test::text_of(check);
    const double measured_m = number_before(check.figures, " m (");
    EXPECT_LE(measured_m, width_m + 1e-6);
    EXPECT_GE(measured_m, width_m - 0.1) << "frame, and two cells";
  }
}

TEST(DriveChecks, WidthOfACorridorIsThatBetweenItsDoorways) {
  for (const double width_m : {0.7, 1.0, 1.4, 1.6}) {
    const Place place(with_hallway(width_m));
    const Check check = check_corridors(place.scene, place.map);
    const Verdict expected = width_m < 0.8 ? Verdict::kFail : width_m < 1.2 ? Verdict::kNote : Verdict::kOk;
    EXPECT_EQ(check.verdict, expected) << test::text_of(check);
    ASSERT_EQ(check.details.size(), 1U);
    EXPECT_NEAR(number_before(check.details[0], " m at"), width_m, 0.1) << "skirting boards, and two cells";
  }
}

TEST(DriveChecks, ACorridorWithOneDoorwayIsNotMeasuredAndSaysSo) {
  const Place place(test::good_spec());
  const Check check = check_corridors(place.scene, place.map);
  EXPECT_EQ(check.verdict, Verdict::kNote);
  EXPECT_THAT(check.details, ElementsAre(HasSubstr("hallway: not measured")));
}

TEST(DriveChecks, FurnitureNarrowsACorridorOnlyBetweenItsDoorways) {
  SceneSpec between = with_hallway(1.6), beyond = between;
  test::add_item(between, "cupboard", "cabinet", {0.5, 0.6, 1.0}, {2.5, 0.32});
  test::add_item(beyond, "cupboard", "cabinet", {0.3, 1.4, 1.0}, {4.8, 0.75});
  const Place narrow(between), wide(beyond);
  EXPECT_NEAR(number_before(check_corridors(narrow.scene, narrow.map).details.at(0), " m at"), 1.0, 0.1);
  EXPECT_NEAR(number_before(check_corridors(wide.scene, wide.map).details.at(0), " m at"), 1.6, 0.1);
}

TEST(DriveChecks, TheLoopAroundABlockHasTheLengthOfItsRoundedOutline) {
  SceneSpec spec = test::two_rooms();
  spec.rooms[0].polygon = {{-3, -3}, {4, -3}, {4, 4}, {-3, 4}};
  test::add_item(spec, "block", "cabinet", {2.5, 2.5, 1.0}, {0.5, 0.5});
  spec.starts = {{{2.5, 1.5}, 0.0}};
  const Place place(spec);
  const Check check = list_loops(place.scene, place.map, kRadius_m);
  ASSERT_EQ(check.details.size(), 1U) << test::text_of(check);
  const double expected_m = 4 * 2.5 + 2 * 3.14159 * kRadius_m;
  EXPECT_NEAR(number_before(check.details[0], " m around"), expected_m, 0.08 * expected_m);
  EXPECT_THAT(check.details[0], HasSubstr(": living"));
}

}  // namespace
}  // namespace lapis::simulator
