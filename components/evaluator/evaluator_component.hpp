#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/mapping/label_list.hpp"
#include "common/mapping/map_mirror.hpp"
#include "common/messages/geometry.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/stamped_input.hpp"
#include "evaluator/core/coverage.hpp"
#include "evaluator/core/decision_record.hpp"
#include "evaluator/core/ground_truth.hpp"
#include "evaluator/core/metrics.hpp"
#include "evaluator/core/plain_fusion.hpp"
#include "evaluator/core/timeline.hpp"
#include "evaluator/evaluator_config.hpp"
#include "evaluator/process_costs.hpp"

namespace lapis::evaluator {

/// Watches a run, builds the reference map from the run's own frames at true poses, and writes the run folder.
class EvaluatorComponent {
 public:
  using Config = EvaluatorConfig;
  static constexpr const char* kName = "evaluator";
  static constexpr const char* kSummary =
      "Evaluates a run against ground truth and writes the run folder.\n"
      "Tools on files: lapis_evaluator ate|rpe|map|iou|coverage --help";

  EvaluatorComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;
  using Tracked = lapis_msgs::msg::TrackedFrame;
  using Odometry = nav_msgs::msg::Odometry;

  void count_frame(time::Time stamp);
  void count_contact(bool is_in_contact);
  void on_diagnostics(const diagnostic_msgs::msg::DiagnosticArray& message);
  void on_tile(const lapis_msgs::msg::VoxelTile& message);
  void on_map_state(const lapis_msgs::msg::MapState& message);
  void on_planner_status(const lapis_msgs::msg::PlannerStatus& message);
  void work(const runtime::Cycle& cycle);
  bool next_frame(const runtime::Cycle& cycle);
  void record(const Tracked& tracked, const Odometry* truth, const Image* depth, const Image* labels, const Info* info);
  bool is_mount_known(const Odometry& truth, const Tracked& tracked);
  std::filesystem::path truth_folder() const;
  std::string find_truth();
  bool is_of_judged_session(const Tracked& tracked);
  std::optional<geometry::Pose> true_camera_pose(const Odometry& truth, const std::string& optical_frame);
  void add_to_references(const geometry::Pose& T_world_camera, const Image& depth, const Image* labels,
                         const Info& info);
  void add_timeline_row(time::Time stamp, bool is_tracking);
  void report_progress();
  std::int64_t loop_closures() const;
  bool is_comparable(const KnownSpace& map) const;
  void add_shares();
  mapping::BeliefReader belief_reader() const;
  Trajectory truth_in_map() const;
  RunMetrics metrics() const;
  void add_map_figures(RunMetrics& metrics) const;
  std::optional<LabelledVoxels> load_ideal() const;
  void write_files(const RunMetrics& metrics) const;

  Config config_;
  runtime::Context& context_;
  runtime::StampedInput<Tracked> tracked_;
  runtime::StampedInput<Odometry> truth_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Image> labels_;
  runtime::StampedInput<Info> info_;
  messages::StaticTransforms static_transforms_;
  mapping::LabelList label_list_;
  mapping::MapMirror mirror_;
  lapis_msgs::msg::PoseGraph graph_;
  ProcessCosts costs_;
  std::optional<lapis_msgs::msg::PlannerStatus> planner_;  // newest
  DecisionRecord decisions_;
  std::optional<double> position_sigma_m_;  // newest that slam told

  std::optional<std::int64_t> session_;        // of the first frame: the one that is judged
  std::optional<std::int64_t> map_session_;    // of the newest map state
  Trajectory estimate_;                        // T_map_camera, as published at its time
  Trajectory truth_world_;                     // T_world_camera
  std::optional<geometry::Pose> T_map_world_;  // from the first frame that has both
  std::optional<GroundTruth> scene_truth_;     // of a simulated scene
  mapping::VoxelMap reference_;
  PlainFusion plain_fusion_;
  std::vector<TimelineRow> timeline_;
  KnownHistory known_;  // of the rows that have a comparable map
  std::optional<time::Time> timeline_stamp_;
  std::optional<time::Time> first_stamp_;
  time::Time last_stamp_;
  std::optional<time::Time> camera_stamp_;  // newest
  std::int64_t frames_total_ = 0;           // of the camera
  std::int64_t frames_judged_ = 0;          // that slam answered, tracked or not
  std::int64_t frames_tracked_ = 0;
  double lost_time_s_ = 0.0;
  std::optional<std::int64_t> collisions_;  // none when nobody tells contacts
  bool is_in_contact_ = false;
  bool has_ended_ = false;  // lock-step told that no input follows
  std::optional<std::chrono::steady_clock::time_point> began_;
  std::chrono::steady_clock::time_point newest_;
  std::chrono::steady_clock::time_point reported_;  // progress
};

}  // namespace lapis::evaluator
