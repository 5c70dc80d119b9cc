#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::planner::benchmark {

/// Error and information of a recorded edge in the plane of the floor: to the right and ahead of the camera at the
/// edge's end [m], and about the axis downwards [rad].
struct EdgeRecord {
  Eigen::Vector3d error{0, 0, 0};
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

/// The edges between a key-frame and the next one.
struct LinkRecord {
  double turn_rad = 0.0;
  std::optional<EdgeRecord> vision, odometry;
};

struct RunRecord {
  std::string scene;
  std::vector<LinkRecord> links;  ///< in the order of driving
  std::vector<EdgeRecord> loops;  ///< pairs: slam confirms a loop by a second one
};

/// What slam's edges were off by in recorded tours. Links are kept by run, because calibration errors and noise are
/// those of a run.
struct ErrorModel {
  std::vector<RunRecord> runs;

  /// Reads what lapis_surviving_share --edges wrote. Throws std::runtime_error that names the file.
  static ErrorModel read(const std::string& file);
};

/// A slam without images: key-frames, edges and loops as in the recorded tours, optimised as slam does. The first
/// key-frame has no error.
class PoseModel {
 public:
  /// A run of a building of the same kind is drawn (`flat` of `flat_40`), if there is one.
  PoseModel(const ErrorModel& model, const std::string& scene, std::uint64_t seed);

  /// The camera has come to this true pose; true when that makes a key-frame.
  bool arrive(const geometry::Pose& T_map_true);
  /// Where slam believes the camera to be: the reference key-frame is the newest one.
  geometry::Pose estimate(const geometry::Pose& T_map_true) const;

  std::uint64_t newest() const { return graph_.nodes.back().id; }
  const slam::PoseGraphSnapshot& graph() const { return graph_; }
  const std::vector<geometry::Pose>& truth() const { return truth_; }
  int loops() const { return loops_; }
  /// Root mean square of the key-frames' errors after the best planar alignment, and without any [m].
  std::pair<double, double> ate_m() const;

 private:
  void add_keyframe(const geometry::Pose& T_map_true);
  struct Recognised {
    std::size_t old_keyframe, keyframe;
  };
  std::optional<Recognised> recognise();
  void close_loops();
  void add_loop(const Recognised& seen, const EdgeRecord& record);
  const LinkRecord& draw(double turn_rad);

  std::mt19937_64 random_;
  const RunRecord& run_;            // whose links are drawn
  std::vector<EdgeRecord> closed_;  // pairs of loops that are drawn, of runs of the same kind
  std::size_t link_ = 0;            // the one drawn last
  slam::PoseGraphSnapshot graph_;
  std::vector<geometry::Pose> truth_;  // T_map_camera by key-frame
  std::vector<double> travelled_m_;    // path up to each key-frame
  std::optional<Recognised> pending_;  // waits for a second one
  double last_loop_m_ = -1e9;
  int loops_ = 0;
};

}  // namespace lapis::planner::benchmark
