#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/core/decision/utility.hpp"
#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/information/path_information.hpp"
#include "planner/core/space/viewpoints.hpp"
#include "planner/core/tare/tare.hpp"

namespace lapis::planner {

struct GapConfig {
  double least_nats = 200.0;  ///< that a view promises, when no frontier is left; 0: no such views; in [0, 1e6]
  double spacing_m = 1.0;     ///< between places, in [0.25, 10]
};

struct DecisionConfig {
  Method method = Method::kJoint;
  UtilityConfig utility;
  PathConfig path;
  ViewpointConfig viewpoints;
  GapConfig gaps;
  TareConfig tare;
  GraphConfig graph;
  HallucinationConfig hallucination;
  int max_candidates = 20;           ///< whose information is computed; the ones with the shortest paths; in [1, 1000]
  double view_spacing_m = 0.75;      ///< between views along a path, in [0.1, 10]
  double node_spacing_m = 1.0;       ///< between hallucinated key-frames, in [0.2, 10]
  double sigma_limit_voxels = 0.5;   ///< of the position at a path's end: what is more exact is of no use; in (0, 10]
  double turn_cost_m_per_rad = 0.5;  ///< of turning at the path's ends, in [0, 10]
  int alternatives = 0;              ///< other paths to the nearest goal of each frontier, at most; in [0, 3]
  /// When the position's sigma [m] is larger, old key-frames with many landmarks are goals, too, for methods that count
  /// loops; 0: never.
  double revisit_sigma_m = 0.0;
  /// The information of a view from a position with sigma s counts 1 / (1 + (s / this)^2) [m]; 0: all of it.
  double information_discount_sigma_m = 0.0;
  /// When no candidate is left, frontiers of at least this length are looked at from nearby although something seems to
  /// hide them, in [0.1, 1000] [m].
  double closer_look_length_m = 1.0;
  double keep_factor = 1.2;  ///< another goal must be so much better than the one being driven to, in [1, 10]
};

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

enum class CandidateKind {
  kFrontier,     ///< the best path to a place from which a frontier is seen
  kAlternative,  ///< another path to such a place
  kCloserLook,   ///< the best path to a place near a frontier that cannot be seen from there, as the map is
  kTracked,      ///< the best path to a place at which slam tracked, while it does not
  kGap,          ///< the best path to a view of what no frontier asks for
  kRevisit,      ///< the best path to an old key-frame
};

/// "frontier" and so on, as in decisions.csv.
const char* name_of(CandidateKind kind);

/// Loop closure that a path may bring.
struct ExpectedLoop {
  Eigen::Vector3d node_map{0, 0, 0};      ///< hallucinated key-frame that sees most of the place [m]
  Eigen::Vector3d keyframe_map{0, 0, 0};  ///< of the place [m]
  double probability = 0.0;
};

/// A path to a place from which there is something to see.
struct Candidate {
  CandidateKind kind = CandidateKind::kFrontier;
  std::uint32_t frontier = 0;  ///< 0: a place, not a frontier
  Pose2 goal;
  Eigen::Vector2d target_map{0, 0};  ///< what is looked at from there, or the place that is revisited [m]
  std::vector<Eigen::Vector2d>
      points;               ///< corners of the path from the robot to the goal [m]; empty when there is none
  std::vector<Pose2> path;  ///< views along it, but for those while it turns
  PathValue value;
  ExpectedGain gain;
  std::vector<Eigen::Vector3d> nodes_map;  ///< hallucinated key-frames [m]
  std::vector<ExpectedLoop> loops;         ///< to old places that the path would see again
  double utility = 0.0;                    ///< of the method
  Rejection rejection = Rejection::kNone;

  /// It is judged.
  bool is_open() const { return rejection == Rejection::kNone; }
};

/// Frontiers that are not going to be looked at.
struct Leftover {
  /// By why; a frontier counts once, for the last of its paths' reasons in the order of the enumeration.
  std::map<Rejection, double> length_m;
  /// Of this length, what geometry does not excuse: frontiers through which the robot would fit, tried in vain.
  double share_to_blame = 0.0;

  /// "frontiers left: 2.5 m: cannot be reached, 1.0 m: left alone for now"; empty when nothing is left.
  std::string text() const;
};

/// A view along the chosen path.
struct PromisedView {
  Pose2 robot;
  double nats = 0.0;  ///< promised by the views up to this one, the one at the beginning included
};

struct Decision {
  std::vector<Candidate> candidates;      ///< at least one for each frontier
  std::optional<std::size_t> chosen;      ///< index; nothing when none can be driven to
  std::vector<PromisedView> promised;     ///< along the chosen path, from where the robot is
  std::vector<double> first_turn_rad;     ///< headings to turn through before the chosen path; empty: the short way
  Leftover leftover;                      ///< when none can
  std::optional<std::size_t> by_mi_only;  ///< what MI / Cost would have chosen
  /// What would have been chosen with each of the compared fields.
  std::vector<std::optional<std::size_t>> by_compared_fields;
  std::string problem;  ///< of the pose graph, when loops could not be judged; empty otherwise
  bool agrees_with_mi_only() const { return chosen == by_mi_only; }
};

/// Slam reckons by odometry alone, and the position becomes less sure with every metre.
struct Adrift {
  double sigma_m = 0.0;             ///< of the position since slam tracked
  double growth = 0.0;              ///< of sigma by cost of a path [m/m]
  double budget_m = 0.5;            ///< of sigma at a path's end
  std::vector<Pose2> tracked = {};  ///< where slam tracked, the newest first
};

/// What is not to be driven to, and what is being driven to.
struct Memory {
  std::vector<LeftAlone> left_alone;  ///< frontiers near these
  std::vector<LeftAlone> old_places;  ///< of key-frames, not to be driven to
  std::vector<LeftAlone> gap_places;  ///< for views of gaps, not to be driven to
  std::vector<FailedView> failed_views;
  std::vector<Pose2> taken_views;  ///< of gaps: not to be taken again
  bool looks_at_gaps = false;      ///< when no frontier can be driven to
  double radius_m = 0.75;          ///< what lies nearer to such places is meant, too
  std::optional<Pose2> goal;       ///< current one
  int turns_to = 0;                ///< before the path there, the longer way round: 1 to the left, -1 to the right
  std::optional<Adrift> adrift;    ///< nothing while slam tracks
};

/// Pose of the camera of a robot that stands there, T_map_camera.
geometry::Pose camera_at(const Situation& situation, const Pose2& robot);

/// Chooses where to go: candidates in front of every frontier, their paths, what the map and the pose graph would gain
/// by them, and the best by the method's utility. Deterministic; ties go to the smaller frontier id.
Decision decide(const Situation& situation, const Memory& memory, const DecisionConfig& config);

}  // namespace lapis::planner
