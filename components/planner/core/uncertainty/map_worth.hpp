#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "planner/core/uncertainty/planar_graph.hpp"

namespace lapis::planner {

/// Occupied voxels that depend on each key-frame, by their distance from it.
struct SurfaceStakes {
  double bin_m = 0.5;                                   ///< width of a bin of distances
  std::map<std::uint64_t, std::vector<double>> voxels;  ///< bin i: from i to i + 1 times bin_m
};

struct MapWorthConfig {
  double voxel_m = 0.25;
  double voxel_nats = 1.0;    ///< information of a first look at a voxel of a surface
  double sigma_factor = 1.0;  ///< on every standard deviation; 0: poses count as exact
  double view_m = 2.5;        ///< distance of what a view along a path sees
};

/// A loop closure that a path may bring.
struct PossibleLoop {
  int keyframe = 0;                  ///< node of the old key-frame in the PlanarGraph
  Eigen::Vector2d p_map_node{0, 0};  ///< where on the path the camera is then [m]
  double path_m = 0.0;               ///< length of the path up to there
  double probability = 0.0;
};

/// The expected information of a map whose surfaces hang on the key-frames of a pose graph: a voxel whose surface may
/// be displaced by an error of standard deviation sigma keeps the share f(sigma) of its information
/// (surviving_share()), so M = sum over key-frames i and distances r of W_i(r) f(sigma_i(r)). Loop closures lessen the
/// errors of old key-frames, and what the map gains by that is in the unit of what it gains by new views.
class MapWorth {
 public:
  /// The error says why the graph cannot be analysed, as PlanarGraph::make does.
  /// @param keyframes sorted by id
  static std::variant<MapWorth, GraphError> make(std::span<const Keyframe> keyframes,
                                                 std::span<const KeyframeEdge> edges, const SurfaceStakes& stakes,
                                                 const MapWorthConfig& config);

  const PlanarGraph& graph() const { return graph_; }
  /// M [nats].
  double nats() const { return nats_; }
  /// What M lacks for poses without errors [nats].
  double lost_nats() const { return whole_nats_ - nats_; }
  /// Expected growth of M by the loops of a path, each of which closes by itself with its probability [nats]. Only the
  /// kMostLoops count that are worth most by themselves.
  double secured_nats(const std::vector<PossibleLoop>& loops) const;
  /// Share of what a view shows that survives in the map: of a camera at that place, after so much path from the
  /// newest key-frame.
  /// @param forward direction of the camera; only x and y count
  double share_of_view(const Eigen::Vector2d& p_map, const Eigen::Vector3d& forward, double path_m) const;

  static constexpr std::size_t kMostLoops = 4;

 private:
  struct Stake {
    int node;
    Eigen::Vector2d across;    // unit vector perpendicular to the camera's direction
    std::vector<double> nats;  // by distance
  };

  struct Measurement {
    int keyframe;
    double path_m;
    Eigen::Matrix3d at_newest, at_old;  // carry errors of the two key-frames to the path's node
    Eigen::MatrixX3d columns;           // covariance of all nodes with what the loop measures
  };

  MapWorth(PlanarGraph graph, const MapWorthConfig& config) : graph_(std::move(graph)), config_(config) {}
  void note_noise(std::span<const KeyframeEdge> edges);
  void note_stakes(const SurfaceStakes& stakes);
  double worth_of(const Stake& stake, const Eigen::Matrix3d& covariance) const;
  Measurement measurement_of(const PossibleLoop& loop) const;
  double nats_with(std::span<const Measurement* const> loops) const;
  /// Covariance of all nodes with one; kept, because candidates share their places.
  const Eigen::MatrixX3d& columns(int node) const;
  Eigen::Matrix3d path_noise(double path_m) const;

  PlanarGraph graph_;
  MapWorthConfig config_;
  double bin_m_ = 0.5;
  std::vector<Stake> stakes_;
  std::vector<Eigen::Matrix3d> marginals_;  // x, y, heading
  mutable std::map<int, Eigen::MatrixX3d> columns_;
  Eigen::Vector3d odometry_noise_;  // variances per metre
  Eigen::Vector3d loop_noise_;      // variances of a loop closure
  double nats_ = 0.0, whole_nats_ = 0.0;
};

}  // namespace lapis::planner
