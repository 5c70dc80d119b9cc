#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/wire/landmark_tile.hpp"
#include "planner/core/hallucination/analysed_graph.hpp"
#include "planner/core/information/information_field.hpp"

namespace lapis::planner {

struct CovisibilityConfig {
  double max_range_m = 5.0;  ///< of landmarks from the camera, in (0, 20]
  /// Largest angle between the directions from which a landmark was and would be seen, in (0, pi].
  double max_viewing_angle_rad = 0.7;
  /// Largest ratio of the distances, either way: the change of scale that descriptors tolerate; in [1, 10].
  double max_range_ratio = 2.0;
  double min_visibility = 0.5;  ///< least probability that the ray to a landmark is free
};

/// Number of landmarks that a camera would see and that an old key-frame has seen.
struct Covisibility {
  int keyframe = 0;  ///< node of the AnalysedGraph
  int landmarks = 0;
  bool operator==(const Covisibility&) const = default;
};

/// slam's landmarks, grouped by voxel, with the key-frames that saw them.
class LandmarkIndex {
 public:
  /// Landmarks that no key-frame of the graph has seen are left out.
  LandmarkIndex(const std::map<mapping::TileIndex, mapping::LandmarkTile>& tiles, const AnalysedGraph& graph,
                double resolution_m);

  std::size_t size() const { return landmarks_.size(); }

  /// Number of landmarks of a key-frame that other key-frames have seen, too.
  int shared_landmarks(int node) const { return shared_[static_cast<std::size_t>(node)]; }

  /// For each key-frame, the number of its landmarks that a camera at T_map_camera would see again: landmarks in the
  /// image, within range, behind free space up to the voxel before theirs, and seen from a similar direction and
  /// distance. Sorted by node, without zero counts.
  std::vector<Covisibility> predict(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                                    const InformationField& field, const CovisibilityConfig& config) const;
  /// The same, only for the key-frames that are `wanted` (by node) and have at least that many landmarks. Faster where
  /// there are none, because then no ray is followed.
  std::vector<Covisibility> predict(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                                    const InformationField& field, const CovisibilityConfig& config,
                                    const std::vector<bool>& wanted, int least_landmarks) const;

 private:
  struct Observation {
    int keyframe;
    Eigen::Vector3f towards;  ///< from the key-frame's camera to the landmark [m]
  };
  struct Landmark {
    Eigen::Vector3f p_map;
    std::uint32_t observations_end;  ///< end in observations_; the previous landmark's end is the begin
  };
  struct Cell {
    Eigen::Vector3d center;       ///< mean of its landmarks [m, map frame]
    std::uint32_t landmarks_end;  ///< end in landmarks_
  };

  /// Landmarks by key-frame. @param field of which the rays have to be free; null: walls hide nothing
  std::vector<int> counts(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                          const InformationField* field, const CovisibilityConfig& config) const;
  void count(std::size_t landmark, const Eigen::Vector3f& camera, const CovisibilityConfig& config,
             std::vector<int>& counts) const;

  std::vector<int> shared_;  ///< number of shared landmarks by node
  double resolution_m_;
  std::vector<Cell> cells_;
  std::vector<Landmark> landmarks_;
  std::vector<Observation> observations_;
};

/// Probability that a ray from one point to another is free. The voxel of the end and the one before it do not count,
/// because surfaces are not sharper than that.
double free_probability(const InformationField& field, const Eigen::Vector3d& from_map, const Eigen::Vector3d& to_map);

}  // namespace lapis::planner
