#include "slam/core/calibration/focal_length.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "slam/core/frame/noise_model.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

const geometry::PinholeCamera kTrue{640, 480, 525.0, 525.0, 319.5, 239.5};

geometry::PinholeCamera with_focal_length(geometry::PinholeCamera camera, double ratio) {
  camera.fx *= ratio;
  camera.fy *= ratio;
  return camera;
}

Eigen::Vector2d project(const Eigen::Vector3d& p) {
  return {kTrue.fx * p.x() / p.z() + kTrue.cx, kTrue.fy * p.y() / p.z() + kTrue.cy};
}

Pose motion(double turn_rad) {
  return geometry::se3_exp((geometry::Vector6d() << 0.1, -0.05, 0.2, 0.3 * turn_rad, turn_rad, 0.1).finished());
}

/// Points that the true camera shows before and after the motion, with noise of pixels and of depth.
std::vector<SharedPoint> points_of(const Pose& T_second_first, const NoiseConfig& noise, double share_of_noise,
                                   std::mt19937& random) {
  std::uniform_real_distribution<double> u(20.0, 620.0), v(20.0, 460.0), z(1.0, 4.0);
  std::normal_distribution<double> normal(0.0, share_of_noise);
  std::vector<SharedPoint> points;
  while (points.size() < 200) {
    const Eigen::Vector2d pixel(u(random), v(random));
    const double depth_m = z(random);
    const Eigen::Vector3d p = T_second_first * (depth_m * Eigen::Vector3d((pixel.x() - kTrue.cx) / kTrue.fx,
                                                                          (pixel.y() - kTrue.cy) / kTrue.fy, 1.0));
    const Eigen::Vector2d second = project(p);
    const bool is_seen =
        p.z() > 0.5 && second.x() > 0.0 && second.x() < 639.0 && second.y() > 0.0 && second.y() < 479.0;
    if (!is_seen) continue;
    const auto shaken = [&](double depth) { return depth + depth_sigma(noise, depth) * normal(random); };
    const auto moved = [&](Eigen::Vector2d at) -> Eigen::Vector2d {
      return at + Eigen::Vector2d(normal(random), normal(random));
    };
    points.push_back({moved(pixel), shaken(depth_m), 1.0, moved(second), shaken(p.z()), 1.0});
  }
  return points;
}

TEST(FocalLength, IsExactWithoutNoiseWhateverTheGuess) {
  std::mt19937 random(1);
  const NoiseConfig noise;
  const auto points = points_of(motion(0.3), noise, 0.0, random);
  for (const double stated : {0.9, 0.97, 1.0, 1.03, 1.1}) {
    const auto found = measure_focal_length(noise, with_focal_length(kTrue, stated), motion(0.25), points);
    ASSERT_TRUE(found) << stated;
    EXPECT_NEAR(std::exp(found->log_ratio) * stated, 1.0, 1e-6);
  }
}

TEST(FocalLength, InformationIsThatOfTheScatter) {
  std::mt19937 random(2);
  const NoiseConfig noise;
  constexpr int kTrials = 200;
  double sum = 0.0, squares = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto found = measure_focal_length(noise, with_focal_length(kTrue, 1.03), motion(0.3),
                                            points_of(motion(0.3), noise, 1.0, random));
    ASSERT_TRUE(found);
    const double error = found->log_ratio + std::log(1.03);
    sum += error * std::sqrt(found->information);
    squares += error * error * found->information;
  }
  EXPECT_NEAR(sum / kTrials, 0.0, 4.0 / std::sqrt(kTrials));
  EXPECT_GT(squares / kTrials, 0.7);
  EXPECT_LT(squares / kTrials, 1.4);
}

TEST(FocalLength, TurnShowsItAndAShiftHardly) {
  std::mt19937 random(3);
  const NoiseConfig noise;
  const auto information = [&](double turn_rad) {
    return measure_focal_length(noise, kTrue, motion(turn_rad), points_of(motion(turn_rad), noise, 1.0, random))
        ->information;
  };
  EXPECT_GT(information(0.4), 3.0 * information(0.0));
}

TEST(FocalLength, FewPointsAndWrongOnesGiveNothingOrLittle) {
  std::mt19937 random(4);
  const NoiseConfig noise;
  auto points = points_of(motion(0.3), noise, 1.0, random);
  const double good = measure_focal_length(noise, kTrue, motion(0.3), points)->information;
  std::uniform_real_distribution<double> u(0.0, 639.0);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].second = {u(random), u(random)};
  const auto spoilt = measure_focal_length(noise, kTrue, motion(0.3), points);
  EXPECT_LT(spoilt ? spoilt->information : 0.0, 0.1 * good);
  points.resize(20);
  EXPECT_FALSE(measure_focal_length(noise, kTrue, motion(0.3), points));
}

