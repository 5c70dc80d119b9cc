#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/core/hallucination/analysed_graph.hpp"
#include "planner/core/hallucination/landmark_index.hpp"
#include "planner/core/information/path_information.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

/// What a decision is made from. The graph and its landmarks are null before slam has two key-frames.
struct Situation {
  const PlanningGrid& grid;
  const FrontierMap& frontiers;
  const InformationField& field;
  const View& view;
  geometry::Pose T_base_camera;
  const AnalysedGraph* graph = nullptr;
  const LandmarkIndex* landmarks = nullptr;
  Pose2 robot;
  /// The field of the same map with other sensor models; what each of them would have chosen is reported, too.
  std::span<const InformationField> compared_fields = {};
};

/// Slam reckons by odometry alone, and the position becomes less sure with every metre.
struct Adrift {
  double sigma_m = 0.0;             ///< of the position since slam tracked
  double growth = 0.0;              ///< of sigma by cost of a path [m/m]
  double budget_m = 0.5;            ///< of sigma at a path's end
  std::vector<Pose2> tracked = {};  ///< where slam tracked, the newest first

  bool operator==(const Adrift&) const = default;
};

/// What is not to be driven to, and what is being driven to.
struct Memory {
  std::vector<LeftAlone> left_alone;            ///< frontiers near these
  std::vector<LeftAlone> old_places;            ///< of key-frames, not to be driven to
  std::vector<Eigen::Vector2d> visited_places;  ///< of key-frames, not to be driven through again [m, map]
  std::vector<LeftAlone> gap_places;            ///< for views of gaps, not to be driven to
  std::vector<FailedView> failed_views;
  std::vector<Pose2> taken_views;  ///< of gaps: not to be taken again
  bool looks_at_gaps = false;      ///< when no frontier can be driven to
  double radius_m = 0.75;          ///< what lies nearer to such places is meant, too
  std::optional<Pose2> goal;       ///< current one
  int turns_to = 0;                ///< a turn the longer way round has begun: 1 to the left, -1 to the right
  std::optional<Adrift> adrift;    ///< nothing while slam tracks

  bool operator==(const Memory&) const = default;
};

/// Pose of the camera of a robot that stands there, T_map_camera.
geometry::Pose camera_at(const Situation& situation, const Pose2& robot);

}  // namespace lapis::planner
