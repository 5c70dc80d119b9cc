#include "tests/benchmark/planner/trials/trial.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "planner/core/exploration/explorer.hpp"
#include "planner/core/hallucination/analysed_graph.hpp"
#include "planner/core/uncertainty/map_worth.hpp"
#include "planner/core/uncertainty/surviving_share.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "simulator/core/robot/robot.hpp"
#include "simulator/core/truth/voxel_truth.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/planner/exploration/parts.hpp"

namespace lapis::planner::benchmark {
namespace {

using geometry::Pose;

constexpr int kTicksPerView = 5;  // of the camera's rate
constexpr double kSpeed_m_s = 0.45, kTurnRate_rad_s = 0.7, kAhead_m = 0.4, kFacing_rad = 0.5;
constexpr double kLandmark_m = 0.15;
constexpr int kLandmarkStep_px = 14;
constexpr double kLandmarkRange_m = 5.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

semantic_mapper::MapperConfig mapper_config() {
  semantic_mapper::MapperConfig config;
  config.stakes_model.emplace();
  return config;
}

/// What the key-frames have seen: points on surfaces, by cells of the true map.
class Landmarks {
 public:
  void see(std::uint64_t keyframe, const Pose& T_map_true, const geometry::PinholeCamera& camera,
           const geometry::DepthImage& depth) {
    for (int row = kLandmarkStep_px / 2; row < depth.height; row += kLandmarkStep_px) {
      for (int column = kLandmarkStep_px / 2; column < depth.width; column += kLandmarkStep_px) {
        const auto z = static_cast<double>(depth(column, row));
        if (!(z > 0.0 && z < kLandmarkRange_m)) continue;
        const Eigen::Vector3d p_camera = camera.unproject(column, row, z);
        const Eigen::Vector3d cell = (T_map_true * p_camera / kLandmark_m).array().floor();
        const std::array<int, 3> key{static_cast<int>(cell.x()), static_cast<int>(cell.y()),
                                     static_cast<int>(cell.z())};
        Landmark& landmark = landmarks_.try_emplace(key, Landmark{keyframe, p_camera, {}}).first->second;
        if (landmark.observers.empty() || landmark.observers.back() != keyframe)
          landmark.observers.push_back(static_cast<std::uint32_t>(keyframe));
      }
    }
  }

  std::map<mapping::TileIndex, mapping::LandmarkTile> tiles(const slam::PoseGraphSnapshot& graph) const {
    mapping::LandmarkTile tile;
    std::uint32_t id = 0;
    for (const auto& [key, landmark] : landmarks_) {
      tile.ids.push_back(id++);
      tile.positions_m.emplace_back((graph.nodes[landmark.keyframe].T_map_camera * landmark.p_camera).cast<float>());
      tile.observers.insert(tile.observers.end(), landmark.observers.begin(), landmark.observers.end());
      tile.observer_ends.push_back(static_cast<std::uint32_t>(tile.observers.size()));
    }
    return {{tile.index, tile}};
  }

 private:
  struct Landmark {
    std::uint64_t keyframe;  // by which its position is known
    Eigen::Vector3d p_camera;
    std::vector<std::uint32_t> observers;
  };
  std::map<std::array<int, 3>, Landmark> landmarks_;
};

class Mission {
 public:
  Mission(const simulator::World& world, const TrialSetting& setting, const ErrorModel& errors)
      : world_(world), setting_(setting), start_(simulator::start_pose(world, setting.simulated)),
        T_map_world_(simulator::T_map_world(planar(start_.position, start_.yaw_rad, world.scene().floor_z_m))),
        camera_(robot::pinhole_camera(setting.simulated.robot.camera)),
        T_base_camera_(geometry::T_base_camera(robot::camera_mount(setting.simulated.robot.camera))),
        robot_(world.nav_map(), simulator::simulation_config(setting.simulated).robot, at_rest(start_)),
        poses_(errors, setting.simulated.scene, static_cast<std::uint64_t>(setting.simulated.seed)),
        mapper_(mapper_config()), true_map_(mapping::kDefaultResolution_m),
        obstacles_({}, setting.planner.surroundings.grid.band, mapping::kDefaultResolution_m),
        view_(view_config(setting.planner)),
        surroundings_(setting.planner.surroundings, mapping::SensorModel{}, mapping::kDefaultResolution_m),
        explorer_(setting.planner.explorer), explorable_(world, T_map_world_.inverse(), setting.simulated.robot) {}

