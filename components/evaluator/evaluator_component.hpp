#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/images/rectifier.hpp"
#include "common/messages/geometry.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/depth_camera.hpp"
#include "common/runtime/depth_input.hpp"
#include "common/runtime/stamped_input.hpp"
#include "evaluator/core/run/decision_record.hpp"
#include "evaluator/core/run/run_record.hpp"
#include "evaluator/evaluator_config.hpp"
#include "evaluator/map_judge.hpp"
#include "evaluator/process_costs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"

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

  /// The messages that belong to a frame that slam answered; null where there is none.
  struct Partners {
    Odometry* odometry = nullptr;  ///< slam's pose with its covariance
    Odometry* truth = nullptr;
    Image* depth = nullptr;
    Image* labels = nullptr;
    Info* info = nullptr;
  };

  void follow_clock(time::Duration step);
  void count_contact(bool is_in_contact);
  void on_diagnostics(const diagnostic_msgs::msg::DiagnosticArray& message);
  void on_map_description(const lapis_msgs::msg::MapDescription& message);
  void on_tile(const lapis_msgs::msg::VoxelTile& message);
  void on_map_state(const lapis_msgs::msg::MapState& message);
  void on_planner_status(const lapis_msgs::msg::PlannerStatus& message);
  void work(const runtime::Cycle& cycle);
  bool next_frame(const runtime::Cycle& cycle);
  std::optional<Partners> partners_of(const Tracked& tracked, const runtime::Cycle& cycle);
  void drop_until(time::Time stamp);
  void record(const Tracked& tracked, const Partners& partners);
  bool is_mount_known(const Odometry& truth, const Tracked& tracked);
  std::optional<geometry::Pose> pose_of(const Tracked& tracked);
  std::string find_truth();
  std::optional<geometry::Pose> true_camera_pose(const Odometry& truth, const std::string& optical_frame);
  void add_to_references(const geometry::Pose& T_map_camera, const Image& depth, const Image* labels, const Info& info);
  void add_timeline_row();
  void report_progress();
  std::string how_far() const;
  std::int64_t loop_closures() const;
  RunMetrics metrics() const;
  void write_files(const RunMetrics& metrics) const;

  Config config_;
  runtime::Context& context_;
  runtime::StampedInput<Tracked> tracked_;
  runtime::StampedInput<Odometry> odometry_;  // of slam
  runtime::StampedInput<Odometry> truth_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Image> labels_;
  runtime::StampedInput<Info> info_;  // of colour, to which labels and poses belong
  messages::StaticTransforms static_transforms_;
  runtime::DepthCamera depth_camera_;
  images::KeptRectifier rectifier_;  // of labels
  lapis_msgs::msg::PoseGraph graph_;
  ProcessCosts costs_;
  std::optional<lapis_msgs::msg::PlannerStatus> planner_;  // newest
  DecisionRecord decisions_;

  RunRecord record_;
  MapJudge maps_;
  std::vector<TimelineRow> timeline_;
  std::optional<time::Time> timeline_stamp_;
  bool waits_for_labels_ = true;
  bool has_ended_ = false;  // lock-step has announced that no input follows
  std::optional<std::chrono::steady_clock::time_point> began_;
  std::chrono::steady_clock::time_point newest_;
  std::chrono::steady_clock::time_point reported_;  // when progress was last reported
};

}  // namespace lapis::evaluator
