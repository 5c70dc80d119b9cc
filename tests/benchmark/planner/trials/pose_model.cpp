#include "tests/benchmark/planner/trials/pose_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "slam/core/graph/graph_correction.hpp"

namespace lapis::planner::benchmark {
namespace {

using geometry::Pose;

constexpr double kKeyframe_m = 0.16;  // path_between of neighbouring key-frames in recorded tours
constexpr double kMetresPerRadian = 0.5;
constexpr double kSimilarTurn_rad = 0.05;  // links with turns within this are alike
// As slam's loop detector (slam.loop): what is near, how soon another key-frame has to find the same, and the path
// between pairs of loops.
constexpr double kNear_m = 1.5, kNear_rad = 0.7;
constexpr std::size_t kConfirmWithin = 3;
constexpr double kLoopSpacing_m = 5.0;
constexpr double kLeastLoop_m = 5.0;  // path between the two ends of a loop
constexpr double kVerified = 0.9;     // share of the key-frames near an old one that slam recognises
constexpr double kStiff = 1e8;        // information of the directions that the floor fixes

double turn_of(const Pose& T) { return Eigen::AngleAxisd(T.linear()).angle(); }
double length_of(const Pose& T) { return T.translation().norm() + kMetresPerRadian * turn_of(T); }

Pose planar_exp(const Eigen::Vector3d& error) {
  geometry::Vector6d xi = geometry::Vector6d::Zero();
  xi << error.x(), 0.0, error.y(), 0.0, error.z(), 0.0;
  return geometry::se3_exp(xi);
}

geometry::Matrix6d in_space(const Eigen::Matrix3d& planar) {
  static constexpr int kAxes[] = {0, 2, 4};
  geometry::Matrix6d information = geometry::Matrix6d::Zero();
  information.diagonal() << 0, kStiff, 0, kStiff, 0, kStiff;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) information(kAxes[i], kAxes[j]) = planar(i, j);
  }
  return information;
}

std::string kind_of(const std::string& scene) { return scene.substr(0, scene.rfind('_')); }

std::uint64_t seed_of(const std::string& scene, std::uint64_t seed) {
  std::seed_seq sequence(scene.begin(), scene.end());
  std::array<std::uint32_t, 1> number{};
  sequence.generate(number.begin(), number.end());
  return seed << 32U | number[0];
}

/// The runs of buildings of the same kind; all runs if there are none.
std::vector<const RunRecord*> runs_like(const ErrorModel& model, const std::string& scene) {
  std::vector<const RunRecord*> alike, all;
  for (const RunRecord& run : model.runs) {
    all.push_back(&run);
    if (kind_of(run.scene) == kind_of(scene)) alike.push_back(&run);
  }
  return alike.empty() ? all : alike;
}

const RunRecord& draw_run(const ErrorModel& model, const std::string& scene, std::mt19937_64& random) {
  const auto runs = runs_like(model, scene);
  return *runs[std::uniform_int_distribution<std::size_t>(0, runs.size() - 1)(random)];
}

/// The loops of the runs of buildings of the same kind; those of all runs if there are none.
std::vector<EdgeRecord> loops_of(const ErrorModel& model, const std::string& scene) {
  std::vector<EdgeRecord> loops, all;
  for (const RunRecord& run : model.runs) {
    auto& into = kind_of(run.scene) == kind_of(scene) ? loops : all;
    into.insert(into.end(), run.loops.begin(), run.loops.end() - std::ssize(run.loops) % 2);  // pairs
  }
  return loops.empty() ? all : loops;
}

EdgeRecord record_of(std::istringstream& cells) {
  const auto next = [&] {
    std::string cell;
    if (!std::getline(cells, cell, ',')) throw std::invalid_argument("cut off");
    return std::stod(cell);
  };
  EdgeRecord record;
  for (int i = 0; i < 3; ++i) record.error(i) = next();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) record.information(i, j) = record.information(j, i) = next();
  }
  return record;
}

/// By run: scene, world, seed.
struct Records {
  std::map<std::string, std::map<int, LinkRecord>> links;  // by the index of their end
  std::map<std::string, std::vector<EdgeRecord>> loops;

  void take(const std::string& line) {
    std::istringstream cells(line);
    std::string key, world, seed, type, from, to, turn;
    for (std::string* cell : {&key, &world, &seed, &type, &from, &to, &turn}) std::getline(cells, *cell, ',');
    const EdgeRecord record = record_of(cells);
    for (const std::string& cell : {world, seed}) key.append(",").append(cell);
    if (type == "loop") {
      loops[key].push_back(record);
    } else if (std::stoi(to) == std::stoi(from) + 1) {
      LinkRecord& link = links[key][std::stoi(to)];
      link.turn_rad = std::stod(turn);
      (type == "odometry" ? link.odometry : link.vision) = record;
    }
  }
};

}  // namespace

ErrorModel ErrorModel::read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + " cannot be read");
  Records records;
  std::string line;
  std::getline(in, line);
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      records.take(line);
    } catch (const std::logic_error&) {  // std::stod, std::stoi
      throw std::runtime_error(file + ":" + std::to_string(number) + ": not a line of lapis_surviving_share --edges");
    }
  }
  ErrorModel model;
  for (auto& [name, links] : records.links) {
    RunRecord run{name.substr(0, name.find(',')), {}, records.loops[name]};
    for (auto& [to, link] : links) {
      if (link.vision) run.links.push_back(link);  // a planner's drives have no others: they avoid blank walls
    }
    if (!run.links.empty()) model.runs.push_back(std::move(run));
  }
  if (model.runs.empty() || loops_of(model, "").empty()) throw std::runtime_error(file + " has no links or no loops");
  return model;
}