  TrialResult run() {
    const double before_s = cpu_s();
    explorer_.start();
    while (now().seconds() < setting_.longest_s && !is_over()) {
      see();
      plan();
      drive();
    }
    result_.cpu_s = cpu_s() - before_s;
    return conclude();
  }

 private:
  time::Time now() const { return robot_.state().stamp; }
  bool is_over() const {
    return explorer_.state() == State::kFailed ||
           (setting_.planner.consolidation == nullptr &&
            (explorer_.state() == State::kDone || explorer_.state() == State::kGaveUp));
  }
  Pose T_map_camera_true() const {
    return T_map_world_ * planar(robot_.state().position, robot_.state().yaw_rad, world_.scene().floor_z_m) *
           T_base_camera_;
  }
  /// Where slam believes the robot to be.
  Pose2 pose() const {
    const Pose T = poses_.estimate(T_map_camera_true()) * T_base_camera_.inverse();
    return {T.translation().head<2>(), std::atan2(T.linear()(1, 0), T.linear()(0, 0))};
  }

  void see() {
    const Pose T_true = T_map_camera_true();
    const bool is_keyframe = poses_.arrive(T_true);
    const bool is_view = tick_ % kTicksPerView == 0;
    if (!is_keyframe && !is_view) return;
    follow_graph();
    const auto seen = world_.renderer().render(camera_, T_map_world_.inverse() * T_true, false);
    if (is_keyframe) landmarks_.see(poses_.newest(), T_true, camera_, seen.depth);
    if (!is_view) return;
    std::string error;
    const auto frame = mapping::CompactFrame::make(camera_, seen.depth, &seen.labels, {}, error);
    if (!frame) throw std::runtime_error(error);
    true_map_.add(compute_votes(*frame, T_true, {}, true_map_.resolution_m()));
    const Pose& T_keyframe = poses_.graph().nodes.back().T_map_camera;
    const auto report = mapper_.integrate({now(),
                                           poses_.newest(),
                                           T_keyframe,
                                           poses_.truth().back().inverse() * T_true,
                                           poses_.graph().version,
                                           *frame,
                                           {},
                                           false});
    obstacles_.add(now(), report.votes);
    mapper_.re_anchor(1'000'000);
  }

  void follow_graph() {
    std::vector<semantic_mapper::KeyframePose> poses;
    for (const auto& node : poses_.graph().nodes) poses.push_back({node.id, node.T_map_camera, false});
    mapper_.update_keyframe_poses(poses_.graph().version, poses);
  }

  void plan() {
    const Pose2 here = pose();
    const Report report{now(), here, Tracking::kTracking, is_blocked_, 0.0};
    if (due_ && tick_ >= *due_) {
      explorer_.take(decision_, report);
      due_.reset();
    }
    if (due_) return;
    const auto changed = mapper_.changed_blocks();
    mapper_.take_changed_tiles();
    surroundings_.update_map(mapper_.map(), changed);
    surroundings_.update_obstacles(to_obstacles(obstacles_.grid()), now());
    if (!explorer_.step(report, &surroundings_)) return;
    if (promise_) settle(*promise_);
    const double before_s = cpu_s();
    decide_at(here);
    result_.decision_cpu_s += cpu_s() - before_s;
    if (setting_.with_gains) note_promise();
    ++result_.decisions;
    if (decision_.chosen && decision_.candidates[*decision_.chosen].kind == CandidateKind::kRevisit) ++result_.revisits;
    if (explorer_.state() == State::kConsolidating && result_.done_s == 0.0) result_.done_s = now().seconds();
    due_ = tick_ + setting_.planner.decision_latency_frames;
  }

  /// What the newest decision promises, and what the map is worth when it is taken.
  struct Promise {
    Gain gain;
    SurfaceStakes stakes;
  };

  void note_promise() {
    promise_.reset();
    if (!decision_.chosen || poses_.graph().nodes.size() < 2) return;
    const Candidate& chosen = decision_.candidates[*decision_.chosen];
    Promise promise{{}, stakes()};
    promise.gain.time_s = now().seconds();
    promise.gain.path_m = -result_.path_m;
    promise.gain.loops = -poses_.loops();
    promise.gain.is_revisit = chosen.kind == CandidateKind::kRevisit;
    promise.gain.promised_nats = chosen.value.secured_nats;
    promise.gain.map_nats = worth_config().voxel_nats * voxels_of(promise.stakes);
    promise.gain.by_graph_nats = -nats_by_graph(promise.stakes);
    promise.gain.true_nats = -worth_config().voxel_nats * surviving_voxels(promise.stakes);
    promise_ = std::move(promise);
  }

