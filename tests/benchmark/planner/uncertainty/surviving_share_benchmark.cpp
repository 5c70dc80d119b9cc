// How much of a map survives slam's errors: predicted by the pose graph's marginals, and true. A row per snapshot.
//   lapis_surviving_share --scenes flat_10010,ring_10010 --world config/worlds/w.yaml --rows out/survival.csv
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "semantic_mapper/core/semantic_mapper.hpp"
#include "simulator/set_up.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/benchmark/planner/uncertainty/snapshot.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"

namespace lapis::planner::benchmark {
namespace {

using geometry::Pose;
using slam::benchmark::TourFrame;

constexpr int kFramesPerView = 3;  // of 15 Hz: what the mapper gets

struct Options {
  std::vector<std::string> scenes, worlds, overrides;
  std::string rows_file, edges_file;
  double longest_s = 300.0, period_s = 60.0;
  int seed = 1;
};

/// Ends a tour before its time.
struct Enough {};

/// slam and mapper on a tour, and a second map of the same frames at their true poses.
class Journey {
 public:
  Journey(const slam::SlamConfig& config, const Pose& T_base_camera)
      : slam_(config, T_base_camera, T_base_camera), mapper_(mapper_config()), true_map_(mapper_.map().resolution_m()) {
  }

  void take(const TourFrame& tour_frame, bool with_odometry) {
    if (with_odometry) {
      for (const auto& reading : tour_frame.odometry)
        slam_.add_odometry(reading.stamp, slam::benchmark::pose_of(reading));
    }
    const slam::TrackingResult result = slam_.process(tour_frame.frame);
    if (!slam::has_pose(result)) return;
    const Pose T_map_camera = result.T_map_keyframe * result.T_keyframe_camera;
    if (!T_map_start_) T_map_start_ = T_map_camera * tour_frame.T_start_camera.inverse();
    const Pose T_map_true = *T_map_start_ * tour_frame.T_start_camera;
    if (last_true_) path_m_ += (T_map_true.translation() - last_true_->translation()).norm();
    last_true_ = T_map_true;
    if (result.is_keyframe) truth_[result.keyframe_id] = T_map_true;
    follow_graph(result.graph_version);
    if (frames_++ % kFramesPerView == 0) map(tour_frame.frame, result, T_map_true);
  }

  double path_m() const { return path_m_; }

  Survival survival() {
    slam_.settle();
    follow_graph(slam_.graph_version());
    mapper_.flush();
    return survival_of(slam_.pose_graph(), truth_, mapper_.stakes()->stakes(), mapper_.map().resolution_m());
  }
  /// The edges of the final graph with their true errors, a line each (kEdgesHeader), in the plane of the floor.
  void write_edges(const std::string& key, std::ostream& out) const {
    const auto graph = slam_.pose_graph();
    std::map<std::uint64_t, std::size_t> index;
    for (const auto& node : graph.nodes) index.emplace(node.id, index.size());
    for (const auto& edge : graph.edges) {
      const Pose T_true = truth_.at(edge.from).inverse() * truth_.at(edge.to);
      const geometry::Vector6d error = geometry::se3_log(edge.T_from_to.inverse() * T_true);
      static constexpr int kAxes[] = {0, 2, 4};  // to the right, ahead, about the axis downwards
      out << key << ',' << name_of(edge.type) << ',' << index.at(edge.from) << ',' << index.at(edge.to) << ','
          << Eigen::AngleAxisd(T_true.linear()).angle();
      for (const int axis : kAxes) out << ',' << error(axis);
      for (const int row : kAxes) {
        for (const int column : kAxes) {
          if (column >= row) out << ',' << edge.information(row, column);
        }
      }
      out << '\n';
    }
  }
  double common() const { return common_share(mapper_.map(), true_map_); }
  std::size_t keyframes() const { return slam_.keyframe_count(); }
  std::size_t loops() const { return slam_.loops().closures; }

