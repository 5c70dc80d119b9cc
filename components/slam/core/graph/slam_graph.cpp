#include "slam/core/graph/slam_graph.hpp"

#include <algorithm>
#include <map>

#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {

using geometry::Matrix6d;
using geometry::Pose;

namespace {

constexpr double kLeastWeight = 0.5;    // of a loop closure that is kept
constexpr double kAnywhere_m = 1000.0;  // sigma of a pose of which nothing is known
constexpr double kAnywhere_rad = 3.0;

Matrix6d anywhere() {
  geometry::Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kAnywhere_m), Eigen::Vector3d::Constant(kAnywhere_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

// The same edge, seen from its other end.
PoseGraphEdge reversed(const PoseGraphEdge& edge) {
  const Matrix6d move = geometry::adjoint(edge.T_from_to);
  const Matrix6d covariance = move * edge.information.inverse() * move.transpose();
  return {edge.to, edge.from, edge.type, edge.T_from_to.inverse(), covariance.inverse()};
}

}  // namespace

PoseGraphSnapshot without_sub_maps(PoseGraphSnapshot graph, const Map& map) {
  const auto is_outside = [&](std::uint64_t id) { return map.keyframe(id).sub_map != kWholeMap; };
  std::erase_if(graph.nodes, [&](const PoseGraphNode& node) { return is_outside(node.id); });
  std::erase_if(graph.edges, [&](const PoseGraphEdge& edge) { return is_outside(edge.from); });
  return graph;
}

SlamGraph::SlamGraph(std::vector<PoseGraphEdge> edges, std::vector<KeyframeLink> links,
                     std::vector<Matrix6d> covariances)
    : edges_(std::move(edges)), links_(std::move(links)), parents_(covariances.size(), Parent{0, anywhere()}),
      covariances_(std::move(covariances)) {
  // The first edge to a key-frame that is no loop closure is the one from its parent.
  std::vector<bool> has_parent(parents_.size(), false);
  std::map<std::size_t, Matrix6d> surfaces;  // information of edges to parents
  for (const PoseGraphEdge& edge : edges_) {
    const auto to = static_cast<std::size_t>(edge.to);
    if (edge.type == EdgeType::kLoopClosure || has_parent[to]) continue;
    has_parent[to] = true;
    parents_[to] = {edge.from, edge.information.inverse(), edge.type == EdgeType::kWheelOdometry, false};
    if (edge.type == EdgeType::kSurface) surfaces[to] = edge.information;
  }
  // Surfaces leave directions open, which the odometry edge from the same parent determines.
  for (const PoseGraphEdge& edge : edges_) {
    const auto found = surfaces.find(static_cast<std::size_t>(edge.to));
    if (found == surfaces.end() || edge.type != EdgeType::kWheelOdometry || edge.from != parents_[found->first].id)
      continue;
    parents_[found->first].covariance = (found->second + edge.information).inverse();
  }
  for (const PoseGraphEdge& edge : edges_) {
    if (edge.type != EdgeType::kWheelOdometry) parents_[static_cast<std::size_t>(edge.from)].has_child = true;
    hold_circle(edge);
  }
}

void SlamGraph::add_root() {
  const Matrix6d covariance = parents_.empty() ? Matrix6d(Matrix6d::Zero()) : anywhere();
  parents_.push_back({0, covariance, false, false});
  covariances_.push_back(covariance);
}

void SlamGraph::join(const Junction& junction, Map& map) {
  const bool leads_in = map.keyframe(junction.place.to).sub_map == junction.sub_map;
  std::vector<KeyframeId> moved;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.sub_map == junction.sub_map) moved.push_back(keyframe.id);
  }
  map.join(junction.sub_map, junction.into, junction.T_into_sub_map);
  const PoseGraphEdge edge = parent_edge(map, leads_in ? junction.place : reversed(junction.place), junction.sub_map);
  Parent& root = parents_[static_cast<std::size_t>(edge.to)];
  root.id = edge.from;
  root.covariance = edge.information.inverse();
  edges_.push_back(edge);
  edges_.insert(edges_.end(), junction.loops.begin(), junction.loops.end());
  for (const KeyframeId id : moved) covariances_[static_cast<std::size_t>(id)] = by_parent(map, id);
}

