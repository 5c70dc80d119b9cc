// What a frame costs, beside the chain that anybody writes first with OpenCV: the same frames, one after the other
// through both, CPU time of the calling thread. Frames: a recording, a tour of a simulated scene, or else the recording
// aws_small_house_loop, or else a room of tiles.
//   lapis_tracking_benchmark --scene apartment --recordings FOLDER
//   lapis_tracking_benchmark --sequence FOLDER --frames
#include <malloc.h>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "evaluator/core/statistics.hpp"
#include "simulator/set_up.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/benchmark/slam/plain_chain.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"
#include "tests/unit/slam/synthetic_room.hpp"
#include "tests/unit/slam/tum_sequence.hpp"

namespace lapis::slam::benchmark {
namespace {

constexpr const char* kRecording = "aws_small_house_loop";
constexpr int kRoomFrames = 300;

struct Options {
  std::string sequence;
  std::string scene;
  bool with_frames = false;
  int seed = 1;
  std::string folder;
  std::vector<std::string> overrides;
};

/// Poses of the camera: true ones, and as a chain has them.
struct Poses {
  std::vector<geometry::Pose> truth, estimate;
};

struct Times {
  std::vector<double> tracking_ms, keyframe_ms, lost_ms;
  std::vector<double> plain_ms;
  int plain_poses = 0;
  std::size_t keyframes = 0;
  double bytes_per_keyframe = NAN;
  Poses ours, plain;  // empty where the truth is not known
};

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double allocated_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

// Plays frames through both chains.
class Race {
 public:
  Race(const SlamConfig& config, const geometry::Pose& T_base_camera, bool with_frames = false)
      : slam_(config, T_base_camera, T_base_camera), with_frames_(with_frames) {}

  void add_odometry(time::Time stamp, const geometry::Pose& T_odom_base) { slam_.add_odometry(stamp, T_odom_base); }

  void run(const RgbdFrame& frame, const std::optional<geometry::Pose>& T_world_camera = std::nullopt) {
    const double before_bytes = allocated_bytes();
    const double start_ms = thread_ms();
    const TrackingResult result = slam_.process(frame);
    const double ours_ms = thread_ms() - start_ms;
    bytes_ += allocated_bytes() - before_bytes;
    if (result.state != TrackingState::kTracking) {
      times_.lost_ms.push_back(ours_ms);
    } else {
      (result.is_keyframe ? times_.keyframe_ms : times_.tracking_ms).push_back(ours_ms);
    }
    if (result.is_keyframe && ++times_.keyframes == 1) first_bytes_ = bytes_;
    const double plain_start_ms = thread_ms();
    const auto T_previous_camera = plain_.process(frame);
    times_.plain_ms.push_back(thread_ms() - plain_start_ms);
    if (T_previous_camera) ++times_.plain_poses;
    if (T_world_camera) compare(result, T_previous_camera, *T_world_camera);
    if (with_frames_) print_frame(frame.stamp, result, ours_ms);
  }

  Times finish() {
    if (times_.keyframes > 1) {
      times_.bytes_per_keyframe = (bytes_ - first_bytes_) / static_cast<double>(times_.keyframes - 1);
    }
    return times_;
  }

 private:
  // Where the plain chain has no pose, it stays where it was.
  void compare(const TrackingResult& result, const std::optional<geometry::Pose>& T_previous_camera,
               const geometry::Pose& T_world_camera) {
    if (T_previous_camera) T_plain_ = T_plain_ * *T_previous_camera;
    times_.plain.truth.push_back(T_world_camera);
    times_.plain.estimate.push_back(T_plain_);
    if (!has_pose(result)) return;
    times_.ours.truth.push_back(T_world_camera);
    times_.ours.estimate.push_back(result.T_map_keyframe * result.T_keyframe_camera);
  }

  void print_frame(time::Time stamp, const TrackingResult& result, double ms) const {
    std::printf("%8.3f s %s by %3zu%s %3u of %3u matches, %6.2f ms", stamp.seconds(),
                has_pose(result) ? "pose" : "none", static_cast<std::size_t>(result.keyframe_id),
                result.is_keyframe ? " KF" : "   ", result.inliers, result.matches, ms);
    if (has_pose(result) && !times_.ours.truth.empty()) {
      const auto& [truth, estimate] = times_.ours;
      const geometry::Pose T =
          (truth.front().inverse() * truth.back()).inverse() * estimate.front().inverse() * estimate.back();
      std::printf(", off by %6.2f cm %5.2f deg", 100.0 * T.translation().norm(),
                  geometry::rotation_angle(T.linear()) * 180.0 / M_PI);
    }
    std::printf(" %s\n", result.reason.c_str());
  }