  void settle(const Promise& promise) {
    Gain& gain = result_.gains.emplace_back(promise.gain);
    gain.path_m += result_.path_m;
    gain.loops += poses_.loops();
    gain.by_graph_nats += nats_by_graph(promise.stakes);
    gain.true_nats += worth_config().voxel_nats * surviving_voxels(promise.stakes);
  }

  double nats_by_graph(const SurfaceStakes& stakes) const {
    const auto worth = MapWorth::make(keyframes_of(poses_.graph()), edges_of(poses_.graph()), stakes, worth_config());
    return std::get<MapWorth>(worth).nats();
  }

  static double voxels_of(const SurfaceStakes& stakes) {
    double voxels = 0.0;
    for (const auto& [keyframe, stake] : stakes.voxels) voxels += std::reduce(stake.begin(), stake.end());
    return voxels;
  }

  /// Voxels that keep their evidence, by the true errors of the key-frames.
  double surviving_voxels(const SurfaceStakes& stakes) const {
    double voxels = 0.0;
    for (const auto& [keyframe, stake] : stakes.voxels) {
      const Pose& T = poses_.graph().nodes[keyframe].T_map_camera;
      const Pose& T_true = poses_.truth()[keyframe];
      for (std::size_t bin = 0; bin < stake.size(); ++bin) {
        const double range_m = (static_cast<double>(bin) + 0.5) * stakes.bin_m;
        const auto surface = [range_m](const Pose& at) -> Eigen::Vector2d {
          return at.translation().head<2>() + range_m * at.linear().col(2).head<2>().normalized();
        };
        voxels += stake[bin] * surviving_share_of(surface(T) - surface(T_true), mapping::kDefaultResolution_m);
      }
    }
    return voxels;
  }

  static std::vector<Keyframe> keyframes_of(const slam::PoseGraphSnapshot& graph) {
    std::vector<Keyframe> keyframes;
    for (const auto& node : graph.nodes) keyframes.push_back({node.id, node.T_map_camera});
    return keyframes;
  }
  static std::vector<KeyframeEdge> edges_of(const slam::PoseGraphSnapshot& graph) {
    std::vector<KeyframeEdge> edges;
    for (const auto& edge : graph.edges)
      edges.push_back({edge.from, edge.to, edge.information, edge.type == slam::EdgeType::kLoopClosure});
    return edges;
  }

  /// What a decision may need to know of the pose graph.
  struct Known {
    std::optional<AnalysedGraph> graph;
    std::optional<LandmarkIndex> landmarks;
    std::optional<MapWorth> worth;
  };

  Known known_for(const DecisionConfig& config) {
    Known known;
    const Asks asks = config.method->asks();
    if (!asks.spectrum && !asks.map_worth && !config.method->has_own_candidates()) return known;
    const std::vector<Keyframe> keyframes = keyframes_of(poses_.graph());
    const std::vector<KeyframeEdge> edges = edges_of(poses_.graph());
    auto graph = analyse_graph(keyframes, edges, config.graph);
    if (std::holds_alternative<GraphError>(graph)) return known;  // as long as there is one key-frame
    known.graph.emplace(std::get<AnalysedGraph>(std::move(graph)));
    known.landmarks.emplace(landmarks_.tiles(poses_.graph()), *known.graph, mapping::kDefaultResolution_m);
    if (!asks.map_worth) return known;
    auto worth = MapWorth::make(keyframes, edges, stakes(), worth_config());
    if (auto* made = std::get_if<MapWorth>(&worth)) known.worth.emplace(std::move(*made));
    return known;
  }

  void decide_at(const Pose2& here) {
    DecisionConfig config = setting_.planner.decision;
    if (explorer_.state() == State::kConsolidating) config.method = setting_.planner.consolidation;
    const Known known = known_for(config);
    const Situation situation{surroundings_.grid(),
                              surroundings_.frontiers(),
                              surroundings_.field(),
                              view_,
                              T_base_camera_,
                              known.graph ? &*known.graph : nullptr,
                              known.landmarks ? &*known.landmarks : nullptr,
                              here,
                              {},
                              known.worth ? &*known.worth : nullptr};
    decision_ = decide(situation, explorer_.memory(now()), config);
  }

  MapWorthConfig worth_config() const {
    MapWorthConfig config;
    config.voxel_m = mapping::kDefaultResolution_m;
    config.voxel_nats = surroundings_.field().cell({1'000'000, 1'000'000, 1'000'000}).gain;  // never observed
    return config;
  }

