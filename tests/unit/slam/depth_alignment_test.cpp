#include "slam/core/calibration/depth_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "slam/core/calibration/delay_watch.hpp"
#include "slam/depth_calibrator.hpp"
#include "tests/support/boards.hpp"

namespace lapis::slam {
namespace {

const geometry::PinholeCamera kView{320, 240, 260.0, 260.0, 159.5, 119.5};
const images::RgbdCalibration kRegistered{{kView, {}}, {kView, {}}};

/// Depth is of a camera at `shift_m` whose focal length is that of colour over `focal_ratio`.
RgbdFrame see(const std::vector<lapis::test::Board>& boards, const DepthOffset& offset) {
  geometry::PinholeCamera depth_camera = kView;
  depth_camera.fx /= offset.focal_ratio;
  depth_camera.fy /= offset.focal_ratio;
  return {{},
          kView,
          lapis::test::gray_of(boards, kView),
          lapis::test::depth_of(boards, depth_camera, {offset.shift_m.x(), offset.shift_m.y(), 0.0})};
}

DepthAlignment align(const DepthOffset& truth) {
  std::vector<EdgeView> views;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) views.emplace_back(see(lapis::test::make_boards(seed), truth));
  return align_depth(views);
}

TEST(DepthAlignment, FindsFocalLengthAndShift) {
  for (const DepthOffset& truth : {DepthOffset{1.0 / 1.11, {-0.025, 0.0}}, DepthOffset{1.15, {0.05, 0.005}},
                                   DepthOffset{0.97, {0.0, 0.0}}, DepthOffset{1.0, {-0.055, 0.0}}}) {
    const DepthAlignment found = align(truth);
    EXPECT_NEAR(found.offset.focal_ratio, truth.focal_ratio, 0.004);
    EXPECT_NEAR(found.offset.shift_m.x(), truth.shift_m.x(), 0.003);
    EXPECT_NEAR(found.offset.shift_m.y(), truth.shift_m.y(), 0.003);
    EXPECT_GT(found.gain_sigmas, 4.0);
    EXPECT_GT(found.moved_px, 2.0);
  }
}

TEST(DepthAlignment, LeavesRegisteredDepthWhereItIs) {
  const DepthAlignment found = align({});
  EXPECT_LT(found.moved_px, 0.5);
  EXPECT_LT(found.gain_sigmas, 4.0);
}

TEST(DepthAlignment, FindsEdgesBehindGapsWithoutDepth) {
  RgbdFrame frame = see(lapis::test::make_boards(1), {});
  const auto before = static_cast<double>(EdgeView(frame).edges().size());
  const geometry::DepthImage whole = frame.depth;
  for (int v = 0; v < kView.height; ++v) {
    for (int u = 1; u < kView.width; ++u) {
      if (whole(u, v) - whole(u - 1, v) > 0.1F) frame.depth(u, v) = 0.0F;
    }
  }
  EXPECT_NEAR(static_cast<double>(EdgeView(frame).edges().size()), before, 0.05 * before);
}

TEST(DepthAlignment, ABareWallHasNoEdges) { EXPECT_TRUE(EdgeView(see({}, {})).edges().empty()); }

/// Views of a camera that moves as fast, but in another direction each time; depth is of `delay_s` later, and of a
/// camera beside it.
std::vector<EdgeView> late_views(double delay_s, const Eigen::Vector2d& beside_m) {
  constexpr double kSpeed_m_s = 1.2;
  std::vector<EdgeView> views;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d v = kSpeed_m_s * Eigen::Vector2d(std::cos(2.4 * i), std::sin(2.4 * i));
    views.emplace_back(see(lapis::test::make_boards(static_cast<std::uint32_t>(1 + i)), {1.0, delay_s * v + beside_m}));
    views.back().set_velocity((geometry::Vector6d() << v, 0.0, 0.0, 0.0, 0.0).finished());
  }
  return views;
}

TEST(DepthAlignment, FindsHowLateDepthIsAndWhereItsCameraIs) {
  for (const double delay_s : {0.033, -0.02, 0.05}) {
    for (const Eigen::Vector2d& beside_m : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(-0.03, 0.0)}) {
      const auto [found, better_sigmas] = align_late_depth(late_views(delay_s, beside_m), 0.1);
      EXPECT_NEAR(found.offset.delay_s, delay_s, 0.003);
      EXPECT_LT((found.offset.shift_m - beside_m).norm(), 0.005);
      EXPECT_GT(found.gain_sigmas, 4.0);
      EXPECT_GT(better_sigmas, 2.6);
    }
  }
}

