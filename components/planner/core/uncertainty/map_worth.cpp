#include "planner/core/uncertainty/map_worth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "planner/core/uncertainty/surviving_share.hpp"

namespace lapis::planner {
namespace {

constexpr double kLeastLength_m = 0.05;                   // of an edge, where noise per metre is told
const Eigen::Vector3d kUsualLoopNoise(4e-4, 4e-4, 1e-4);  // 2 cm, 0.6 degrees
const Eigen::Vector3d kUsualOdometryNoise(1e-5, 1e-5, 1e-6);

/// Maps the error of a pose to that of a point which moves with it: a turn displaces what is far away.
Eigen::Matrix3d carried_to(const Eigen::Vector2d& p_map, const Eigen::Vector2d& origin_map) {
  Eigen::Matrix3d carry = Eigen::Matrix3d::Identity();
  const Eigen::Vector2d arm = p_map - origin_map;
  carry(0, 2) = -arm.y();
  carry(1, 2) = arm.x();
  return carry;
}

Eigen::Vector2d position_of(const Keyframe& keyframe) { return keyframe.T_map_camera.translation().head<2>(); }

/// Variances along the map's axes and of the heading by the information of an edge, mean over both axes.
Eigen::Vector3d planar_noise(const Information& information, const geometry::Pose& T_map_to) {
  Eigen::Matrix<double, 6, 3> tangent = Eigen::Matrix<double, 6, 3>::Zero();
  const Eigen::Matrix3d R_camera_map = T_map_to.linear().transpose();
  tangent.topLeftCorner<3, 2>() = R_camera_map.leftCols<2>();
  tangent.bottomRightCorner<3, 1>() = R_camera_map.col(2);
  const Eigen::Matrix3d planar = tangent.transpose() * information * tangent;
  const Eigen::Matrix3d covariance = planar.ldlt().solve(Eigen::Matrix3d::Identity());
  const double along = 0.5 * (covariance(0, 0) + covariance(1, 1));
  return {along, along, covariance(2, 2)};
}

/// surviving_share() by the ratio of the standard deviation to the edge of a voxel, interpolated by cubics to 1e-11: it
/// is asked for some thousand times per candidate.
class ShareTable {
 public:
  ShareTable() {
    for (int i = 0; i <= kIntervals + 1; ++i) {
      const double edges = i * kStep;  // of sigma
      values_.push_back(surviving_share(edges, 1.0));
      const double exponential = i == 0 ? 0.0 : std::exp(-0.5 / (edges * edges));
      slopes_.push_back(std::sqrt(2.0 / std::numbers::pi) * (exponential - 1.0) * kStep);
    }
  }
  double operator()(double sigma_edges) const {
    if (!(sigma_edges < kIntervals * kStep)) return surviving_share(sigma_edges, 1.0);
    const auto i = static_cast<std::size_t>(sigma_edges / kStep);
    const double t = sigma_edges / kStep - static_cast<double>(i), u = 1.0 - t;
    return u * u * ((1.0 + 2.0 * t) * values_[i] + t * slopes_[i]) +
           t * t * ((1.0 + 2.0 * u) * values_[i + 1] - u * slopes_[i + 1]);
  }

 private:
  static constexpr int kIntervals = 2048;
  static constexpr double kStep = 1.0 / 512.0;
  std::vector<double> values_, slopes_;
};

const ShareTable& share_table() {
  static const ShareTable table;
  return table;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::Vector3d medians(const std::vector<Eigen::Vector3d>& noises, const Eigen::Vector3d& usual) {
  if (noises.empty()) return usual;
  Eigen::Vector3d out;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& noise : noises) values.push_back(noise(axis));
    out(axis) = median(std::move(values));
  }
  return out;
}

}  // namespace

