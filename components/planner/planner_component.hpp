#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "common/mapping/file/map_description.hpp"
#include "common/mapping/wire/landmark_mirror.hpp"
#include "common/mapping/wire/map_mirror.hpp"
#include "common/runtime/context.hpp"
#include "idl/vision_msgs.hpp"
#include "planner/conversions.hpp"
#include "planner/core/replay/situation_file.hpp"
#include "planner/decision_log.hpp"
#include "planner/decision_plan.hpp"
#include "planner/decision_worker.hpp"
#include "planner/mission_clock.hpp"
#include "planner/planner_config.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls itself so
class App;
}

namespace lapis::planner {

/// Chooses where the robot goes next, by what the map and the pose graph would gain.
class PlannerComponent {
 public:
  using Config = PlannerComponentConfig;
  static constexpr const char* kName = "planner";
  static constexpr const char* kSummary = "Exploration: semantic mutual information and the pose graph's spectrum.";

  static void add_options(CLI::App& app, Config& config);
  static config::Rules rules(const Config& config);
  static std::optional<int> run_tool(const Config& config);

  PlannerComponent(const Config& config, runtime::Context& context);
  /// From the next decision on.
  void reconfigure(const Config& config);
  void finish();

 private:
  using Tracked = lapis_msgs::msg::TrackedFrame;
  /// Session and version of the graph, then epoch and version of the landmarks.
  using GraphVersions = std::tuple<std::int64_t, std::uint64_t, std::int64_t, std::uint64_t>;

  void serve();
  void set_description(const lapis_msgs::msg::MapDescription& message);
  void add_tile(const lapis_msgs::msg::VoxelTile& message);
  void set_map_state(const lapis_msgs::msg::MapState& message);
  void add_landmarks(const lapis_msgs::msg::LandmarkTile& message);
  void set_graph(const lapis_msgs::msg::PoseGraph& message);
  void set_obstacles(nav_msgs::msg::OccupancyGrid message);
  void set_provisional_area(nav_msgs::msg::OccupancyGrid message);
  void begin_session(std::int64_t session, time::Time first_frame);
  void note_frame(const Tracked& frame);
  void note_stamp(time::Time stamp);
  void note_slam(const lapis_msgs::msg::SlamStatus& message);
  void set_pose(const nav_msgs::msg::Odometry& message);
  void set_goal(const geometry_msgs::msg::PoseStamped& message);
  void note_controller(const lapis_msgs::msg::ControllerStatus& message);

  void work(const runtime::Cycle& cycle);
  void take_decision(bool waits);
  void write_down(const Decision& decision, const std::optional<DrivenPath>& ended);
  void refresh();
  bool is_map_readable();
  void update_map();
  void update_obstacles();
  void update_provisional_area();
  Report report() const;
  std::string reason() const;
  std::string reason_with_choice() const;
  std::string method_of_state() const;
  bool is_consolidating() const { return explorer_.state() == State::kConsolidating; }
  GraphVersions versions_of_graph() const;
  void begin_decision();
  void record(const DecisionInput& input);
  void publish();
  void publish_markers();
  void publish_status();
  void drop(const std::string& what, const std::string& reason);
  std_msgs::msg::Header header() const { return header(map_frame_); }
  std_msgs::msg::Header header(const std::string& frame) const;

  Config config_;
  runtime::Context& context_;
  const std::string map_frame_, base_frame_;
  const View view_;
  const geometry::Pose T_base_camera_;
  dds::Publisher<nav_msgs::msg::Path>& path_;
  dds::Publisher<lapis_msgs::msg::CandidateSet>& candidates_;
  dds::Publisher<visualization_msgs::msg::MarkerArray>& markers_;
  dds::Publisher<lapis_msgs::msg::PlannerStatus>& status_;

  // Input from other components.
  std::optional<mapping::MapDescription> description_;  // the newest one
  mapping::MapMirror map_;
  mapping::LandmarkMirror landmarks_;
  std::optional<GraphMessage> graph_;
  std::optional<nav_msgs::msg::OccupancyGrid> obstacles_, provisional_area_;  // newest, not yet applied
  std::int64_t session_ = 0;                                                  // of slam
  std::uint64_t frames_ = 0;
  MissionClock clock_;  // by the stamps of frames
  Tracking tracking_ = Tracking::kLost;
  double drift_m_ = 0.0;     // standard deviation of its position since slam tracked last
  std::string slam_reason_;  // of the newest frame, or of slam's status before the first frame; empty while slam tracks
  std::optional<Pose2> robot_;
  time::Time robot_stamp_;             // of robot_
  Pose2 last_robot_;                   // kept while slam has no pose
  double position_variance_m2_ = 0.0;  // of robot_, per axis, as slam publishes it; 0 when it does not
  bool is_blocked_ = false;

  // State of the planner.
  std::optional<Surroundings> surroundings_;
  std::optional<mapping::MapState> surroundings_state_;
  mapping::SensorModel surroundings_model_;  // with which surroundings_ reads the map
  std::shared_ptr<const GraphKnowledge> knowledge_;
  GraphVersions known_graph_;                    // versions in knowledge_
  std::optional<RecordedGraph> recorded_graph_;  // the same graph, when situations are recorded
  Explorer explorer_;
  PathLedger ledger_;
  DecisionWorker worker_;
  std::optional<DecisionLog> log_;
  std::optional<DecisionPlan> plan_;
  Decision decision_;            // the last one
  std::string driven_by_;        // explanation of the choice that the robot is driving to
  std::string deciding_method_;  // method of the last decision, or of the one being made
  std::uint64_t decisions_ = 0, shown_decision_ = 0;
  std::size_t marker_readers_ = 0;
  double decision_time_s_ = 0.0;
  // Empty until a path is published. The first path is empty, because a controller may follow one from an earlier run
  // of the planner.
  std::optional<std::uint64_t> published_path_;
  time::Time path_stamp_;  // of the frame with which the path was published, by the clock as it is set now
  std::optional<time::Time> reported_at_;
  State reported_state_ = State::kIdle;
  std::string reported_reason_, reported_lack_;
  std::uint64_t reported_decisions_ = 0;
};

}  // namespace lapis::planner
