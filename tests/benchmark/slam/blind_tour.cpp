#include "tests/benchmark/slam/blind_tour.hpp"

#include <algorithm>
#include <optional>

#include "tests/benchmark/slam/tour_recording.hpp"

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;

// Odometry whose heading errs more than it does by itself.
class BentOdometry {
 public:
  explicit BentOdometry(const BlindStretch& stretch) : stretch_(stretch) {}

  Pose bend(const simulator::OdometrySample& reading) {
    const Pose T_odom_base = pose_of(reading);
    const double t_s = reading.stamp.seconds();
    if (T_last_) {
      const double turn_rad = error_rad(t_s) - error_rad(last_s_);
      bent_ = bent_ * T_last_->inverse() * T_odom_base * planar(Eigen::Vector2d::Zero(), turn_rad);
    } else {
      bent_ = T_odom_base;
    }
    T_last_ = T_odom_base;
    last_s_ = t_s;
    return bent_;
  }

 private:
  double error_rad(double t_s) const {
    const double length_s = stretch_.to_s - stretch_.from_s;
    if (length_s <= 0.0) return 0.0;
    return stretch_.heading_error_rad * std::clamp((t_s - stretch_.from_s) / length_s, 0.0, 1.0);
  }

  BlindStretch stretch_;
  std::optional<Pose> T_last_;
  double last_s_ = 0.0;
  Pose bent_ = Pose::Identity();
};

}  // namespace

BlindTour play_blind(const simulator::SimulatorConfig& config, const std::filesystem::path& folder,
                     const SlamConfig& slam_config, const BlindStretch& stretch) {
  WatchedSlam slam(slam_config, geometry::T_base_camera(camera_mount(config.robot.camera)));
  BentOdometry odometry(stretch);
  play_tour(config, folder, [&](const TourFrame& tour_frame) {
    const RgbdFrame& frame = tour_frame.frame;
    for (const auto& reading : tour_frame.odometry) {
      if (config.wheels.odometry) slam.add_odometry(reading.stamp, odometry.bend(reading));
    }
    const double t_s = frame.stamp.seconds();
    const bool is_blind = t_s >= stretch.from_s && t_s < stretch.to_s;
    slam.process(is_blind ? black_frame(frame.stamp, frame.camera) : frame, tour_frame.T_start_camera);
  });
  BlindTour tour;
  tour.frames = slam.frames();
  tour.map = slam.finish();
  return tour;
}

}  // namespace lapis::slam::benchmark
