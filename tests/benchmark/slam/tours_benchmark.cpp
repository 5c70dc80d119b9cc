// How good slam is on tours of simulated scenes, without DDS: frames lost, errors of the trajectory, honesty of the
// information, time. A row per run, failures included.
//   lapis_slam_tours --scenes apartment --seeds 1,2,3 --set slam.bundle.window=8 --set simulator.noise.drift=hard
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "common/files/atomic_file.hpp"
#include "common/trajectory/trajectory.hpp"
#include "evaluator/core/trajectory/ate.hpp"
#include "simulator/set_up.hpp"
#include "slam/core/files/pose_graph_file.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/benchmark/slam/edge_honesty.hpp"
#include "tests/benchmark/slam/pose_error.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"
#include "tests/benchmark/slam/wrong_loop_trials.hpp"

namespace lapis::slam::benchmark {
namespace {

struct Options {
  std::vector<std::string> scenes{"apartment"};
  std::vector<int> seeds{1, 2, 3, 4, 5};
  std::vector<std::string> worlds, overrides;
  std::string folder, graphs;
  bool no_odometry = false;
  bool with_loops = false;
  int wrong_loop_seeds = 0;
  double odometry_offset_s = 0.0;
};

// Points that a key-frame sees, for what it shares with others.
struct View {
  geometry::PinholeCamera camera;
  geometry::Pose T_map_camera;  // true
  geometry::DepthImage depth;
  std::vector<Eigen::Vector3d> points;  // in the camera
};

// A pose as published.
struct Told {
  geometry::Pose T_map_camera, truth;
  geometry::Matrix6d covariance;
};

struct Run {
  int frames = 0, tracked = 0;
  std::map<std::string, int> frames_by_source;
  std::vector<double> milliseconds;              // CPU time of each frame
  std::vector<double> online_errors_m;           // of every frame as published at its time
  std::map<std::int64_t, geometry::Pose> truth;  // T_map_camera by stamp
  TrackingResult last;
  geometry::Pose T_last_true = geometry::Pose::Identity();
  PoseGraphSnapshot graph;
  std::vector<View> views;  // of the key-frames
  LoopSummary loops;
  std::size_t landmarks = 0;
  std::vector<Told> told;  // of the frames that became key-frames
};

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double v : values) squares += v * v;
  return values.empty() ? NAN : std::sqrt(squares / static_cast<double>(values.size()));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? NAN : sum / static_cast<double>(values.size());
}

View make_view(const RgbdFrame& frame, const geometry::Pose& T_map_camera) {
  constexpr int kStep_px = 16;
  View view{frame.camera, T_map_camera, frame.depth, {}};
  for (int y = kStep_px / 2; y < view.depth.height; y += kStep_px) {
    for (int x = kStep_px / 2; x < view.depth.width; x += kStep_px) {
      const double z = view.depth(x, y);
      if (z > 0.0) view.points.push_back(view.camera.unproject(x, y, z));
    }
  }
  return view;
}

// Share of what `a` sees that `b` sees, too.
double common_surface(const View& a, const View& b) {
  constexpr double kSame_m = 0.1;
  const geometry::Pose T_b_a = b.T_map_camera.inverse() * a.T_map_camera;
  std::size_t common = 0;
  for (const Eigen::Vector3d& point : a.points) {
    const Eigen::Vector3d p = T_b_a * point;
    if (p.z() <= 0.0) continue;
    const auto x = static_cast<int>(std::lround(b.camera.fx * p.x() / p.z() + b.camera.cx));
    const auto y = static_cast<int>(std::lround(b.camera.fy * p.y() / p.z() + b.camera.cy));
    if (x < 0 || y < 0 || x >= b.depth.width || y >= b.depth.height) continue;
    if (std::abs(b.depth(x, y) - p.z()) < kSame_m) ++common;
  }
  return a.points.empty() ? 0.0 : static_cast<double>(common) / static_cast<double>(a.points.size());
}

bool is_revisit(const View& older, const View& newer) {
  constexpr double kWithin_m = 1.0, kWithin_rad = M_PI / 6.0, kCommon = 0.3;
  const geometry::Pose T = older.T_map_camera.inverse() * newer.T_map_camera;
  return T.translation().norm() <= kWithin_m && geometry::rotation_angle(T.linear()) <= kWithin_rad &&
         std::min(common_surface(older, newer), common_surface(newer, older)) >= kCommon;
}

bool is_wrong_loop(const PoseGraphEdge& loop, const std::vector<View>& views) {
  return is_wrong(loop.T_from_to, views[loop.from].T_map_camera.inverse() * views[loop.to].T_map_camera);
}

