// What it costs slam to publish its map: /slam/frame at 30 Hz, pose graph and path at 2 Hz, landmarks at 0.5 Hz,
// converted, serialised and written by Fast DDS to one reader in another process. The map is made up, with the sizes of
// real ones; tracking and bundle adjustment are not counted.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <random>
#include <thread>

#include "common/mapping/wire/landmark_mirror.hpp"
#include "common/messages/landmarks.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/slam.hpp"
#include "slam/conversions.hpp"
#include "slam/landmark_publisher.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/private_domain.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::slam {
namespace {

constexpr int kFramesPerSecond = 30;
constexpr int kFramesPerKeyframe = 10;
constexpr std::size_t kFeatures = 600;
constexpr int kNewLandmarks = 150;        // of a key-frame
constexpr int kSharedLandmarks = 100;     // of a key-frame with each of the four before
constexpr int kAdjustedLandmarks = 1000;  // by the bundle adjustment of a key-frame
constexpr double kGraphPeriod_s = 0.5;
constexpr double kLandmarkPeriod_s = 2.0;
const FrameIds kIds{"map", "odom", "base_link"};

double cpu_ms(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// CPU time of this thread between construction and destruction, added to `sum_ms`.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_ms) : sum_ms_(sum_ms), begin_ms_(cpu_ms(CLOCK_THREAD_CPUTIME_ID)) {}
  ~Stopwatch() { sum_ms_ += cpu_ms(CLOCK_THREAD_CPUTIME_ID) - begin_ms_; }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_ms_;
  double begin_ms_;
};

/// A map that grows along a path through a building: rows of 30 m, 4 m apart, a key-frame every 0.35 m.
class GrowingMap {
 public:
  void add_keyframe() {
    Keyframe keyframe;
    const auto index = static_cast<double>(map.keyframes().size());
    keyframe.stamp = time::Time::from_seconds(index * kFramesPerKeyframe / kFramesPerSecond);
    keyframe.T_map_camera.translation() = position(index);
    keyframe.features = std::vector<Feature>(kFeatures);
    const KeyframeId id = map.add_keyframe(std::move(keyframe));
    int feature = 0;
    for (KeyframeId before = id < 4 ? 0 : id - 4; before < id; ++before) {
      for (int k = 0; k < kSharedLandmarks; ++k) {
        map.add_observation(static_cast<LandmarkId>(before * kNewLandmarks) + static_cast<LandmarkId>(k),
                            {id, feature++});
      }
    }
    for (int k = 0; k < kNewLandmarks; ++k) {
      const Eigen::Vector3d p =
          position(index) + Eigen::Vector3d(3.0 * unit_(random_), 2.0 * unit_(random_), unit_(random_));
      map.add_observation(map.add_landmark(p, 1.0), {id, feature++});
    }
    move(kAdjustedLandmarks, 0.002);
    for (const EdgeType type : {EdgeType::kOdometry, EdgeType::kWheelOdometry, EdgeType::kCovisibility}) {
      if (id > 1) edges.push_back({id - (type == EdgeType::kCovisibility ? 2 : 1), id, type});
    }
    ++version;
  }
  void close_loop() {
    for (const Keyframe& keyframe : map.keyframes()) {
      geometry::Pose T = keyframe.T_map_camera;
      T.translation().x() += 0.05;
      map.set_pose(keyframe.id, T);
    }
    move(static_cast<int>(landmarks()), 0.05);
    ++version;
  }
  std::size_t landmarks() const { return map.keyframes().size() * kNewLandmarks; }
  PoseGraphSnapshot pose_graph() const {
    PoseGraphSnapshot snapshot{version, {}, edges};
    for (const Keyframe& k : map.keyframes()) snapshot.nodes.push_back({k.id, k.stamp, k.T_map_camera});
    return snapshot;
  }

  Map map;
  std::vector<PoseGraphEdge> edges;
  std::uint64_t version = 0;

 private:
  static Eigen::Vector3d position(double index) {
    const double path_m = 0.35 * index;
    return {std::fmod(path_m, 30.0), 4.0 * std::floor(path_m / 30.0), 1.0};
  }
  /// Moves the newest landmarks along x by a size of that order.
  void move(int newest, double size_m) {
    const std::size_t end = landmarks();
    for (std::size_t id = end - std::min(end, static_cast<std::size_t>(newest)); id < end; ++id) {
      const Eigen::Vector3d p = map.landmark(static_cast<LandmarkId>(id)).p_map;
      map.set_position(static_cast<LandmarkId>(id),
                       p + Eigen::Vector3d(size_m * (1.0 + 0.5 * unit_(random_)), 0.0, 0.0));
    }
  }