std::variant<MapWorth, GraphError> MapWorth::make(std::span<const Keyframe> keyframes,
                                                  std::span<const KeyframeEdge> edges, const SurfaceStakes& stakes,
                                                  const MapWorthConfig& config) {
  auto graph = PlanarGraph::make(keyframes, edges);
  if (auto* error = std::get_if<GraphError>(&graph)) return std::move(*error);
  MapWorth worth(std::get<PlanarGraph>(std::move(graph)), config);
  worth.marginals_ = worth.graph_.marginals();
  for (Eigen::Matrix3d& marginal : worth.marginals_) marginal *= config.sigma_factor * config.sigma_factor;
  worth.note_noise(edges);
  worth.note_stakes(stakes);
  worth.nats_ = worth.nats_with({});
  return worth;
}

/// The noise of odometry per metre, and that of a loop closure: medians over the edges of the graph.
void MapWorth::note_noise(std::span<const KeyframeEdge> edges) {
  std::map<std::uint64_t, const Keyframe*> known;
  for (const Keyframe& keyframe : graph_.keyframes()) known[keyframe.id] = &keyframe;
  std::vector<Eigen::Vector3d> loops, odometry;
  for (const KeyframeEdge& edge : edges) {
    const auto from = known.find(edge.from), to = known.find(edge.to);
    if (from == known.end() || to == known.end()) continue;
    const Eigen::Vector3d noise = planar_noise(edge.information, to->second->T_map_camera);
    if (edge.is_loop_closure) {
      loops.push_back(noise);
    } else {
      const double length_m = (position_of(*from->second) - position_of(*to->second)).norm();
      odometry.emplace_back(noise / std::max(length_m, kLeastLength_m));
    }
  }
  const double factor = config_.sigma_factor * config_.sigma_factor;
  loop_noise_ = factor * medians(loops, kUsualLoopNoise);
  odometry_noise_ = factor * medians(odometry, kUsualOdometryNoise);
}

void MapWorth::note_stakes(const SurfaceStakes& stakes) {
  bin_m_ = stakes.bin_m;
  const auto& keyframes = graph_.keyframes();
  for (std::size_t node = 0; node < keyframes.size(); ++node) {
    const auto found = stakes.voxels.find(keyframes[node].id);
    if (found == stakes.voxels.end()) continue;
    const Eigen::Vector2d ahead = keyframes[node].T_map_camera.linear().col(2).head<2>().normalized();
    Stake stake{static_cast<int>(node), {-ahead.y(), ahead.x()}, found->second};
    for (double& value : stake.nats) whole_nats_ += value *= config_.voxel_nats;
    stakes_.push_back(std::move(stake));
  }
}

/// The variance of a surface at range r is a + 2 b r + c r^2 (surface_sigma_m()).
double MapWorth::worth_of(const Stake& stake, const Eigen::Matrix3d& covariance) const {
  const double a = 0.5 * covariance.topLeftCorner<2, 2>().trace(), c = 0.5 * covariance(2, 2);
  const double b = 0.5 * stake.across.dot(covariance.block<2, 1>(0, 2));
  double sum = 0.0;
  for (std::size_t bin = 0; bin < stake.nats.size(); ++bin) {
    if (stake.nats[bin] == 0.0) continue;
    const double range_m = (static_cast<double>(bin) + 0.5) * bin_m_;
    const double variance_m2 = a + range_m * (2.0 * b + range_m * c);
    sum += stake.nats[bin] * share_table()(std::sqrt(std::max(variance_m2, 0.0)) / config_.voxel_m);
  }
  return sum;
}

const Eigen::MatrixX3d& MapWorth::columns(int node) const {
  const auto known = columns_.find(node);
  if (known != columns_.end()) return known->second;
  const double factor = config_.sigma_factor * config_.sigma_factor;
  return columns_.emplace(node, factor * graph_.columns(node)).first->second;
}

Eigen::Matrix3d MapWorth::path_noise(double path_m) const {
  return (path_m * odometry_noise_).asDiagonal().toDenseMatrix();
}