/// Plays a camera through the room whose images are of `small_camera` and whose camera info is `stated` times longer.
FocalLengthWatch watch_through_room(double stated) {
  const SlamConfig config;
  FocalLengthWatch watch(config.noise, config.features.scale_factor);
  RgbdSlam slam(config, test::room_path(0));
  for (int i = 0; i < 160; ++i) {
    RgbdFrame frame =
        test::render_room(test::small_camera(), test::room_path(i), time::Time::from_seconds(1 + i / 30.0));
    frame.camera = with_focal_length(frame.camera, stated);
    if (slam.process(frame).is_keyframe) watch.add(slam.map(), slam.map().keyframes().back().id);
  }
  return watch;
}

TEST(FocalLengthWatch, ContradictsAWrongOneAndNoRightOne) {
  const FocalLengthWatch right = watch_through_room(1.0);
  EXPECT_FALSE(right.contradiction());
  const auto estimate = right.estimate();
  ASSERT_TRUE(estimate) << "the path is long enough";
  EXPECT_NEAR(estimate->ratio, 1.0, 0.01);
  for (const double stated : {0.97, 1.03}) {
    const auto found = watch_through_room(stated).contradiction();
    ASSERT_TRUE(found) << stated;
    EXPECT_NEAR(found->ratio * stated, 1.0, 0.01);
  }
}

/// The map of a camera that goes through the room, whose camera info is `stated` times longer, until that is noticed.
struct CorrectedRun {
  RgbdSlam slam;
  double stated;
  int corrections = 0;

  CorrectedRun(double stated_ratio, bool corrects) : slam(SlamConfig{}, test::room_path(0)), stated(stated_ratio) {
    const SlamConfig config;
    FocalLengthWatch watch(config.noise, config.features.scale_factor);
    for (int i = 0; i < 160; ++i) {
      RgbdFrame frame = test::render_room(test::small_camera(), test::room_path(i), stamp_of(i));
      frame.camera = with_focal_length(frame.camera, stated);
      if (!slam.process(frame).is_keyframe || !corrects) continue;
      watch.add(slam.map(), slam.map().keyframes().back().id);
      const auto found = corrections > 0 ? watch.refinement() : watch.contradiction();
      if (!found) continue;
      ++corrections;
      EXPECT_TRUE(slam.change_focal_length(found->ratio));
      stated *= found->ratio;
      watch = FocalLengthWatch(config.noise, config.features.scale_factor);
    }
  }
  static time::Time stamp_of(int i) { return time::Time::from_seconds(1 + i / 30.0); }
  /// Root mean square of the errors of the key-frames' positions [m].
  double error_m() const {
    double squares = 0.0;
    for (const Keyframe& keyframe : slam.map().keyframes()) {
      const int i = static_cast<int>(std::lround((keyframe.stamp.seconds() - 1.0) * 30.0));
      squares += (keyframe.T_map_camera.translation() - test::room_path(i).translation()).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(slam.keyframe_count()));
  }
};

TEST(FocalLengthCorrection, OnlyTheRestOfTheErrorIsLeftInTheMap) {
  const CorrectedRun right(1.0, true);
  ASSERT_EQ(right.corrections, 0);
  for (const double stated : {0.97, 1.03}) {
    const CorrectedRun run(stated, true), wrong(stated, false);
    ASSERT_GT(run.corrections, 0);
    const double rest = std::abs(std::log(run.stated) / std::log(stated));
    EXPECT_LT(rest, 1.0 / 3.0);
    EXPECT_LT(run.error_m(), 2.0 * right.error_m() + rest * wrong.error_m()) << stated;
    const PoseGraphSnapshot graph = run.slam.pose_graph();
    for (const PoseGraphEdge& edge : graph.edges) {
      const geometry::Pose T_from_to =
          graph.nodes[edge.from].T_map_camera.inverse() * graph.nodes[edge.to].T_map_camera;
      EXPECT_LT(geometry::se3_log(edge.T_from_to.inverse() * T_from_to).norm(), 0.02);
    }
  }
}

TEST(FocalLengthCorrection, SurfacesStayWhereTheyAreSeen) {
  Map map;
  Keyframe keyframe;
  keyframe.camera = with_focal_length(kTrue, 1.03);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1.0).normalized(), on_plane(0.4, 0.3, 2.0);
  // Two points of a plane as a camera takes them to be whose focal length is too long.
  const auto assumed = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return {p.x() / 1.03, p.y() / 1.03, p.z()}; };
  const Eigen::Vector3d assumed_normal(1.03 * normal.x(), 1.03 * normal.y(), normal.z());
  keyframe.surface = std::vector<SurfaceSample>{{assumed(on_plane), assumed_normal.normalized()}};
  map.add_keyframe(keyframe);
  map.change_focal_length(1.0 / 1.03);
  EXPECT_NEAR(map.keyframe(0).camera.fx, kTrue.fx, 1e-9);
  EXPECT_LT((map.keyframe(0).surface[0].point - on_plane).norm(), 1e-12);
  EXPECT_LT((map.keyframe(0).surface[0].normal - normal).norm(), 1e-12);
}

}  // namespace
}  // namespace lapis::slam