  RgbdSlam slam_;
  bool with_frames_;
  PlainChain plain_;
  geometry::Pose T_plain_ = geometry::Pose::Identity();
  Times times_;
  double bytes_ = 0.0, first_bytes_ = 0.0;  // that slam holds: now, after the first key-frame
};

geometry::Pose pose_of(const simulator::OdometrySample& reading) {
  return geometry::make_pose({reading.position.x(), reading.position.y(), 0.0},
                             Eigen::Quaterniond(Eigen::AngleAxisd(reading.yaw_rad, Eigen::Vector3d::UnitZ())));
}

Times race_on_tour(const SlamConfig& config, const simulator::SimulatorConfig& simulated, const std::string& folder) {
  Race race(config, geometry::T_base_camera(camera_mount(simulated.robot.camera)));
  play_tour(simulated, folder, [&](const TourFrame& tour_frame) {
    for (const auto& reading : tour_frame.odometry) race.add_odometry(reading.stamp, pose_of(reading));
    race.run(tour_frame.frame);
  });
  return race.finish();
}

Times race_on_recording(const SlamConfig& config, const test::TumSequence& sequence, bool with_frames) {
  Race race(config, geometry::Pose::Identity(), with_frames);
  for (std::size_t i = 0; i < sequence.entries.size(); ++i) {
    race.run(sequence.load(i), sequence.entries[i].T_world_camera);
  }
  return race.finish();
}

Times race_in_room(const SlamConfig& config) {
  const geometry::PinholeCamera camera{640, 360, 320.0, 320.0, 319.5, 179.5};
  Race race(config, geometry::Pose::Identity());
  for (int i = 0; i < kRoomFrames; ++i) {
    race.run(test::render_room(camera, test::room_path(i), time::Time::from_seconds(i / 30.0)));
  }
  return race.finish();
}

void print_row(const char* what, const std::vector<double>& milliseconds, double reference_ms) {
  const auto median = evaluator::quantile(milliseconds, 0.5);
  const auto p99 = evaluator::quantile(milliseconds, 0.99);
  std::printf("%-42s %6zu %9.2f %9.2f %7.2f\n", what, milliseconds.size(), median.value_or(NAN), p99.value_or(NAN),
              median.value_or(NAN) / reference_ms);
}

void print(const std::string& frames, const Times& times) {
  const double plain_ms = evaluator::quantile(times.plain_ms, 0.5).value_or(NAN);
  std::printf("frames: %s\n%-42s %6s %9s %9s %7s\n", frames.c_str(), "CPU time of the thread [ms]", "frames", "median",
              "p99", "ratio");
  print_row("slam, tracking frame", times.tracking_ms, plain_ms);
  print_row("slam, key-frame with local mapping", times.keyframe_ms, plain_ms);
  if (!times.lost_ms.empty()) print_row("slam, frame not tracked", times.lost_ms, plain_ms);
  print_row("OpenCV: ORB(1000), brute force, PnP RANSAC", times.plain_ms, plain_ms);
  std::printf("OpenCV found %d poses; slam holds %.3f MB (counted heap) more per key-frame, %zu key-frames\n",
              times.plain_poses, 1e-6 * times.bytes_per_keyframe, times.keyframes);
  if (times.ours.truth.empty()) return;
  std::printf("ATE (SE(3)): slam %.2f cm over %zu of %zu frames, OpenCV %.2f cm\n",
              100.0 * test::ate_se3(times.ours.truth, times.ours.estimate), times.ours.truth.size(),
              times.plain.truth.size(), 100.0 * test::ate_se3(times.plain.truth, times.plain.estimate));
}

void run(const Options& options) {
  auto [simulated, slam] = tour_config(options.overrides);
  if (!options.scene.empty()) {
    simulated.scene = options.scene;
    simulated.seed = options.seed;
    return print("tour of " + options.scene + ", seed " + std::to_string(options.seed),
                 race_on_tour(slam.method, simulated, options.folder));
  }
  if (!options.sequence.empty()) {
    return print(options.sequence,
                 race_on_recording(slam.method, test::read_sequence(options.sequence), options.with_frames));
  }
  if (const auto sequence = test::find_sequence(kRecording)) {
    return print(kRecording, race_on_recording(slam.method, *sequence, options.with_frames));
  }
  print("room of tiles, 640x360", race_in_room(slam.method));
}

}  // namespace
}  // namespace lapis::slam::benchmark

int main(int argc, char** argv) {
  using lapis::slam::benchmark::Options;
  CLI::App app("CPU time of a frame beside OpenCV's plain chain: the same frames, one run.");
  Options options;
  app.add_option("--scene", options.scene,
                 "tour of a simulated scene: bundled name or file; without it the recording aws_small_house_loop below "
                 "LAPIS_TEST_DATA, or else a room of tiles");
  app.add_option("--sequence", options.sequence,
                 "recording in the layout of the TUM RGB-D benchmark, with camera.yaml, associations.txt and "
                 "groundtruth.txt line by line; images rectified, depth registered");
  app.add_flag("--frames", options.with_frames, "of a recording: also a line for each frame");
  app.add_option("--seed", options.seed, "of the tour");
  app.add_option("--recordings", options.folder, "keep the frames of tours here, as lapis_slam_tours does");
  app.add_option("--set", options.overrides, "slam.KEY=VALUE, simulator.KEY=VALUE or robot.KEY=VALUE");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    lapis::slam::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