 private:
  static const char* name_of(slam::EdgeType type) {
    switch (type) {
      case slam::EdgeType::kLoopClosure: return "loop";
      case slam::EdgeType::kWheelOdometry: return "odometry";
      case slam::EdgeType::kSurface: return "surface";
      default: return "vision";
    }
  }
  static semantic_mapper::MapperConfig mapper_config() {
    semantic_mapper::MapperConfig config;
    config.stakes_model.emplace();
    return config;
  }

  void follow_graph(std::uint64_t version) {
    if (version <= mapper_.graph_version()) return;
    const auto graph = slam_.pose_graph();
    std::vector<semantic_mapper::KeyframePose> poses;
    for (const auto& node : graph.nodes) poses.push_back({node.id, node.T_map_camera, node.is_drifting});
    mapper_.update_keyframe_poses(graph.version, poses);
  }

  void map(const slam::RgbdFrame& frame, const slam::TrackingResult& result, const Pose& T_map_true) {
    std::string error;
    const auto samples = mapping::CompactFrame::make(frame.camera, frame.depth, nullptr, {}, error);
    if (!samples) throw std::runtime_error(error);
    true_map_.add(compute_votes(*samples, T_map_true, mapper_.config().integration, true_map_.resolution_m()));
    mapper_.integrate({frame.stamp,
                       result.keyframe_id,
                       result.T_map_keyframe,
                       result.T_keyframe_camera,
                       result.graph_version,
                       *samples,
                       {result.drift_m, result.drift_rad},
                       result.is_keyframe});
    mapper_.re_anchor(1'000'000);
  }

  slam::RgbdSlam slam_;
  semantic_mapper::SemanticMapper mapper_;
  mapping::VoxelMap true_map_;
  std::map<std::uint64_t, Pose> truth_;
  std::optional<Pose> T_map_start_, last_true_;
  double path_m_ = 0.0;
  int frames_ = 0;
};

constexpr const char* kEdgesHeader =
    "scene,world,seed,type,from,to,turn_rad,right_m,ahead_m,down_rad,i_rr,i_ra,i_rd,i_aa,i_ad,i_dd\n";
constexpr const char* kHeader =
    "scene,world,seed,t_s,keyframes,loops,path_m,voxels,actual,predicted,predicted_wide,common,ate_m,sigma_m";

/// Rows are kept for whole runs only.
class Rows {
 public:
  Rows(const std::string& file, std::string world) : world_(std::move(world)) {
    if (file.empty()) return;
    std::ifstream known(file);
    for (std::string line; std::getline(known, line);) done_.insert(line.substr(0, key_end(line)));
    const bool is_new = done_.empty();
    stream_.open(file, std::ios::app);
    if (!stream_) throw std::runtime_error(file + " cannot be written");
    if (is_new) stream_ << kHeader << std::endl;
  }
  /// A run that has rows is not repeated.
  bool has(const std::string& scene, int seed) const { return done_.contains(key(scene, seed)); }
  void add(const std::string& scene, int seed, double t_s, Journey& journey) {
    const Survival s = journey.survival();
    char text[256];
    std::snprintf(text, sizeof text, "%.0f,%zu,%zu,%.2f,%.1f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f", t_s, journey.keyframes(),
                  journey.loops(), journey.path_m(), s.voxels, s.actual, s.predicted, s.predicted_wide,
                  journey.common(), s.ate_m, s.sigma_m);
    waiting_ += key(scene, seed) + "," + text + "\n";
    std::printf("%s,%s\n", key(scene, seed).c_str(), text);
    std::fflush(stdout);
  }
  /// What was added since belongs to a run that is whole.
  void keep() {
    if (stream_.is_open()) stream_ << waiting_ << std::flush;
    waiting_.clear();
  }

  /// What was added belongs to a run that ended before its time.
  void forget() { waiting_.clear(); }

  std::string key(const std::string& scene, int seed) const {
    return scene + "," + world_ + "," + std::to_string(seed);
  }