// The edge from an older key-frame of the other part to the root of the sub-map: along the place that connects the two,
// and the edges to parents on both sides.
PoseGraphEdge SlamGraph::parent_edge(const Map& map, const PoseGraphEdge& place, KeyframeId root) const {
  KeyframeId parent = place.from;
  while (parent > root) parent = parents_[static_cast<std::size_t>(parent)].id;
  const Pose T_map_root = map.keyframe(root).T_map_camera;
  const Pose T_to_root = map.keyframe(place.to).T_map_camera.inverse() * T_map_root;
  const Matrix6d to_place =
      compound_covariance(chain_covariance(map, parent, place.from), place.T_from_to, place.information.inverse());
  const Matrix6d covariance = compound_covariance(to_place, T_to_root, chain_covariance(map, place.to, root));
  return {parent, root, EdgeType::kCovisibility, map.keyframe(parent).T_map_camera.inverse() * T_map_root,
          covariance.inverse()};
}

// Covariance of a key-frame's pose in the map, by the edge to its parent.
Matrix6d SlamGraph::by_parent(const Map& map, KeyframeId id) const {
  const Parent& parent = parents_[static_cast<std::size_t>(id)];
  const Pose T_parent_keyframe = map.keyframe(parent.id).T_map_camera.inverse() * map.keyframe(id).T_map_camera;
  return compound_covariance(covariance(parent.id), T_parent_keyframe, parent.covariance);
}

void SlamGraph::add_keyframe(const PoseGraphEdge& edge, const Matrix6d& covariance) {
  edges_.push_back(edge);
  const bool is_odometry = edge.type == EdgeType::kWheelOdometry;
  parents_.push_back({edge.from, covariance, is_odometry, false});
  if (!is_odometry) parents_[static_cast<std::size_t>(edge.from)].has_child = true;
  covariances_.push_back(compound_covariance(this->covariance(edge.from), edge.T_from_to, covariance));
}

void SlamGraph::follow(const Map& map, const std::vector<KeyframeId>& moved) {
  const auto has_moved = [&](KeyframeId id) { return std::find(moved.begin(), moved.end(), id) != moved.end(); };
  for (PoseGraphEdge& edge : edges_) {
    const bool is_visual = edge.type == EdgeType::kOdometry || edge.type == EdgeType::kSurface;
    if (!is_visual || !(has_moved(edge.from) || has_moved(edge.to))) continue;
    edge.T_from_to = map.keyframe(edge.from).T_map_camera.inverse() * map.keyframe(edge.to).T_map_camera;
  }
}

void SlamGraph::remeasure(const Map& map) {
  const auto measure = [&](auto& edge) {
    edge.T_from_to = map.keyframe(edge.from).T_map_camera.inverse() * map.keyframe(edge.to).T_map_camera;
  };
  const auto is_of_odometry = [&](const KeyframeLink& link) {
    return std::any_of(edges_.begin(), edges_.end(), [&](const PoseGraphEdge& edge) {
      return edge.type == EdgeType::kWheelOdometry && edge.from == link.from && edge.to == link.to &&
             edge.T_from_to.matrix() == link.T_from_to.matrix();
    });
  };
  for (KeyframeLink& link : links_) {
    if (!is_of_odometry(link)) measure(link);
  }
  for (PoseGraphEdge& edge : edges_) {
    if (edge.type != EdgeType::kWheelOdometry) measure(edge);
  }
}

Matrix6d SlamGraph::chain_covariance(const Map& map, KeyframeId from, KeyframeId to) const {
  const auto T_between = [&](KeyframeId a, KeyframeId b) {
    return Pose(map.keyframe(a).T_map_camera.inverse() * map.keyframe(b).T_map_camera);
  };
  Matrix6d of_from = Matrix6d::Zero();  // covariance of T_ancestor_from
  Matrix6d of_to = Matrix6d::Zero();    // covariance of T_ancestor_to
  KeyframeId a = from;
  KeyframeId b = to;
  while (a != b) {
    KeyframeId& younger = a > b ? a : b;
    Matrix6d& covariance = a > b ? of_from : of_to;
    const Parent& parent = parents_[static_cast<std::size_t>(younger)];
    covariance = compound_covariance(parent.covariance, T_between(younger, a > b ? from : to), covariance);
    younger = parent.id;
  }
  // T_from_to = (T_ancestor_from exp(f))^-1 T_ancestor_to exp(t)
  const Matrix6d move = geometry::adjoint(T_between(to, from));
  return move * of_from * move.transpose() + of_to;
}

