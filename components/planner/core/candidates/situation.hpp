#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/core/hallucination/analysed_graph.hpp"
#include "planner/core/hallucination/landmark_index.hpp"
#include "planner/core/information/path_information.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

class MapWorth;

/// The input of a decision. The graph and its landmarks are null until slam has two key-frames.
struct Situation {
  const PlanningGrid& grid;
  const FrontierMap& frontiers;
  const InformationField& field;
  const View& view;
  geometry::Pose T_base_camera;
  const AnalysedGraph* graph = nullptr;
  const LandmarkIndex* landmarks = nullptr;
  Pose2 robot;
  /// Fields of the same map with other sensor models. Decisions report what the method would have chosen with each of
  /// them.
  std::span<const InformationField> compared_fields = {};
  const MapWorth* worth = nullptr;  ///< null unless a method asks for it
};

/// State of dead reckoning: slam has no visual tracking, and the position becomes less certain with every metre.
struct Adrift {
  double sigma_m = 0.0;             ///< standard deviation of the position since slam tracked last; may be NaN
  double growth = 0.0;              ///< increase of the standard deviation per cost of a path [m/m]
  double budget_m = 0.5;            ///< largest standard deviation at a path's end
  std::vector<Pose2> tracked = {};  ///< poses at which slam tracked, the newest first

  bool operator==(const Adrift&) const = default;
};

/// What decisions have to leave alone, and the current goal.
struct Memory {
  std::vector<LeftAlone> left_alone;            ///< targets of frontiers
  std::vector<LeftAlone> old_places;            ///< old key-frames that the robot must not drive to
  std::vector<Eigen::Vector2d> visited_places;  ///< old key-frames that the robot must not drive through again [m, map]
  std::vector<LeftAlone> gap_places;            ///< places of views of gaps that the robot must not drive to
  std::vector<FailedView> failed_views;
  std::vector<Pose2> taken_views;  ///< views of gaps that must not be taken again
  bool looks_at_gaps = false;      ///< views of gaps are proposed when no frontier can be driven to
  double radius_m = 0.75;          ///< what is nearer than this to a remembered place is treated like the place
  std::optional<Pose2> goal;       ///< the goal that the robot is driving to
  int turns_to = 0;                ///< direction of a turn the longer way that has begun: 1 left, -1 right; 0 none
  std::optional<Adrift> adrift;    ///< empty while slam tracks

  bool operator==(const Memory&) const = default;
};

/// Pose T_map_camera of the camera when the robot is at `robot`.
geometry::Pose camera_at(const Situation& situation, const Pose2& robot);

}  // namespace lapis::planner