// Revisits by the truth: key-frames within 1 m, 30 degrees and 30 % common surface of one so much older that it is no
// neighbour. A passage is a row of such key-frames.
struct Recall {
  std::size_t keyframes = 0, recognised = 0, passages = 0, closed = 0, wrong = 0;
};

Recall recall_of(const Run& run) {
  constexpr std::size_t kNeighbours = 20;
  Recall recall;
  std::set<KeyframeId> recognised;
  for (const Revisit& revisit : run.loops.revisits) recognised.insert(revisit.to);
  for (const PoseGraphEdge& edge : run.graph.edges) {
    if (edge.type == EdgeType::kLoopClosure && is_wrong_loop(edge, run.views)) ++recall.wrong;
  }
  bool in_passage = false, is_closed = false;
  for (std::size_t id = kNeighbours; id < run.views.size(); ++id) {
    const auto last = run.views.begin() + static_cast<std::ptrdiff_t>(id - kNeighbours);
    const bool revisits =
        std::any_of(run.views.begin(), last, [&](const View& v) { return is_revisit(v, run.views[id]); });
    if (revisits && !in_passage) {
      ++recall.passages;
      is_closed = false;
    }
    in_passage = revisits;
    if (!revisits) continue;
    ++recall.keyframes;
    if (!recognised.contains(id)) continue;
    ++recall.recognised;
    if (!is_closed) ++recall.closed;
    is_closed = true;
  }
  return recall;
}

std::string source_of(const TrackingResult& result) {
  if (!has_pose(result)) return result.state == TrackingState::kInitializing ? "before the first pose" : "lost";
  if (result.source == PoseSource::kVision) return "vision";
  return result.source == PoseSource::kSurfaces ? "surfaces" : "odometry";
}

// What slam says of a tour. The truth is brought into its map by the first frame with a pose, as the evaluator does: a
// robot that begins in front of a bare wall has moved before there is a map.
Run play(const simulator::SimulatorConfig& scene, const SlamConfig& config, const std::string& folder,
         bool with_odometry, time::Duration odometry_offset) {
  Run run;
  const geometry::Pose T_base_camera = geometry::T_base_camera(camera_mount(scene.robot.camera));
  RgbdSlam slam(config, T_base_camera, T_base_camera);
  std::optional<geometry::Pose> T_map_start;
  play_tour(scene, folder, [&](const TourFrame& tour_frame) {
    for (const auto& reading : tour_frame.odometry) {
      if (with_odometry) slam.add_odometry(reading.stamp + odometry_offset, pose_of(reading));
    }
    const double before_ms = cpu_ms();
    const TrackingResult result = slam.process(tour_frame.frame);
    run.milliseconds.push_back(cpu_ms() - before_ms);
    ++run.frames;
    ++run.frames_by_source[source_of(result)];
    const geometry::Pose T_map_camera = result.T_map_keyframe * result.T_keyframe_camera;
    const bool is_tracked = result.state == TrackingState::kTracking;
    if (is_tracked && !T_map_start) T_map_start = T_map_camera * tour_frame.T_start_camera.inverse();
    if (!T_map_start) return;
    const geometry::Pose T_map_true = *T_map_start * tour_frame.T_start_camera;
    run.truth[tour_frame.frame.stamp.nanoseconds] = T_map_true;
    if (result.is_keyframe) run.views.push_back(make_view(tour_frame.frame, T_map_true));
    if (!is_tracked) return;
    ++run.tracked;
    if (result.is_keyframe && run.tracked > 1) run.told.push_back({T_map_camera, T_map_true, result.map_covariance});
    run.online_errors_m.push_back((T_map_camera.translation() - T_map_true.translation()).norm());
    run.last = result;
    run.T_last_true = T_map_true;
  });
  slam.settle();
  run.graph = slam.pose_graph();
  run.loops = slam.loops();
  run.landmarks = slam.landmark_count();
  return run;
}

void print_loops(const Run& run) {
  for (const PoseGraphEdge& edge : run.graph.edges) {
    if (edge.type != EdgeType::kLoopClosure) continue;
    const geometry::Pose truth = run.views[edge.from].T_map_camera.inverse() * run.views[edge.to].T_map_camera;
    const geometry::Pose error = truth.inverse() * edge.T_from_to;
    const geometry::Matrix6d covariance = edge.information.inverse();
    std::printf(
        "  loop %4zu -> %4zu: %5.2f m, %5.1f deg apart; error %5.1f mm, %5.2f deg; sigma %5.1f mm, %5.2f deg; NEES "
        "%.2f\n",
        static_cast<std::size_t>(edge.from), static_cast<std::size_t>(edge.to), truth.translation().norm(),
        geometry::rotation_angle(truth.linear()) * 180.0 / M_PI, 1e3 * error.translation().norm(),
        geometry::rotation_angle(error.linear()) * 180.0 / M_PI,
        1e3 * std::sqrt(covariance.topLeftCorner<3, 3>().trace()),
        std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) * 180.0 / M_PI,
        nees(edge.T_from_to, truth, edge.information));
  }
}