TEST(DepthAlignment, FindsTheDelayBehindAShiftThatHidesIt) {
  const Eigen::Vector2d beside_m(0.02, -0.01);  // depth seems to be there, and is not
  const DepthOffset stated{1.0, beside_m};
  const auto [found, better_sigmas] = align_late_depth(late_views(0.033, beside_m), 0.1, stated);
  EXPECT_NEAR(found.offset.delay_s, 0.033, 0.003);
  EXPECT_LT((found.offset.shift_m - beside_m).norm(), 0.005);
  EXPECT_GT(found.gain_sigmas, 4.0);
  EXPECT_GT(better_sigmas, 2.6);
}

TEST(DepthAlignment, FindsNoDelayWhereThereIsNone) {
  EXPECT_LT(align_late_depth(late_views(0.0, {0.0, 0.0}), 0.1).alignment.gain_sigmas, 4.0);
  EXPECT_LT(std::abs(align_late_depth(late_views(0.0, {-0.03, 0.0}), 0.1).alignment.offset.delay_s), 0.003);
}

/// Plays 3 s of a camera that moves to and fro before ever other boards. Depth is of `delay_s` later, and of a camera
/// beside it.
std::optional<DepthOffset> watch(double delay_s, double beside_m, const DepthOffset& stated = {}) {
  const auto position_m = [](double t) {
    return Eigen::Vector3d(0.3 * std::sin(6.0 * t), 0.3 * std::cos(6.0 * t), 0.0);  // a circle
  };
  DelayWatch watch(stated);
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    const Eigen::Vector3d moved = position_m(t + delay_s) - position_m(t);
    RgbdFrame frame =
        see(lapis::test::make_boards(static_cast<std::uint32_t>(1 + i % 20)), {1.0, {moved.x() + beside_m, moved.y()}});
    frame.stamp = time::Time::from_seconds(t);
    if (const auto found = watch.add(frame, geometry::Pose(Eigen::Translation3d(position_m(t))))) return found;
  }
  EXPECT_TRUE(watch.is_over());
  return std::nullopt;
}

TEST(DelayWatch, FindsHowLateDepthIs) {
  for (const double delay_s : {0.033, -0.033}) {
    const auto found = watch(delay_s, 0.0);
    ASSERT_TRUE(found) << delay_s;
    EXPECT_NEAR(found->delay_s, delay_s, 0.005);
  }
}

TEST(DelayWatch, ReturnsTheStatedOffsetWhereADelayIsAll) {
  const DepthOffset stated{1.0, {0.01, 0.0}};
  const auto found = watch(0.015, 0.01, stated);  // short enough for the velocity to stay as it is
  ASSERT_TRUE(found);
  EXPECT_EQ(found->focal_ratio, stated.focal_ratio);
  EXPECT_EQ(found->shift_m, stated.shift_m);
}

TEST(DelayWatch, DepthOfTheSameInstantHasNone) {
  EXPECT_FALSE(watch(0.0, 0.0));
  EXPECT_FALSE(watch(0.0, -0.025)) << "the depth camera is beside that of colour";
}

TEST(DelayWatch, FramesFarApartShowNoMotion) {
  DelayWatch watch;
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = see(lapis::test::make_boards(1), {});
    frame.stamp = time::Time::from_seconds(0.2 * i);
    EXPECT_FALSE(watch.add(frame, geometry::Pose(Eigen::Translation3d(0.1 * i, 0.0, 0.0))));
  }
  EXPECT_EQ(watch.is_moving(), std::optional(false));
}

TEST(DelayWatch, WithoutPosesNothingIsConcluded) {
  DelayWatch watch;
  for (int i = 0; i < 60; ++i) {
    RgbdFrame frame = see(lapis::test::make_boards(1), {});
    frame.stamp = time::Time::from_seconds(i / 30.0);
    EXPECT_FALSE(watch.add(frame, std::nullopt));
  }
  EXPECT_FALSE(watch.is_over());
}

