#include "simulator/core/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/simulator/render/box_scene.hpp"

namespace lapis::simulator {
namespace {

using ::testing::HasSubstr;

/// A room of 4 m x 3 m with a closed cell of 1 m x 1 m in its corner at the origin.
Scene room_with_a_cell() {
  Scene scene = test::box_scene();
  scene.instances.push_back({7, 7, "cell"});
  test::add_quad(scene, {{{1, 0, 0}, {1, 1, 0}, {1, 1, 2}, {1, 0, 2}}}, 0, 6);
  test::add_quad(scene, {{{0, 1, 0}, {1, 1, 0}, {1, 1, 2}, {0, 1, 2}}}, 0, 6);
  return scene;
}

SimulationConfig config_of(std::uint64_t seed) {
  SimulationConfig config;
  config.seed = seed;
  config.camera = {64, 36, 32.0, 32.0, 31.5, 17.5};
  config.mount = {1.0, 0.0};
  config.sensors.has_imu = true;
  return config;
}

class SimulationTest : public ::testing::Test {
 protected:
  World world_{room_with_a_cell(), {}};
  StartPose start_{{2.0, 1.5}, 0.0};
};

TEST_F(SimulationTest, StampsAreWholeNanosecondsOfTheRateAndSensorsHaveTheirOwn) {
  Simulation simulation(world_, config_of(1), start_);
  std::vector<std::int64_t> odometry, imu;
  for (std::int64_t tick = 1; tick <= 30; ++tick) {
    const auto frame = simulation.next(std::nullopt);
    EXPECT_EQ(frame.stamp.nanoseconds, std::llround(static_cast<double>(tick) * 1e9 / 15.0));
    for (const auto& sample : frame.odometry) odometry.push_back(sample.stamp.nanoseconds);
    for (const auto& sample : frame.imu) imu.push_back(sample.stamp.nanoseconds);
  }
  ASSERT_EQ(odometry.size(), 100U);  // 2 s at 50 Hz
  ASSERT_EQ(imu.size(), 400U);
  for (std::size_t i = 0; i < odometry.size(); ++i)
    EXPECT_EQ(odometry[i], 20'000'000 * static_cast<std::int64_t>(i + 1));
  for (std::size_t i = 0; i < imu.size(); ++i) EXPECT_EQ(imu[i], 5'000'000 * static_cast<std::int64_t>(i + 1));
}

TEST_F(SimulationTest, DrivesMakeTheErrorsOfTheirRunOfACommand) {
  struct Driven {
    double path_m, turn_rad;
  };
  const RobotConfig robot;
  const auto driven = [&](std::uint64_t seed, const DriveErrorConfig& drive) {
    SimulationConfig config = config_of(seed);
    config.drive = drive;
    Simulation ahead(world_, config, start_), around(world_, config, start_);
    Driven result{};
    for (int tick = 0; tick < 30; ++tick) {  // at the limits, which commands of more do not move
      result.path_m = ahead.next(DriveCommand{2.0 * robot.max_speed_m_s, 0.0}).robot.position.x() - start_.position.x();
      result.turn_rad = around.next(DriveCommand{0.0, 2.0 * robot.max_turn_rate_rad_s}).robot.yaw_rad;
    }
    return result;
  };
  const Driven exact = driven(1, {});
  int faster = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    EXPECT_EQ(driven(seed, {}).path_m, exact.path_m);
    const Driven off = driven(seed, {.speed_error = 0.05}), turned = driven(seed, {.turn_error = 0.1});
    EXPECT_GT(std::abs(off.path_m / exact.path_m - 1.0), 1e-6);
    EXPECT_LE(std::abs(off.path_m / exact.path_m - 1.0), 0.05);
    EXPECT_EQ(off.turn_rad, exact.turn_rad);
    EXPECT_GT(std::abs(turned.turn_rad / exact.turn_rad - 1.0), 1e-6);
    EXPECT_LE(std::abs(turned.turn_rad / exact.turn_rad - 1.0), 0.1);
    EXPECT_EQ(turned.path_m, exact.path_m);
    const double noisy = driven(seed, {.noise = 0.1}).turn_rad / exact.turn_rad - 1.0;
    EXPECT_GT(std::abs(noisy), 1e-6);
    EXPECT_LE(std::abs(noisy), 4.0 * 0.1 / std::sqrt(30.0));
    faster += off.path_m > exact.path_m ? 1 : 0;
  }
  EXPECT_GE(faster, 2);
  EXPECT_LE(faster, 10);
}

TEST_F(SimulationTest, TheSameCommandsAndSeedGiveTheSameBytes) {
  const auto run = [&](std::uint64_t seed) {
    Simulation simulation(world_, config_of(seed), start_);
    SensorFrame frame;
    for (int i = 0; i < 12; ++i) frame = simulation.next(DriveCommand{0.3, 0.4});
    return frame;
  };
  const auto a = run(4), b = run(4), c = run(5);
  EXPECT_EQ(a.images.color.pixels, b.images.color.pixels);
  EXPECT_EQ(a.images.depth_mm.pixels, b.images.depth_mm.pixels);
  EXPECT_EQ(a.images.labels.pixels, b.images.labels.pixels);
  EXPECT_EQ(a.odometry.back().position, b.odometry.back().position);
  EXPECT_EQ(a.robot.position, c.robot.position) << "commands act the same whatever the noise";
  EXPECT_NE(a.images.color.pixels, c.images.color.pixels);
  EXPECT_NE(a.images.depth_mm.pixels, c.images.depth_mm.pixels);
}

/// Frames end within IMU periods (66.7 ms, 5 ms), and yet every reading covers its whole period.
TEST_F(SimulationTest, ReadingsOfTheImuAddUpToTheMotion) {
  SimulationConfig config = config_of(1);
  config.sensors.imu = {0.0, 0.0, 0.0, 0.0};
  Simulation simulation(world_, config, start_);
  SensorFrame frame;
  double turn_rad = 0.0;
  Eigen::Vector2d push_m_s(0, 0);          // in the direction of the start
  for (int tick = 1; tick <= 6; ++tick) {  // 0.4 s: both drives still speed up
    frame = simulation.next(DriveCommand{0.5, 0.7});
    for (const auto& sample : frame.imu) {
      const double middle_rad = turn_rad + 0.5 * sample.turn_rate_rad_s.z() * 0.005;
      turn_rad += sample.turn_rate_rad_s.z() * 0.005;
      push_m_s += Eigen::Rotation2Dd(middle_rad) * sample.acceleration_m_s2.head<2>() * 0.005;
    }
  }
  EXPECT_NEAR(turn_rad, frame.robot.yaw_rad, 1e-12);
  EXPECT_NEAR(push_m_s.norm(), frame.robot.drive.speed_m_s, 1e-5);
  EXPECT_GT(frame.robot.drive.speed_m_s, 0.3);
}

TEST_F(SimulationTest, TheCameraSitsOnTheRobotsMount) {
  SimulationConfig config = config_of(1);
  config.sensors.depth.model = DepthModel::kNone;
  Simulation simulation(world_, config, start_);
  const auto frame = simulation.next(std::nullopt);  // looks along +x from (2, 1.5) to the wall at x = 4
  EXPECT_NEAR(frame.ideal_depth(32, 18), 2.0, 1e-4);
  EXPECT_EQ(frame.images.depth_mm(32, 18), 2000);
  EXPECT_EQ(frame.ideal_labels(32, 18), 2);
  const double floor_ahead = 1.0 / ((35 - 17.5) / 32.0);  // z-depth where the lowest row meets the floor, 1 m below
  EXPECT_NEAR(frame.ideal_depth(32, 35), floor_ahead, 1e-3);
}

TEST_F(SimulationTest, CommandsThatAreNotFiniteAreCountedAndStopTheRobot) {
  Simulation simulation(world_, config_of(1), start_);
  for (int i = 0; i < 10; ++i) simulation.next(DriveCommand{0.3, 0.0});
  SensorFrame frame;
  for (int i = 0; i < 30; ++i) frame = simulation.next(DriveCommand{std::numeric_limits<double>::quiet_NaN(), 0.0});
  EXPECT_EQ(simulation.commands_refused(), 30U);
  EXPECT_NEAR(frame.robot.velocity.norm(), 0.0, 1e-3);
  EXPECT_TRUE(frame.robot.position.allFinite());
}

TEST(Start, IsDrawnInTheLargestAreaWithRoomAround) {
  const World world(room_with_a_cell(), {});
  bool are_all_equal = true;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto start = draw_start(world, 0.2, seed);
    EXPECT_GE(world.nav_map().distance_m(start.position), 0.3);
    EXPECT_FALSE(start.position.x() < 1.0 && start.position.y() < 1.0) << "the cell has no door";
    are_all_equal &= start.position == draw_start(world, 0.2, 0).position;
  }
  EXPECT_FALSE(are_all_equal);
}

TEST(Start, InAWallIsAnError) {
  Scene scene = room_with_a_cell();
  scene.starts = {{{1.02, 0.5}, 0.0}};
  const World world(std::move(scene), {});
  try {
    draw_start(world, 0.2, 1);
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("scene box: start (1.02, 0.50) is in a wall"));
  }
}

TEST(WorldErrors, NameTheScene) {
  const auto error_of = [](Scene scene) -> std::string {
    try {
      const World world(std::move(scene), {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  };
  Scene empty = test::box_scene();
  empty.mesh.triangles.clear();
  EXPECT_EQ(error_of(empty), "scene box: holds no triangles");
  Scene broken = test::box_scene();
  broken.mesh.positions[3].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(broken), "scene box: vertex 3 is not finite");
  Scene rich = test::box_scene();
  rich.mesh.textures.resize(kMostTextures + 1);
  EXPECT_EQ(error_of(rich), "scene box: more than 32767 textures");
  Scene orphan = test::box_scene();
  orphan.mesh.triangles[5].part = 99;
  EXPECT_EQ(error_of(orphan), "scene box: a triangle belongs to no instance");
}

}  // namespace
}  // namespace lapis::simulator
