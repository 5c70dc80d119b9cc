#include "tests/benchmark/planner/exploration/exploration.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/mapping/file/map_description.hpp"
#include "common/mapping/votes/integration.hpp"
#include "controller/core/controller.hpp"
#include "planner/core/exploration/explorer.hpp"
#include "planner/core/space/path_planner.hpp"
#include "semantic_mapper/core/floor_plan.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
#include "simulator/core/robot/robot.hpp"
#include "simulator/core/truth/voxel_truth.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/planner/exploration/parts.hpp"

namespace lapis::planner::benchmark {
namespace {

using controller::PlanarPose;
using geometry::Pose;

constexpr int kTicksPerView = 3;       // of the camera's rate
constexpr double kTurnStep_rad = 0.6;  // as in decisions
// Of a path through known space: at its end, and the time after which it is left.
constexpr double kArrival_m = 0.4, kLongestWait_s = 10.0, kSlowest_m_s = 0.15;

controller::Grid to_grid(const semantic_mapper::OccupancyGrid& grid) {
  return {grid.resolution_m, {grid.origin_x_m, grid.origin_y_m}, grid.width, grid.height, grid.cells};
}

/// One exploration as it goes on. The map frame is base_link at the start.
class Course {
 public:
  Course(const simulator::World& world, const ExplorationSetting& setting)
      : world_(world), setting_(setting), start_(simulator::start_pose(world, setting.simulated)),
        T_map_world_(simulator::T_map_world(planar(start_.position, start_.yaw_rad, world.scene().floor_z_m))),
        camera_(robot::pinhole_camera(setting.simulated.robot.camera)),
        T_base_camera_(geometry::T_base_camera(robot::camera_mount(setting.simulated.robot.camera))),
        robot_(world.nav_map(), simulator::simulation_config(setting.simulated).robot, at_rest(start_)),
        explorable_(world, T_map_world_.inverse(), setting.simulated.robot), map_(mapping::kDefaultResolution_m),
        reader_(model_), band_(setting.planner.surroundings.grid.band), plan_(band_),
        obstacles_({}, band_, mapping::kDefaultResolution_m), view_(view_config(setting.planner)),
        surroundings_(setting.planner.surroundings, model_, mapping::kDefaultResolution_m),
        explorer_(setting.planner.explorer), ledger_(setting.planner.explorer.memory.radius_m),
        controller_(setting.controller.method, controller::limits_of(setting.simulated.robot)) {}

  Exploration run() {
    explorer_.start();
    bool is_over = false;
    while (!is_over) {
      const auto state = explorer_.state();
      is_over = now().seconds() >= setting_.longest_s || state == State::kDone || state == State::kGaveUp ||
                state == State::kFailed;
      step();
      if (is_over || tick_ % std::lround(setting_.simulated.robot.camera.rate_hz) == 0) note_moment();
    }
    note_choice(nullptr);
    exploration_.state = explorer_.state();
    for (const Candidate& candidate : decision_.candidates) note_left(candidate);
    explorer_.stop();
    follow();
    for (int i = 0; i < setting_.known_places; ++i) drive_through_known(static_cast<std::uint64_t>(i));
    return std::move(exploration_);
  }

 private:
  time::Time now() const { return robot_.state().stamp; }

  Pose2 pose() const {
    const Pose T = T_map_world_ * T_world_base();
    return {T.translation().head<2>(), std::atan2(T.linear()(1, 0), T.linear()(0, 0))};
  }

  Pose T_world_base() const {
    return planar(robot_.state().position, robot_.state().yaw_rad, world_.scene().floor_z_m);
  }

  // The order in which the processes answer a frame.
  void step() {
    const Pose2 here = pose();
    controller_.note_camera(now(), now());
    controller_.set_pose(controller::planar_pose(here.p_map, here.yaw_rad), now(), now());
    if (tick_ % kTicksPerView == 0) see();
    plan(here);
    follow();
    drive();
  }