void print_header() {
  std::printf("%-15s %4s %11s %7s | %6s %6s %6s %6s | %8s %8s %5s | %6s %6s %6s %6s | %5s %5s %6s | %5s %5s %6s\n",
              "scene", "seed", "tracked", "ms/frm", "online", "kf raw", "kf se3", "worst", "revisits", "passages",
              "wrong", "visual", "loop", "odom", "end", "edges", "loops", "odom", "kfs", "p95", "max");
}

void print_row(const std::string& scene, int seed, const Run& run) {
  std::vector<double> keyframe_errors_m;
  std::vector<Eigen::Vector3d> estimated, actual;
  for (const auto& node : run.graph.nodes) {
    estimated.emplace_back(node.T_map_camera.translation());
    actual.emplace_back(run.truth.at(node.stamp.nanoseconds).translation());
    keyframe_errors_m.push_back((estimated.back() - actual.back()).norm());
  }
  std::vector<double> aligned_m;
  if (!estimated.empty()) {
    const geometry::Pose T = evaluator::align_points(actual, estimated);
    for (std::size_t i = 0; i < actual.size(); ++i) aligned_m.push_back((actual[i] - T * estimated[i]).norm());
  }
  std::map<EdgeType, std::vector<double>> edges;
  std::map<std::uint64_t, geometry::Pose> truth;
  for (const auto& node : run.graph.nodes) truth[node.id] = run.truth.at(node.stamp.nanoseconds);
  for (const auto& edge : run.graph.edges) {
    edges[edge.type].push_back(nees(edge.T_from_to, truth[edge.from].inverse() * truth[edge.to], edge.information));
  }
  const double end =
      nees(run.last.T_map_keyframe * run.last.T_keyframe_camera, run.T_last_true, run.last.map_covariance.inverse());
  const Recall recall = recall_of(run);
  std::printf(
      "%-15s %4d %5d/%5d %7.1f | %6.1f %6.1f %6.1f %6.1f | %4zu/%3zu %4zu/%3zu %5zu | %6.2f %6.2f %6.2f %6.2f | %5zu "
      "%5zu %6zu | %5zu %5.1f "
      "%6.1f\n",
      scene.c_str(), seed, run.tracked, run.frames, quantile(run.milliseconds, 0.5), 100.0 * rms(run.online_errors_m),
      100.0 * rms(keyframe_errors_m), 100.0 * rms(aligned_m), 100.0 * quantile(keyframe_errors_m, 1.0),
      recall.recognised, recall.keyframes, recall.closed, recall.passages, recall.wrong,
      mean(edges[EdgeType::kOdometry]), mean(edges[EdgeType::kLoopClosure]), mean(edges[EdgeType::kWheelOdometry]), end,
      run.graph.edges.size(), edges[EdgeType::kLoopClosure].size(), edges[EdgeType::kWheelOdometry].size(),
      run.graph.nodes.size(), quantile(run.milliseconds, 0.95), quantile(run.milliseconds, 1.0));
  std::fflush(stdout);
}

EdgeHonesty honesty_of(const Run& run, const geometry::CameraMount& mount, const PoseGraphConfig& config) {
  EdgeHonesty honesty(T_base_camera(mount), config.min_information);
  honesty.add(run.graph, run.truth);
  for (const auto& [T_map_camera, truth, covariance] : run.told) honesty.add_pose(T_map_camera, truth, covariance);
  return honesty;
}

void print_sources(const std::map<std::string, int>& frames_by_source) {
  int all = 0;
  for (const auto& [source, frames] : frames_by_source) all += frames;
  std::printf("  frames");
  for (const auto& [source, frames] : frames_by_source) {
    std::printf(" | %s %d, %.2f %%", source.c_str(), frames, 100.0 * frames / all);
  }
  std::printf("\n");
}

// The final graph as g2o text, and where its key-frames truly were, in the same order.
void keep_graph(const std::filesystem::path& folder, const std::string& name, const Run& run) {
  std::ostringstream g2o;
  write_g2o(g2o, run.graph);
  files::replace_text(folder / (name + ".g2o"), g2o.str());
  trajectory::Trajectory truth;
  for (const auto& node : run.graph.nodes) truth.push_back({node.stamp, run.truth.at(node.stamp.nanoseconds)});
  trajectory::write_trajectory(folder / (name + "_truth.txt"), truth, "key-frames: camera optical frame in map, true");
}

