#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/graph/pose_graph.hpp"

namespace lapis::slam::benchmark {

/// Squared error in units of its information, per degree of freedom: 1 on average when the information is honest.
/// Directions with an information of at most `floor` are no degrees of freedom: the edge does not claim to know them.
/// 0 when there are none left.
double nees(const geometry::Pose& estimate, const geometry::Pose& truth, const geometry::Matrix6d& information,
            double floor = 0.0);

/// NEES per degree of freedom of the edges of pose graphs, by what measured them, and of poses in the map.
class EdgeHonesty {
 public:
  /// `least_information`: what slam gives directions that an edge leaves open; ten times as much counts as known.
  EdgeHonesty(const geometry::Pose& T_base_camera, double least_information)
      : T_base_camera_(T_base_camera), floor_(10.0 * least_information) {}

  /// `truth`: T_map_camera of all nodes, by stamp.
  void add(const PoseGraphSnapshot& graph, const std::map<std::int64_t, geometry::Pose>& truth);
  /// The camera in the map, as slam publishes it.
  void add_pose(const geometry::Pose& T_map_camera, const geometry::Pose& truth, const geometry::Matrix6d& covariance);
  void add(const EdgeHonesty& other);
  /// A line for each kind of edges and poses that there are.
  void print(const std::string& indent) const;

 private:
  struct Sample {
    double nees, freedoms;
  };
  void add(const PoseGraphEdge& edge, const geometry::Pose& T_from_to_true);
  double nees_in_plane(const geometry::Pose& estimate, const geometry::Pose& truth,
                       const geometry::Matrix6d& covariance) const;

  geometry::Pose T_base_camera_;
  double floor_;
  std::map<std::string, std::vector<Sample>> samples_;
};

}  // namespace lapis::slam::benchmark