  void see() {
    const auto seen = world_.renderer().render(camera_, T_world_base() * T_base_camera_, false);
    std::string error;
    const auto frame = mapping::CompactFrame::make(camera_, seen.depth, &seen.labels, {}, error);
    if (!frame) throw std::runtime_error(error);
    const Pose T_map_camera = T_map_world_ * T_world_base() * T_base_camera_;
    const auto votes = compute_votes(*frame, T_map_camera, {}, map_.resolution_m());
    map_.add(votes);
    obstacles_.add(now(), votes);
    std::vector<mapping::BlockIndex> blocks;
    for (const mapping::BlockVotes& block : votes.blocks) blocks.push_back(block.block);
    plan_.mark_changed(blocks);
    changed_.insert(changed_.end(), blocks.begin(), blocks.end());
    controller_.see({seen.depth, camera_, T_base_camera_}, now(), now());
    controller_.set_plan(to_grid(plan_.project(map_, reader_)));
    controller_.set_obstacles(to_grid(obstacles_.grid()), now(), now());
  }

  void plan(const Pose2& here) {
    const Report report{now(), here, Tracking::kTracking, is_blocked_, 0.0};
    if (due_ && tick_ >= *due_) {
      const bool is_taken = explorer_.take(decision_, report);
      note_choice(is_taken && decision_.chosen ? &decision_ : nullptr);
      due_.reset();
    }
    if (due_) return;
    surroundings_.update_map(map_, std::exchange(changed_, {}));
    surroundings_.update_obstacles(to_obstacles(obstacles_.grid()), now());
    if (!explorer_.step(report, &surroundings_)) return;
    const double before_s = cpu_s();
    decision_ = decide(situation(here), explorer_.memory(now()), setting_.planner.decision);
    exploration_.decision_cpu_s += cpu_s() - before_s;
    ++exploration_.decisions;
    due_ = tick_ + setting_.planner.decision_latency_frames;
  }

  void note_choice(const Decision* driven) {
    const auto ended = ledger_.note(driven, {surroundings_.information_nats()}, pose(), now());
    if (ended) exploration_.paths.push_back(*ended);
  }

  void follow() {
    controller_.note_planner(now());
    if (explorer_.path_number() == followed_) return;
    followed_ = explorer_.path_number();
    if (explorer_.is_turn()) throw std::runtime_error("the planner looks for a pose that it has");
    follow(explorer_.path());
  }

  void follow(const std::vector<Pose2>& poses) {
    std::vector<PlanarPose> path;
    for (const Pose2& p : poses) path.push_back(controller::planar_pose(p.p_map, p.yaw_rad));
    controller_.set_path(std::move(path), "the planner's path is empty");
  }

  /// To a place that is drawn and back, twice.
  void drive_through_known(std::uint64_t draw) {
    const PlanningGrid& grid = surroundings_.grid();
    const Cell start = grid.cell_of(pose().p_map);
    const CostTree tree = cost_tree();
    const Cell place = tree.reached()[mapping::mix_bits(draw) % tree.reached().size()];
    for (auto* paths : {&exploration_.known_paths, &exploration_.driven_paths}) {
      for (const Cell goal : {place, start}) {
        const auto path = drive_to(goal);
        if (path) paths->push_back(*path);
      }
    }
  }

  CostTree cost_tree() {
    surroundings_.update_map(map_, std::exchange(changed_, {}));
    const PlanningGrid& grid = surroundings_.grid();
    return grow_cost_tree(grid, setting_.planner.decision.path, {grid.cell_of(pose().p_map)});
  }