TEST(DepthCalibrator, TheCorrectedCalibrationPutsDepthWhereColourSeesIt) {
  const DepthOffset truth{1.0 / 1.11, {-0.025, 0.0}};
  const auto boards = lapis::test::make_boards(2);
  const RgbdFrame frame = see(boards, truth);
  DepthCalibrator calibrator(1);
  const auto found = calibrator.add(frame, kRegistered);
  ASSERT_TRUE(found);
  const auto cameras = corrected(kRegistered, found->offset);
  EXPECT_NEAR(cameras.depth.pinhole.fx, 1.11 * kView.fx, 1.0);
  EXPECT_NEAR(cameras.T_color_depth.translation().x(), -0.025, 0.003);
  const geometry::DepthImage seen = lapis::test::depth_of(boards, kView, Eigen::Vector3d::Zero());
  const geometry::DepthImage registered = images::DepthRegistration(cameras)(frame.depth);
  int known = 0;
  int right = 0;
  for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
    if (registered.pixels[i] <= 0.0F) continue;
    ++known;
    right += std::abs(registered.pixels[i] - seen.pixels[i]) < 0.01F ? 1 : 0;
  }
  EXPECT_GT(known, 0.7 * static_cast<double>(seen.pixels.size()));
  EXPECT_GT(right, 0.98 * known);
}

TEST(DepthCalibrator, RegisteredDepthIsNotCorrectedAndTheSearchEnds) {
  DepthCalibrator calibrator(1);
  int views = 0;
  for (time::Time stamp; calibrator.wants(stamp); stamp = stamp + time::Duration::from_seconds(0.25), ++views) {
    RgbdFrame frame = see(lapis::test::make_boards(3), {});
    frame.stamp = stamp;
    EXPECT_FALSE(calibrator.add(frame, kRegistered));
    EXPECT_FALSE(calibrator.wants(stamp + time::Duration::from_seconds(0.1)));
  }
  EXPECT_EQ(views, 16);
}

/// Boards of one grey value before a wall with strong texture: contrast is larger everywhere else.
TEST(DepthCalibrator, TextureBehindPlainThingsMovesNothing) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto boards = lapis::test::make_boards(seed);
    RgbdFrame frame = see(boards, {});
    std::mt19937 random(seed);
    for (int v = 0; v < kView.height; ++v) {
      for (int u = 0; u < kView.width; ++u) {
        const bool is_wall = frame.depth(u, v) > 3.9F;
        frame.gray(u, v) = is_wall ? static_cast<std::uint8_t>(random() % 256) : std::uint8_t{128};
      }
    }
    DepthCalibrator calibrator(1);
    const auto found = calibrator.add(frame, kRegistered);
    EXPECT_FALSE(found) << found->moved_px << " px, " << found->gain_sigmas << " sigmas";
  }
}

TEST(DepthCalibrator, ViewsOfAnotherCalibrationDoNotCount) {
  const RgbdFrame frame = see(lapis::test::make_boards(2), {1.0 / 1.11, {-0.025, 0.0}});
  DepthCalibrator calibrator(2);
  EXPECT_FALSE(calibrator.add(frame, kRegistered));
  images::RgbdCalibration other = kRegistered;
  other.depth.pinhole.fx += 1.0;
  EXPECT_FALSE(calibrator.add(frame, other));
  EXPECT_TRUE(calibrator.add(frame, other));
}

TEST(DepthCalibrator, BareWallsSayNothing) {
  DepthCalibrator calibrator(1);
  EXPECT_FALSE(calibrator.add(see({}, {1.2, {0.05, 0.0}}), kRegistered));
}

TEST(DepthCalibrator, ACorrectionAddsToWhatWasKnown) {
  images::RgbdCalibration known{{kView, {}}, {kView, {}}};
  known.depth.pinhole.fx = 300.0;
  known.T_color_depth.translation() = Eigen::Vector3d(-0.02, 0.0, 0.0);
  // A pixel (u, z) of the depth camera is seen at cx + 260 * ((u - cx) / 300 - 0.02 / z) before the correction.
  const DepthOffset offset{0.95, {0.01, -0.004}};
  const auto cameras = corrected(known, offset);
  constexpr double kPixel = 40.0, kDepth_m = 1.7;
  const auto shown = [&](const images::RgbdCalibration& c) {
    const Eigen::Vector3d p = c.T_color_depth * c.depth.pinhole.unproject(kPixel, kView.cy, kDepth_m);
    return kView.project(p).x();
  };
  const double moved =
      kView.cx + offset.focal_ratio * (shown(known) - kView.cx) + kView.fx * offset.shift_m.x() / kDepth_m;
  EXPECT_NEAR(shown(cameras), moved, 1e-9);
  EXPECT_EQ(describe(cameras), "fx 315.8, fy 273.7, 0.9 cm to the left of colour and 0.4 cm above it");
}

}  // namespace
}  // namespace lapis::slam