/// What a loop measures: the pose of the path's node against the old key-frame; the node is carried by the newest
/// key-frame, with the noise of the path in between.
MapWorth::Measurement MapWorth::measurement_of(const PossibleLoop& loop) const {
  const int newest = static_cast<int>(graph_.keyframes().size()) - 1;
  Measurement measurement{loop.keyframe,
                          loop.path_m,
                          carried_to(loop.p_map_node, position_of(graph_.keyframes().back())),
                          carried_to(loop.p_map_node, position_of(graph_.keyframes()[index(loop.keyframe)])),
                          {}};
  measurement.columns =
      columns(newest) * measurement.at_newest.transpose() - columns(loop.keyframe) * measurement.at_old.transpose();
  return measurement;
}

/// M after these loops have closed.
double MapWorth::nats_with(std::span<const Measurement* const> loops) const {
  const int newest = static_cast<int>(graph_.keyframes().size()) - 1;
  const auto size = 3 * std::ssize(loops);
  Eigen::MatrixXd innovation = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < std::ssize(loops); ++k) {
    const Measurement& loop = *loops[static_cast<std::size_t>(k)];
    for (Eigen::Index m = 0; m < std::ssize(loops); ++m) {
      const Measurement& other = *loops[static_cast<std::size_t>(m)];
      innovation.block<3, 3>(3 * k, 3 * m) = loop.at_newest * other.columns.middleRows<3>(3 * newest) -
                                             loop.at_old * other.columns.middleRows<3>(3 * loop.keyframe) +
                                             path_noise(std::min(loop.path_m, other.path_m));  // common to both
    }
    innovation.block<3, 3>(3 * k, 3 * k) += loop_noise_.asDiagonal().toDenseMatrix();
  }
  const Eigen::MatrixXd weight = innovation.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3 * static_cast<int>(kMostLoops)>;
  Columns columns(3, size), weighted(3, size);
  double sum = 0.0;
  for (const Stake& stake : stakes_) {
    for (Eigen::Index k = 0; k < std::ssize(loops); ++k)
      columns.middleCols<3>(3 * k) = loops[static_cast<std::size_t>(k)]->columns.middleRows<3>(3 * stake.node);
    weighted.noalias() = columns.lazyProduct(weight);
    sum += worth_of(stake, marginals_[index(stake.node)] - weighted.lazyProduct(columns.transpose()));
  }
  return sum;
}

double MapWorth::secured_nats(const std::vector<PossibleLoop>& loops) const {
  if (config_.sigma_factor == 0.0) return 0.0;
  std::vector<std::pair<double, std::size_t>> ranked;
  std::vector<Measurement> measurements;
  for (const PossibleLoop& loop : loops) measurements.push_back(measurement_of(loop));
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const Measurement* const alone[] = {&measurements[k]};
    ranked.emplace_back(-loops[k].probability * (nats_with(alone) - nats_), k);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (ranked.size() == 1) return -ranked.front().first;
  ranked.resize(std::min(ranked.size(), kMostLoops));
  double expected = 0.0;
  for (unsigned closed = 1; closed < 1U << ranked.size(); ++closed) {
    double probability = 1.0;
    std::vector<const Measurement*> of_set;
    for (std::size_t k = 0; k < ranked.size(); ++k) {
      const bool is_closed = (closed >> k & 1U) != 0;
      const double p = loops[ranked[k].second].probability;
      probability *= is_closed ? p : 1.0 - p;
      if (is_closed) of_set.push_back(&measurements[ranked[k].second]);
    }
    if (probability > 0.0) expected += probability * (nats_with(of_set) - nats_);
  }
  return expected;
}

double MapWorth::share_of_view(const Eigen::Vector2d& p_map, const Eigen::Vector3d& forward, double path_m) const {
  const int newest = static_cast<int>(graph_.keyframes().size()) - 1;
  const Eigen::Matrix3d carry = carried_to(p_map, position_of(graph_.keyframes().back()));
  const Eigen::Matrix3d covariance = carry * marginals_[index(newest)] * carry.transpose() + path_noise(path_m);
  return surviving_share(surface_sigma_m(covariance, forward, config_.view_m), config_.voxel_m);
}

}  // namespace lapis::planner