  /// Nothing when the robot is there, no path leads there any more, or it does not get there.
  std::optional<DrivenPath> drive_to(Cell goal) {
    const CostTree tree = cost_tree();
    const Pose2 here = pose();
    const PlanningGrid& grid = surroundings_.grid();
    const DecisionConfig& config = setting_.planner.decision;
    std::vector<Eigen::Vector2d> points = points_of(grid, straightened(grid, config.path, tree.path_to(goal)));
    if (points.size() < 2) return std::nullopt;
    points.front() = here.p_map;
    const Eigen::Vector2d last = points.back() - points[points.size() - 2];
    const double yaw_rad = std::atan2(last.y(), last.x());
    DrivenPath path;
    path.begin = now();
    path.cost_m = *tree.cost_m(goal);
    std::vector<Pose2> views =
        with_turns(poses_along(points, config.view_spacing_m, yaw_rad), here.yaw_rad, kTurnStep_rad);
    views.insert(views.begin(), here);
    path.promised_nats = path.driven_nats = promise(views);
    const double before_nats = surroundings_.information_nats();
    follow(poses_along(points, setting_.planner.explorer.path_spacing_m, yaw_rad));
    const double longest_s = kLongestWait_s + path.cost_m / kSlowest_m_s;
    while ((pose().p_map - points.back()).norm() > kArrival_m) {
      if (is_blocked_ || (now() - path.begin).seconds() > longest_s) return std::nullopt;
      step();
    }
    path.end = now();
    surroundings_.update_map(map_, std::exchange(changed_, {}));
    path.gained_nats = surroundings_.information_nats() - before_nats;
    return path;
  }

  double promise(const std::vector<Pose2>& path) const {
    ViewPath views;
    for (const Pose2& p : path) views.push_back(camera_at(situation(p), p));
    return path_information(surroundings_.field(), view_, views);
  }

  Situation situation(const Pose2& here) const {
    return {surroundings_.grid(),
            surroundings_.frontiers(),
            surroundings_.field(),
            view_,
            T_base_camera_,
            nullptr,
            nullptr,
            here};
  }

  void drive() {
    const controller::Decision decision = controller_.step(now());
    is_blocked_ = decision.state == controller::State::kBlocked;
    if (!robot_.command({decision.command.forward_m_s, decision.command.turn_rad_s}))
      throw std::runtime_error("a command is not finite");
    const time::Time stamp{std::llround(static_cast<double>(++tick_) * 1e9 / setting_.simulated.robot.camera.rate_hz)};
    const simulator::Motion motion = robot_.advance(stamp);
    exploration_.path_m += std::abs(motion.distance_m);
    if (motion.is_in_contact && !was_in_contact_) exploration_.contacts.push_back(moment());
    was_in_contact_ = motion.is_in_contact;
  }

  ExplorationMoment moment() const {
    return {now().seconds(), pose(), explorable_.share_known(map_), explorer_.reason()};
  }

  void note_moment() { exploration_.moments.push_back(moment()); }

  void note_left(const Candidate& candidate) {
    const auto& frontiers = surroundings_.frontiers().frontiers();
    const auto found = frontiers.find(candidate.frontier);
    if (found == frontiers.end() || candidate.is_open()) return;
    exploration_.left_m[text_of(candidate.rejection)] += found->second.length_m;
  }

  const simulator::World& world_;
  const ExplorationSetting& setting_;
  const simulator::StartPose start_;
  const Pose T_map_world_;
  const geometry::PinholeCamera camera_;
  const Pose T_base_camera_;
  simulator::Robot robot_;
  const Explorable explorable_;
  mapping::VoxelMap map_;
  const mapping::SensorModel model_;
  const mapping::BeliefReader reader_;
  const mapping::HeightBand band_;
  semantic_mapper::FloorPlan plan_;
  semantic_mapper::ObstacleLayer obstacles_;
  const View view_;
  Surroundings surroundings_;
  Explorer explorer_;
  PathLedger ledger_;
  controller::Controller controller_;
  std::int64_t tick_ = 0;
  std::vector<mapping::BlockIndex> changed_;  // since the planner looked
  Decision decision_;
  std::optional<std::int64_t> due_;  // tick at which the decision takes effect
  std::optional<std::uint64_t> followed_;
  bool is_blocked_ = false, was_in_contact_ = false;
  Exploration exploration_;
};

}  // namespace

double Exploration::time_to_s(double share) const {
  for (const ExplorationMoment& moment : moments) {
    if (moment.explored_share >= share) return moment.t_s;
  }
  return std::numeric_limits<double>::infinity();
}

Exploration explore(const simulator::World& world, const ExplorationSetting& setting) {
  return Course(world, setting).run();
}

}  // namespace lapis::planner::benchmark