PoseModel::PoseModel(const ErrorModel& model, const std::string& scene, std::uint64_t seed)
    : random_(seed_of(scene, seed)), run_(draw_run(model, scene, random_)), closed_(loops_of(model, scene)) {}

bool PoseModel::arrive(const Pose& T_map_true) {
  if (!truth_.empty() && length_of(truth_.back().inverse() * T_map_true) < kKeyframe_m) return false;
  add_keyframe(T_map_true);
  close_loops();
  return true;
}

Pose PoseModel::estimate(const Pose& T_map_true) const {
  return graph_.nodes.back().T_map_camera * (truth_.back().inverse() * T_map_true);
}

/// One of the run's links with a similar turn: the next one of the record, if it has, because errors of neighbours are
/// not independent.
const LinkRecord& PoseModel::draw(double turn_rad) {
  const auto& links = run_.links;
  const auto is_alike = [&](std::size_t i) { return std::abs(links[i].turn_rad - turn_rad) < kSimilarTurn_rad; };
  if (link_ + 1 < links.size() && is_alike(link_ + 1)) return links[++link_];
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (is_alike(i)) alike.push_back(i);
  }
  const std::size_t count = alike.empty() ? links.size() : alike.size();
  const std::size_t drawn = std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  return links[link_ = alike.empty() ? drawn : alike[drawn]];
}

void PoseModel::add_keyframe(const Pose& T_map_true) {
  slam::PoseGraphNode node;
  node.id = graph_.nodes.size();
  node.T_map_camera = T_map_true;
  if (!truth_.empty()) {
    const Pose T = truth_.back().inverse() * T_map_true;
    const LinkRecord& link = draw(turn_of(T));
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    for (const auto& [record, type] : {std::pair(&link.vision, slam::EdgeType::kOdometry),
                                       std::pair(&link.odometry, slam::EdgeType::kWheelOdometry)}) {
      if (!*record) continue;
      graph_.edges.push_back(
          {node.id - 1, node.id, type, T * planar_exp(-(*record)->error), in_space((*record)->information)});
      information += (*record)->information;
      weighted += (*record)->information * (*record)->error;
    }
    node.T_map_camera = graph_.nodes.back().T_map_camera * T * planar_exp(-information.ldlt().solve(weighted));
    travelled_m_.push_back(travelled_m_.back() + T.translation().norm());
  } else {
    travelled_m_.push_back(0.0);
  }
  graph_.nodes.push_back(node);
  truth_.push_back(T_map_true);
  ++graph_.version;
}

/// The old key-frame that looks most like the newest one, if slam verifies it.
std::optional<PoseModel::Recognised> PoseModel::recognise() {
  std::optional<Recognised> seen;
  double nearest = 1.0;
  for (std::size_t i = 0; i + 1 < truth_.size() && travelled_m_.back() - travelled_m_[i] > kLeastLoop_m; ++i) {
    const Pose T = truth_[i].inverse() * truth_.back();
    const double distance = T.translation().norm() / kNear_m + turn_of(T) / kNear_rad;
    if (distance >= nearest) continue;
    nearest = distance;
    seen = {i, truth_.size() - 1};
  }
  if (seen && std::uniform_real_distribution<double>()(random_) > kVerified) return std::nullopt;
  return seen;
}

/// A loop counts when a second key-frame soon after finds one, too.
void PoseModel::close_loops() {
  const auto seen = recognise();
  if (!seen) return;
  const auto before = std::exchange(pending_, seen);
  if (!before || seen->keyframe - before->keyframe > kConfirmWithin) return;
  if (travelled_m_.back() - last_loop_m_ < kLoopSpacing_m) return;
  last_loop_m_ = travelled_m_.back();
  const std::size_t pair = std::uniform_int_distribution<std::size_t>(0, closed_.size() / 2 - 1)(random_);
  add_loop(*before, closed_[2 * pair]);
  add_loop(*seen, closed_[2 * pair + 1]);
  const auto correction = slam::correct_graph(graph_);
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i) graph_.nodes[i].T_map_camera = correction.T_map_camera[i];
  ++graph_.version;
}

void PoseModel::add_loop(const Recognised& seen, const EdgeRecord& record) {
  graph_.edges.push_back({graph_.nodes[seen.old_keyframe].id, graph_.nodes[seen.keyframe].id,
                          slam::EdgeType::kLoopClosure,
                          truth_[seen.old_keyframe].inverse() * truth_[seen.keyframe] * planar_exp(-record.error),
                          in_space(record.information)});
  ++loops_;
}

std::pair<double, double> PoseModel::ate_m() const {
  const auto count = static_cast<Eigen::Index>(truth_.size());
  Eigen::Matrix2Xd estimated(2, count), actual(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    estimated.col(i) = graph_.nodes[static_cast<std::size_t>(i)].T_map_camera.translation().head<2>();
    actual.col(i) = truth_[static_cast<std::size_t>(i)].translation().head<2>();
  }
  const Eigen::Matrix3d T = Eigen::umeyama(estimated, actual, false);
  const Eigen::Matrix2Xd aligned = (T.topLeftCorner<2, 2>() * estimated).colwise() + T.topRightCorner<2, 1>().eval();
  const auto rms = [count](const Eigen::Matrix2Xd& errors) {
    return std::sqrt(errors.squaredNorm() / static_cast<double>(count));
  };
  return {rms(aligned - actual), rms(estimated - actual)};
}

}  // namespace lapis::planner::benchmark