 private:
  static std::size_t key_end(const std::string& line) {
    std::size_t end = 0;
    for (int i = 0; i < 3; ++i) end = line.find(',', end + (i > 0 ? 1 : 0));
    return end;
  }

  std::string world_, waiting_;
  std::set<std::string> done_;
  std::ofstream stream_;
};

void travel(const Options& options, const std::string& scene, Rows& rows) {
  slam::benchmark::TourConfig config = slam::benchmark::tour_config(options.overrides, options.worlds);
  auto& simulated = config.simulated;
  simulated.scene = scene;
  simulated.seed = options.seed;
  rows.forget();
  Journey journey(config.slam.method, geometry::T_base_camera(camera_mount(simulated.robot.camera)));
  double next_s = options.period_s, now_s = 0.0;
  try {
    slam::benchmark::play_tour(simulated, {}, [&](const TourFrame& frame) {
      now_s = frame.frame.stamp.seconds();
      if (now_s >= options.longest_s) throw Enough();
      journey.take(frame, simulated.wheels.odometry);
      if (now_s < next_s) return;
      next_s += options.period_s;
      rows.add(scene, options.seed, now_s, journey);
    });
  } catch (const Enough&) {
  }
  rows.add(scene, options.seed, now_s, journey);
  rows.keep();
  if (options.edges_file.empty()) return;
  const bool is_new = !std::filesystem::exists(options.edges_file);
  std::ofstream edges(options.edges_file, std::ios::app);
  if (is_new) edges << kEdgesHeader;
  journey.write_edges(rows.key(scene, options.seed), edges);
  if (!edges.flush()) throw std::runtime_error(options.edges_file + " cannot be written");
}

int run(const Options& options) {
  std::string world;
  for (const std::string& file : options.worlds) world += std::filesystem::path(file).stem().string();
  Rows rows(options.rows_file, world);
  std::printf("%s\n", kHeader);
  bool are_complete = true;
  for (const std::string& scene : options.scenes) {
    if (rows.has(scene, options.seed)) continue;
    try {
      travel(options, scene, rows);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", scene.c_str(), error.what());
      are_complete = false;
    }
  }
  return are_complete ? 0 : 1;
}

constexpr const char* kHelp =
    R"(Tours of simulated scenes through slam and mapper, without DDS. A row for every snapshot: how much of what the map
knows of surfaces is still in the voxels where it belongs. actual: by the true errors of the key-frames; predicted: by
the marginals of the pose graph; predicted_wide: with every sigma times 1.3; common: hits of occupied voxels that a map
of the same frames at their true poses has in the same voxel, too. ate_m: error of the key-frames' positions, not
aligned; sigma_m: the predicted one, along one axis of the plane. A snapshot waits for optimisations under way and
applies them, so that rows of other periods are those of other runs.)";

}  // namespace
}  // namespace lapis::planner::benchmark

int main(int argc, char** argv) {
  using lapis::planner::benchmark::Options;
  CLI::App app(lapis::planner::benchmark::kHelp);
  Options options;
  app.add_option("--scenes", options.scenes, "bundled names, generated buildings or files")->delimiter(',')->required();
  app.add_option("--world", options.worlds, "file of config/worlds: what wheels and camera are like")->delimiter(',');
  app.add_option("--set", options.overrides, "slam.KEY=VALUE, simulator.KEY=VALUE or robot.KEY=VALUE");
  app.add_option("--seed", options.seed, "of noise and start");
  app.add_option("--duration", options.longest_s, "of a run [s]")->check(CLI::Range(1.0, 1e5));
  app.add_option("--period", options.period_s, "between snapshots [s]")->check(CLI::Range(1.0, 1e5));
  app.add_option("--rows", options.rows_file, "CSV file to add the rows to; runs that it has are not repeated");
  app.add_option("--edges", options.edges_file,
                 "CSV file to add the edges of each final graph to, with their true errors (lapis_planner_trials)");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    return lapis::planner::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
