#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// Key-frame in the pose graph.
struct PoseGraphNode {
  std::uint64_t id = 0;
  time::Time stamp;
  geometry::Pose T_map_camera = geometry::Pose::Identity();  ///< camera optical frame
  bool is_drifting = false;  ///< odometry alone connects it, and no loop has corrected it since
};

enum class EdgeType : std::uint8_t { kOdometry, kCovisibility, kLoopClosure, kWheelOdometry, kSurface };

/// Measured relative pose. The information belongs to the tangent (translation, rotation) of a right perturbation:
/// T_from_to * exp(xi), xi in the frame of `to`; [1/m^2, 1/rad^2], symmetric positive definite.
struct PoseGraphEdge {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  EdgeType type = EdgeType::kOdometry;
  geometry::Pose T_from_to = geometry::Pose::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Identity();
};

struct PoseGraphSnapshot {
  std::uint64_t version = 0;
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
  bool is_planar = false;  ///< from a file of planar poses: only x, y and the rotation about z are free
};

/// Information of an edge from that of an alignment: multiplied by the configured share, and bounded.
geometry::Matrix6d edge_information(const PoseGraphConfig& config, const geometry::Matrix6d& information);
/// The same matrix with its eigenvalues clamped to the configured bounds, so that no direction has none or too much.
geometry::Matrix6d bounded_information(const PoseGraphConfig& config, const geometry::Matrix6d& information);

}  // namespace lapis::slam
