#include "simulator/core/generator/room_space.hpp"

#include <gtest/gtest.h>

namespace lapis::simulator {
namespace {

/// 6 m x 4 m, with a door in the middle of the southern wall and a window with a sill at 0.9 m in the northern one.
const Polygon kRoom{{0, 0}, {6, 0}, {6, 4}, {0, 4}};
const std::vector<LocalOpening> kOpenings{{OpeningKind::kDoor, 0, 3.0, 0.9, 0.0},
                                          {OpeningKind::kWindow, 2, 3.0, 1.2, 0.9}};

ItemBox box(double x0, double y0, double x1, double y1, double height_m = 1.0) {
  return {{Eigen::Vector2d(x0, y0), Eigen::Vector2d(x1, y1)}, 0.0, height_m};
}

TEST(RoomSpace, RefusesWhatFencesOffAPartOfTheRoom) {
  RoomSpace space(kRoom, kOpenings);
  EXPECT_FALSE(space.add(box(4.0, 0.0, 4.3, 3.5))) << "0.5 m are no lane";
  EXPECT_TRUE(space.add(box(4.0, 0.0, 4.3, 3.0))) << "1 m is one";
  EXPECT_FALSE(space.add(box(4.35, 2.9, 6.0, 3.2))) << "a second item that closes what the first one left";
}

TEST(RoomSpace, ANookThatIsTooSmallForTheRobotIsNoPartOfTheRoom) {
  RoomSpace space(kRoom, kOpenings);
  EXPECT_TRUE(space.add(box(0.6, 3.2, 1.4, 4.0)));
}

TEST(RoomSpace, KeepsDoorsAndWindowsFree) {
  RoomSpace space(kRoom, kOpenings);
  EXPECT_FALSE(space.add(box(2.8, 0.3, 3.2, 0.7)));
  EXPECT_FALSE(space.add(box(2.5, 3.6, 3.5, 4.0, 1.8))) << "hides the window";
  EXPECT_TRUE(space.add(box(2.5, 3.6, 3.5, 4.0, 0.8))) << "stands below its sill";
}

TEST(RoomSpace, ItemsNeitherMeetNorLeaveTheRoom) {
  RoomSpace space(kRoom, kOpenings);
  EXPECT_FALSE(space.add(box(5.5, 1.0, 6.1, 1.5)));
  EXPECT_TRUE(space.add(box(5.0, 1.0, 5.5, 1.5)));
  EXPECT_FALSE(space.add(box(5.4, 1.2, 5.9, 1.8)));
  EXPECT_TRUE(space.add(box(4.0, 0.8, 6.0, 2.0, 0.01))) << "a rug lies under things";
}

}  // namespace
}  // namespace lapis::simulator