  SurfaceStakes stakes() {
    SurfaceStakes out;
    out.bin_m = semantic_mapper::kStakeBin_m;
    for (const auto& [keyframe, stake] : mapper_.stakes()->stakes()) {
      std::vector<double>& voxels = out.voxels[keyframe];
      for (const std::int64_t value : stake)
        voxels.push_back(static_cast<double>(value) / static_cast<double>(semantic_mapper::kOneVoxel));
    }
    return out;
  }

  /// Turns towards a point a little ahead on the path, and drives when it faces it.
  void drive() {
    const Pose2 here = pose();
    const std::vector<Pose2>& path = explorer_.path();
    simulator::DriveCommand command;
    if (explorer_.path_number() != followed_) {
      followed_ = explorer_.path_number();
      next_ = 0;
    }
    while (next_ + 1 < path.size() && (path[next_].p_map - here.p_map).norm() < kAhead_m) ++next_;
    if (!path.empty()) {
      const Eigen::Vector2d ahead = path[next_].p_map - here.p_map;
      const bool is_there = next_ + 1 == path.size() && ahead.norm() < 0.12;
      const double wanted = is_there ? path.back().yaw_rad : std::atan2(ahead.y(), ahead.x());
      const double off = wrapped(wanted - here.yaw_rad);
      command.turn_rate_rad_s = std::clamp(2.0 * off, -kTurnRate_rad_s, kTurnRate_rad_s);
      if (!is_there && std::abs(off) < kFacing_rad) command.speed_m_s = std::min(kSpeed_m_s, 1.5 * ahead.norm());
    }
    if (touching_ticks_ > 15) command = {-0.15, 0.0};  // backs up
    if (!robot_.command(command)) throw std::runtime_error("a command is not finite");
    const time::Time stamp{std::llround(static_cast<double>(++tick_) * 1e9 / setting_.simulated.robot.camera.rate_hz)};
    const simulator::Motion motion = robot_.advance(stamp);
    result_.path_m += std::abs(motion.distance_m);
    touching_ticks_ = motion.is_in_contact ? touching_ticks_ + 1 : std::max(0, touching_ticks_ - 1);
    is_blocked_ = touching_ticks_ > 15;
    if (tick_ % 15 == 0 && result_.time_to_90_s == 0.0 && explored() >= 0.9) result_.time_to_90_s = now().seconds();
  }

  double explored() const { return explorable_.share_known(true_map_); }

  TrialResult conclude() {
    follow_graph();
    mapper_.flush();
    result_.explored_share = explored();
    if (result_.done_s == 0.0) result_.done_s = now().seconds();
    std::tie(result_.ate_se3_m, result_.ate_raw_m) = poses_.ate_m();
    result_.keyframes = static_cast<int>(poses_.truth().size());
    result_.loops = poses_.loops();
    const SurfaceStakes all = stakes();
    const double voxels = voxels_of(all);
    result_.surviving_share = voxels > 0.0 ? surviving_voxels(all) / voxels : 0.0;
    MapWorthConfig unit;  // a voxel counts 1
    const auto made = MapWorth::make(keyframes_of(poses_.graph()), edges_of(poses_.graph()), all, unit);
    if (const auto* worth = std::get_if<MapWorth>(&made); worth != nullptr && voxels > 0.0)
      result_.predicted_share = worth->nats() / voxels;
    return result_;
  }

  const simulator::World& world_;
  const TrialSetting& setting_;
  const simulator::StartPose start_;
  const Pose T_map_world_;
  const geometry::PinholeCamera camera_;
  const Pose T_base_camera_;
  simulator::Robot robot_;
  PoseModel poses_;
  semantic_mapper::SemanticMapper mapper_;
  mapping::VoxelMap true_map_;  // the same frames at their true poses
  semantic_mapper::ObstacleLayer obstacles_;
  const View view_;
  Surroundings surroundings_;
  Explorer explorer_;
  Landmarks landmarks_;
  const Explorable explorable_;
  std::int64_t tick_ = 0;
  Decision decision_;
  std::optional<Promise> promise_;
  std::optional<std::int64_t> due_;  // tick at which the decision takes effect
  std::optional<std::uint64_t> followed_;
  std::size_t next_ = 0;
  int touching_ticks_ = 0;
  bool is_blocked_ = false;
  TrialResult result_;
};

}  // namespace

TrialResult run_trial(const simulator::World& world, const TrialSetting& setting, const ErrorModel& errors) {
  return Mission(world, setting, errors).run();
}

}  // namespace lapis::planner::benchmark