  std::mt19937 random_{1};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

/// What a phase of a run has cost.
struct Costs {
  double frames_ms = 0.0;
  double graph_ms = 0.0;
  double landmarks_ms = 0.0;
  double editing_ms = 0.0;        // of the map: not slam's publishing
  double process_ms = 0.0;        // DDS's threads included, editing not
  double longest_frame_ms = 0.0;  // of all three, in one frame
};

/// slam's outputs, published as SlamComponent does.
class Snapshots {
 public:
  explicit Snapshots(runtime::Context& context)
      : frames_(context.advertise(topics::kTrackedFrame)), graph_(context.advertise(topics::kPoseGraph)),
        path_(context.advertise(topics::kKeyframePath)), landmarks_(context, kLandmarkPeriod_s) {
    landmarks_.begin_epoch(1, 1, {});
    frame_.optical_frame = "camera_color_optical_frame";
    frame_.session = 1;
  }
  bool is_matched() const { return frames_.matched() > 0 && graph_.matched() > 0 && path_.matched() > 0; }

  void publish(GrowingMap& world, Costs& costs) {
    frame_.stamp = frame_.stamp + time::Duration{1'000'000'000 / kFramesPerSecond};
    {
      const Stopwatch watch(costs.frames_ms);
      TrackingResult result;
      result.state = TrackingState::kTracking;
      result.keyframe_id = world.map.keyframes().back().id;
      result.graph_version = world.version;
      frames_.publish(to_tracked_frame(result, frame_, kIds));
    }
    {
      const Stopwatch watch(costs.graph_ms);
      publish_graph(world);
    }
    const Stopwatch watch(costs.landmarks_ms);
    if (graph_version_ == world.version && landmarks_.wants(graph_version_, frame_.stamp, false)) {
      landmarks_.begin_version(world.map, graph_version_, messages::header(frame_.stamp, kIds.map));
      landmark_version_ = graph_version_;
    }
    landmarks_.publish_part(frame_.stamp);
  }
  /// Publishes what is left of the landmarks' version; returns its number.
  std::uint64_t finish() {
    landmarks_.publish_rest();
    return landmark_version_;
  }

 private:
  void publish_graph(const GrowingMap& world) {
    const bool is_due = !graph_stamp_ || (frame_.stamp - *graph_stamp_).seconds() >= kGraphPeriod_s;
    if (!is_due || world.version == graph_version_) return;
    const auto graph = world.pose_graph();
    graph_.publish(to_message(graph, frame_, kIds));
    path_.publish(to_path(graph, frame_, kIds));
    graph_version_ = graph.version;
    graph_stamp_ = frame_.stamp;
  }

  dds::Publisher<lapis_msgs::msg::TrackedFrame>& frames_;
  dds::Publisher<lapis_msgs::msg::PoseGraph>& graph_;
  dds::Publisher<nav_msgs::msg::Path>& path_;
  LandmarkPublisher landmarks_;
  FrameContext frame_;
  std::optional<time::Time> graph_stamp_;
  std::uint64_t graph_version_ = 0;
  std::uint64_t landmark_version_ = 0;
};

/// Reads what slam says, as a planner would.
struct ReaderConfig {};

template <class Field>
void describe(Field& /*field*/, ReaderConfig& /*c*/) {}

class ReaderComponent {
 public:
  using Config = ReaderConfig;
  static constexpr const char* kName = "snapshot_reader";
  static constexpr const char* kSummary = "Mirrors slam's landmarks, for lapis_slam_snapshot_benchmark.";

  ReaderComponent(const Config& /*config*/, runtime::Context& context) {
    context.subscribe(topics::kTrackedFrame, [](const auto&) {});
    context.subscribe(topics::kPoseGraph, [](const auto&) {});
    context.subscribe(topics::kKeyframePath, [](const auto&) {});
    context.subscribe(topics::kLandmarks, [this](const auto& message) {
      if (auto tile = messages::from_message(message)) mirror_.apply_tile(message.epoch(), std::move(*tile));
      report();
    });
    context.subscribe(topics::kLandmarkState, [this](const auto& message) {
      mirror_.apply_state(messages::from_message(message));
      report();
    });
  }

