#include "slam/core/motion/late_depth.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

time::Time stamp_of(int i) { return time::Time::from_seconds(1 + i / 30.0); }

RgbdFrame frame_at(double stamp_s, double delay_s) {
  const geometry::PinholeCamera camera = test::small_camera();
  RgbdFrame frame{time::Time::from_seconds(stamp_s), camera, geometry::GrayImage(camera.width, camera.height),
                  geometry::DepthImage(camera.width, camera.height)};
  frame.depth_delay = time::Duration::from_seconds(delay_s);
  return frame;
}

double measured_s(const LateDepth& depth) { return depth.nearest().stamp.seconds(); }

TEST(LateDepth, IsThatWhichWasMeasuredNearest) {
  LateDepth late;
  late.add(frame_at(1.0, 0.03));
  EXPECT_NEAR(measured_s(late), 1.03, 1e-6) << "there is no other";
  late.add(frame_at(1.06, 0.03));
  EXPECT_NEAR(measured_s(late), 1.03, 1e-6) << "as near, and from before colour";
  late.add(frame_at(1.16, 0.03));
  EXPECT_NEAR(measured_s(late), 1.19, 1e-6) << "one from before is more than twice as far";
  LateDepth very_late;
  for (const double stamp_s : {1.0, 1.02, 1.04, 1.06}) very_late.add(frame_at(stamp_s, 0.05));
  EXPECT_NEAR(measured_s(very_late), 1.05, 1e-6);
  LateDepth early;
  for (const double stamp_s : {1.0, 1.06}) early.add(frame_at(stamp_s, -0.03));
  EXPECT_NEAR(measured_s(early), 1.03, 1e-6);
}

TEST(LateDepth, OfAnotherCameraIsNotUsed) {
  LateDepth late;
  late.add(frame_at(1.0, 0.03));
  RgbdFrame other = frame_at(1.06, 0.03);
  other.camera.fx *= 1.02;
  late.add(other);
  EXPECT_NEAR(measured_s(late), 1.09, 1e-6);
}

enum class Depth { kOfColorsInstant, kLate, kLateAndKnownFromThe20thFrame };

/// Plays a camera of 15 Hz in the room; late depth is of half a period later than colour. Returns the root mean square
/// of the errors of the key-frames' positions [m].
double error_m(Depth depth) {
  constexpr double kDelay_s = 1.0 / 30.0;
  RgbdSlam slam(SlamConfig{}, test::room_path(0));
  slam.keep_depth(true);
  for (int i = 0; i < 160; i += 2) {
    RgbdFrame frame = test::render_room(test::small_camera(), test::room_path(i), stamp_of(i));
    if (depth != Depth::kOfColorsInstant) {
      frame.depth = test::render_room(test::small_camera(), test::room_path(i + 1), stamp_of(i)).depth;
    }
    const bool is_known = depth == Depth::kLateAndKnownFromThe20thFrame && i >= 40;
    if (is_known && i == 40) {
      EXPECT_TRUE(slam.correct_depth({.delay_s = kDelay_s}));
    }
    if (is_known) frame.depth_delay = time::Duration::from_seconds(kDelay_s);
    EXPECT_EQ(slam.process(frame).state, TrackingState::kTracking) << i;
  }
  double squares = 0.0;
  for (const Keyframe& keyframe : slam.map().keyframes()) {
    const int i = static_cast<int>(std::lround((keyframe.stamp.seconds() - 1.0) * 30.0));
    squares += (keyframe.T_map_camera.translation() - test::room_path(i).translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(slam.keyframe_count()));
}

TEST(LateDepth, CostsLittleWhenTheDelayIsKnown) {
  const double corrected_m = error_m(Depth::kLateAndKnownFromThe20thFrame);
  EXPECT_LT(corrected_m, 0.5 * error_m(Depth::kLate));
  EXPECT_LT(corrected_m, 1.5 * error_m(Depth::kOfColorsInstant));
}

TEST(LateDepth, IsSeenFromWhereColourWas) {
  const geometry::Pose T_room_color = test::room_path(10), T_room_depth = test::room_path(11);
  const RgbdFrame wanted = test::render_room(test::small_camera(), T_room_color, stamp_of(10));
  const RgbdFrame later = test::render_room(test::small_camera(), T_room_depth, stamp_of(11));
  const geometry::DepthImage seen =
      seen_from(T_room_color.inverse() * T_room_depth, {later.stamp, later.camera, later.depth});
  double before_m = 0.0, after_m = 0.0, count = 0.0;
  for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
    if (seen.pixels[i] <= 0.0F) continue;
    before_m += std::abs(later.depth.pixels[i] - wanted.depth.pixels[i]);
    after_m += std::abs(seen.pixels[i] - wanted.depth.pixels[i]);
    count += 1.0;
  }
  EXPECT_GT(count, 0.9 * static_cast<double>(seen.pixels.size()));
  EXPECT_LT(after_m, 0.02 * before_m);
}

TEST(LateDepth, MapWhoseDepthIsNotKeptStaysAsItIs) {
  RgbdSlam slam(SlamConfig{}, test::room_path(0));
  slam.process(test::render_room(test::small_camera(), test::room_path(0), stamp_of(0)));
  const std::uint64_t version = slam.graph_version();
  EXPECT_FALSE(slam.correct_depth({.delay_s = 0.03}));
  EXPECT_EQ(slam.graph_version(), version);
}

}  // namespace
}  // namespace lapis::slam