// T_from_newest = (T_from exp(f))^-1 T_newest exp(n), with the joint covariance of f and n from the marginals.
Matrix6d SlamGraph::covariance_to_newest_analysed(const Map& map, KeyframeId from) const {
  const KeyframeId newest = with_newest_.size() - 1;
  const Matrix6d move =
      geometry::adjoint(map.keyframe(newest).T_map_camera.inverse() * map.keyframe(from).T_map_camera);
  const Matrix6d mixed = move * with_newest_[static_cast<std::size_t>(from)];
  return move * covariance(from) * move.transpose() + covariance(newest) - mixed - mixed.transpose();
}

Matrix6d SlamGraph::relative_covariance(const Map& map, KeyframeId from, KeyframeId to) const {
  if (from > to) {
    const Matrix6d move = geometry::adjoint(map.keyframe(to).T_map_camera.inverse() * map.keyframe(from).T_map_camera);
    return move * relative_covariance(map, to, from) * move.transpose();
  }
  Matrix6d chain = chain_covariance(map, from, to);
  if (from >= with_newest_.size()) return chain;
  const KeyframeId newest = with_newest_.size() - 1;
  const Pose T_newest_to = map.keyframe(newest).T_map_camera.inverse() * map.keyframe(to).T_map_camera;
  Matrix6d whole =
      compound_covariance(covariance_to_newest_analysed(map, from), T_newest_to, chain_covariance(map, newest, to));
  return largest_sigma(whole, 0) < largest_sigma(chain, 0) ? whole : chain;
}

void SlamGraph::apply(const GraphCorrection& correction, Map& map) {
  std::vector<Pose> moves;  // of each key-frame, in the map
  for (std::size_t i = 0; i < map.keyframes().size(); ++i) {
    const bool is_known = i < correction.T_map_camera.size();
    moves.push_back(is_known ? Pose(correction.T_map_camera[i] * correction.T_map_before[i].inverse())
                             : moves[static_cast<std::size_t>(parents_[i].id)]);
  }
  map.move(moves);
  std::vector<PoseGraphEdge> kept;
  weights_.clear();
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const bool is_known = i < correction.weights.size();
    if (is_known && edges_[i].type == EdgeType::kLoopClosure && correction.weights[i] < kLeastWeight) {
      ++loops_removed_;
      continue;
    }
    kept.push_back(edges_[i]);
    if (!is_known) continue;
    weights_.push_back(correction.weights[i]);
    hold_circle(edges_[i]);
  }
  edges_ = std::move(kept);
  learn(map, correction.marginals);
}

void SlamGraph::learn(const Map& map, const GraphMarginals& marginals) {
  with_newest_ = marginals.with_newest;
  for (std::size_t i = 1; i < covariances_.size(); ++i) {
    const bool is_known = i < marginals.covariances.size() && marginals.covariances[i];
    covariances_[i] = is_known ? *marginals.covariances[i] : by_parent(map, i);
  }
}

std::vector<double> SlamGraph::weights() const {
  std::vector<double> result = weights_;
  result.resize(edges_.size(), 1.0);
  return result;
}

bool SlamGraph::are_apart(KeyframeId a, KeyframeId b) const {
  while (a != b) {
    KeyframeId& younger = a > b ? a : b;
    const Parent& parent = parents_[static_cast<std::size_t>(younger)];
    if (parent.is_bridge) return true;
    younger = parent.id;
  }
  return false;
}

// An edge other than those to parents closes a cycle with them: the two paths to the common ancestor.
void SlamGraph::hold_circle(const PoseGraphEdge& edge) {
  auto a = static_cast<std::size_t>(edge.from), b = static_cast<std::size_t>(edge.to);
  if (parents_[b].id == edge.from || parents_[a].id == edge.to) return;
  while (a != b) {
    std::size_t& younger = a > b ? a : b;
    parents_[younger].is_bridge = false;
    younger = static_cast<std::size_t>(parents_[younger].id);
  }
}

std::size_t SlamGraph::count(EdgeType type) const {
  return static_cast<std::size_t>(
      std::count_if(edges_.begin(), edges_.end(), [&](const PoseGraphEdge& edge) { return edge.type == type; }));
}

PoseGraphSnapshot SlamGraph::snapshot(const Map& map, std::uint64_t version) const {
  PoseGraphSnapshot snapshot{version, {}, edges_};
  for (const Keyframe& keyframe : map.keyframes()) {
    snapshot.nodes.push_back({keyframe.id, keyframe.stamp, keyframe.T_map_camera, is_drifting(keyframe.id)});
  }
  return snapshot;
}

}  // namespace lapis::slam