void spoil(const Run& run, int seeds) {
  std::vector<Eigen::Vector3d> truth;
  for (const auto& node : run.graph.nodes) {
    truth.emplace_back(run.truth.at(node.stamp.nanoseconds).translation());
  }
  print_wrong_loop_trials(run.graph, truth, seeds);
}

// All runs together.
struct Pool {
  std::optional<EdgeHonesty> edges;
  std::map<std::string, int> frames_by_source;
};

void print_honesty(const Run& run, const EdgeHonesty& honesty, Pool& pool) {
  print_sources(run.frames_by_source);
  honesty.print("  ");
  if (!pool.edges) {
    pool.edges = honesty;
  } else {
    pool.edges->add(honesty);
  }
  for (const auto& [source, frames] : run.frames_by_source) pool.frames_by_source[source] += frames;
}

int run(const Options& options) {
  bool are_complete = true;
  Pool pool;
  if (!options.graphs.empty()) std::filesystem::create_directories(options.graphs);
  print_header();
  for (const std::string& scene : options.scenes) {
    for (const int seed : options.seeds) {
      auto [simulated, slam] = tour_config(options.overrides, options.worlds);
      simulated.scene = scene;
      simulated.seed = seed;
      try {
        const bool with_odometry = !options.no_odometry && simulated.wheels.odometry;
        const auto offset = time::Duration::from_seconds(options.odometry_offset_s);
        const Run tour = play(simulated, slam.method, options.folder, with_odometry, offset);
        print_row(scene, seed, tour);
        const auto mount = camera_mount(simulated.robot.camera);
        print_honesty(tour, honesty_of(tour, mount, slam.method.pose_graph), pool);
        if (!options.graphs.empty()) {
          const std::string name = std::filesystem::path(scene).stem().string() + "_" + std::to_string(seed);
          keep_graph(options.graphs, name, tour);
        }
        if (options.with_loops) print_loops(tour);
        if (options.wrong_loop_seeds > 0) spoil(tour, options.wrong_loop_seeds);
      } catch (const std::exception& error) {
        std::printf("%-15s %4d failed: %s\n", scene.c_str(), seed, error.what());
        are_complete = false;
      }
    }
  }
  std::printf("all runs\n");
  print_sources(pool.frames_by_source);
  if (pool.edges) pool.edges->print("  ");
  std::printf(
      "errors in cm (position, map frame, no alignment unless se3); visual, loop, odom, end: NEES per degree of "
      "freedom\nrevisits: key-frames that truly show an old place again, recognised of all; passages: rows of such, "
      "closed of "
      "all; wrong: loops\n");
  return are_complete ? 0 : 1;
}

constexpr const char* kHelp =
    R"(Tours of simulated scenes through slam, without DDS: a table of errors, honesty and time. Below each row and, of all
runs together, at the end: frames by what gave their pose, and NEES per degree of freedom of edges by what measured
them. Edges of surfaces leave directions open: an eigenvalue of an edge's information counts as a degree of freedom
when it is more than ten times slam.pose_graph.min_information. "wheels, in the plane" are x, y and the turn of
base_link alone, since a robot on a floor has no errors in the other directions.)";

}  // namespace
}  // namespace lapis::slam::benchmark

int main(int argc, char** argv) {
  using lapis::slam::benchmark::Options;
  CLI::App app(lapis::slam::benchmark::kHelp);
  Options options;
  app.add_option("--scenes", options.scenes, "bundled names or files")->delimiter(',');
  app.add_option("--seeds", options.seeds, "a run each")->delimiter(',');
  app.add_option("--world", options.worlds, "file of config/worlds: what wheels and camera are like")->delimiter(',');
  app.add_option("--set", options.overrides, "slam.KEY=VALUE, simulator.KEY=VALUE or robot.KEY=VALUE");
  app.add_option(
      "--recordings", options.folder,
      "keep the frames of tours here, 0.7 MB each, and read them the next time instead of rendering; they know "
      "the configuration, not the simulator: empty the folder when that changes");
  app.add_option("--graphs", options.graphs,
                 "folder for SCENE_SEED.g2o, the final graph, and SCENE_SEED_truth.txt, true poses of its key-frames");
  app.add_flag("--no-odometry", options.no_odometry, "slam gets no wheel odometry");
  app.add_option("--odometry-offset", options.odometry_offset_s,
                 "by which the clock that stamps wheel odometry is ahead of the camera's [s]");
  app.add_flag("--loops", options.with_loops, "also a row for each loop");
  app.add_option("--wrong-loops", options.wrong_loop_seeds,
                 "also rows for 10, 20 and 30 % wrong loops in the final graph, so many seeds each")
      ->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    return lapis::slam::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