 private:
  void report() {
    if (!mirror_.is_consistent() || reported_ == mirror_.state()->graph_version) return;
    reported_ = mirror_.state()->graph_version;
    spdlog::info("mirrored version {}.", reported_);
  }

  mapping::LandmarkMirror mirror_;
  std::uint64_t reported_ = 0;
};

/// `seconds` of frames by the wall clock.
Costs run(GrowingMap& world, Snapshots& snapshots, int seconds, bool has_loop) {
  using Clock = std::chrono::steady_clock;
  Costs costs;
  const double begin_ms = cpu_ms(CLOCK_PROCESS_CPUTIME_ID);
  auto next = Clock::now();
  for (int i = 0; i < seconds * kFramesPerSecond; ++i) {
    {
      const Stopwatch watch(costs.editing_ms);
      if (i == 0 && has_loop) world.close_loop();
      if (i % kFramesPerKeyframe == 0) world.add_keyframe();
    }
    double frame_ms = 0.0;
    {
      const Stopwatch watch(frame_ms);
      snapshots.publish(world, costs);
    }
    costs.longest_frame_ms = std::max(costs.longest_frame_ms, frame_ms);
    std::this_thread::sleep_until(next += std::chrono::microseconds(1'000'000 / kFramesPerSecond));
  }
  costs.process_ms = cpu_ms(CLOCK_PROCESS_CPUTIME_ID) - begin_ms - costs.editing_ms;
  return costs;
}

/// CPU time to find out that no landmark has changed [ms].
double walk_ms(const GrowingMap& world) {
  LandmarkTiles tiles{LandmarkTileConfig{}};
  tiles.update(world.map, 1);
  double ms = 0.0;
  {
    const Stopwatch watch(ms);
    tiles.update(world.map, 2);
  }
  return ms;
}

void print_row(const GrowingMap& world, const char* what, const Costs& costs, int seconds, double walk) {
  const auto percent = [seconds](double ms) { return 0.1 * ms / seconds; };
  std::printf("| %zu | %zu | %s | %.2f | %.2f | %.2f | %.2f | %.1f | %.1f |\n", world.map.keyframes().size(),
              world.map.landmark_count(), what, percent(costs.frames_ms), percent(costs.graph_ms),
              percent(costs.landmarks_ms), percent(costs.process_ms), costs.longest_frame_ms, walk);
  std::fflush(stdout);
}

void measure(int keyframes, int seconds) {
  GrowingMap world;
  for (int i = 0; i < keyframes; ++i) world.add_keyframe();
  test::ChildProcess reader("/proc/self/exe", {"--reader"});
  runtime::Context context({"slam", test::participant_options("slam")});
  Snapshots snapshots(context);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!snapshots.is_matched()) {
    if (std::chrono::steady_clock::now() > deadline)
      throw std::runtime_error("the reader did not come: " + reader.log());
    context.executor().spin_once(std::chrono::milliseconds(10));
  }
  run(world, snapshots, 4, false);  // all tiles go out
  const double walk = walk_ms(world);
  print_row(world, "growing", run(world, snapshots, seconds, false), seconds, walk);
  print_row(world, "growing, loop closed", run(world, snapshots, seconds, true), seconds, walk);
  const std::string mirrored = "mirrored version " + std::to_string(snapshots.finish()) + ".";
  if (!reader.wait_for_line(mirrored)) throw std::runtime_error("no " + mirrored + " in " + reader.log());
}

int benchmark(int argc, char** argv) {
  CLI::App app("CPU time of publishing frames, pose graph and landmarks, in % of a core",
               "lapis_slam_snapshot_benchmark");
  int seconds = 10;
  app.add_option("--seconds", seconds, "of each phase, by the wall clock")->check(CLI::Range(1, 600));
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::warn);
  test::enter_private_domain();
  std::printf(
      "| key-frames | landmarks | phase | frame [%%] | graph, path [%%] | landmarks [%%] | "
      "process with DDS [%%] | longest frame [ms] | walk over all landmarks [ms] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const int keyframes : {100, 300, 1000}) measure(keyframes, seconds);
  return 0;
}

}  // namespace
}  // namespace lapis::slam

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--reader") {
    argv[1] = argv[0];
    return lapis::runtime::run_component<lapis::slam::ReaderComponent>(argc - 1, argv + 1);
  }
  try {
    return lapis::slam::benchmark(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "lapis_slam_snapshot_benchmark: " << error.what() << '\n';
    return 1;
  }
}
