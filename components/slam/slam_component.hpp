#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "common/messages/geometry.hpp"
#include "common/runtime/saved_map.hpp"
#include "slam/conversions.hpp"
#include "slam/core/calibration/delay_watch.hpp"
#include "slam/core/calibration/focal_length.hpp"
#include "slam/core/files/slam_file.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "slam/depth_calibrator.hpp"
#include "slam/frame_input.hpp"
#include "slam/landmark_publisher.hpp"
#include "slam/map_saver.hpp"
#include "slam/slam_clock.hpp"
#include "slam/slam_config.hpp"

namespace lapis::slam {

/// Tracks the camera, and publishes its pose, also relative to key-frames, and the pose graph.
class SlamComponent {
 public:
  using Config = SlamComponentConfig;
  static constexpr const char* kName = "slam";
  static constexpr const char* kSummary = "RGB-D SLAM: camera in, poses and pose graph out.";

  SlamComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  void work(const runtime::Cycle& cycle);
  bool next_frame(const runtime::Cycle& cycle);
  void load_map();
  bool prepare(const JoinedFrame& first);
  std::unique_ptr<RgbdSlam> begin_map();
  void name_map(time::Time first_stamp);
  void accept_saved_map(const geometry::PinholeCamera& camera, const sensor_msgs::msg::CameraInfo& stated);
  void track(const JoinedFrame& joined);
  void renew_calibrator();
  void renew_watch();
  void watch_focal_length(const sensor_msgs::msg::CameraInfo& info, const builtin_interfaces::msg::Time& after);
  void change_focal_length(double ratio, const std::string& why, const builtin_interfaces::msg::Time& since);
  void watch_delay(const RgbdFrame& frame, const TrackingResult& result, const builtin_interfaces::msg::Time& after);
  void renew_delay_watch();
  void name_depth_camera();
  void watch_scale();
  bool calibrate_depth(const RgbdFrame& frame, const sensor_msgs::msg::CameraInfo& info);
  void keep_estimate();
  void use_estimate(const images::RgbdCalibration& cameras, const builtin_interfaces::msg::Time& since);
  void add_mount(const tf2_msgs::msg::TFMessage& message);
  void add_odometry(const nav_msgs::msg::Odometry& message);
  std::string use_odometry(time::Time stamp, const geometry::Pose& T_odom_base);
  void drop(time::Time stamp, const std::string& reason);
  void give_map_up();
  void end_map();
  void follow_clock(time::Duration step);
  void judge_clock(const TrackingResult& result);
  void publish(TrackingResult result);
  void publish_odometry(const TrackingResult& result);
  void publish_transforms(const nav_msgs::msg::Odometry& odometry);
  void publish_graph(bool is_final);
  void publish_landmarks(bool is_final);
  void publish_status(const TrackingResult& result);
  void report_sub_maps();
  void report_waiting();
  void autosave();
  void note_save(const std::optional<std::string>& problem);
  PoseGraphSnapshot published_graph() const;
  SlamFile saved_map() const;
  std::optional<std::string> write_files();
  void write_graph() const;

  const Config config_;
  runtime::Context& context_;
  FrameIds ids_;
  dds::Publisher<nav_msgs::msg::Odometry>& odometry_;
  dds::Publisher<lapis_msgs::msg::TrackedFrame>& tracked_frame_;
  dds::Publisher<tf2_msgs::msg::TFMessage>& transforms_;
  dds::Publisher<nav_msgs::msg::Path>& path_;
  dds::Publisher<lapis_msgs::msg::PoseGraph>& pose_graph_;
  dds::Publisher<lapis_msgs::msg::SlamStatus>& status_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>* depth_estimate_ = nullptr;  // none: nothing is to be corrected
  LandmarkPublisher landmarks_;

  FrameInput input_;
  messages::StaticTransforms static_transforms_;

  std::optional<SlamFile> resumed_;                      // until the first map begins with it
  std::optional<geometry::PinholeCamera> saved_camera_;  // of the map that was resumed, until a frame has been compared
  std::unique_ptr<RgbdSlam> slam_;                       // exists once the camera's mount is known
  std::deque<std::pair<time::Time, geometry::Pose>> early_odometry_;  // T_odom_base from before that
  std::optional<DepthCalibrator> calibrator_;
  std::optional<FocalLengthWatch> focal_length_;    // until it has contradicted the camera info
  std::optional<images::RgbdCalibration> cameras_;  // as estimated
  bool is_focal_length_estimated_ = false;          // that of colour
  std::optional<images::RgbdCalibration> stated_;   // the cameras before the first estimate of that of depth
  std::string doubtful_;                            // estimate of the depth camera that may be a delay instead
  DelayWatch delay_;
  bool is_scale_doubted_ = false;  // and reported
  time::Duration depth_delay_;     // of depth behind colour, as estimated and corrected
  FrameContext frame_;             // of the newest frame
  SlamClock clock_;
  std::optional<int> doubtful_frames_;  // since the camera's clock was set, until the map is known to be still right
  std::int64_t session_ = -1;
  std::int64_t epoch_ = -1;  // of the landmarks; grows with each map, and with each process that publishes one
  PublishedIds keyframe_ids_;
  bool has_odometry_ = false;                                       // somebody else publishes odom -> base_link
  std::optional<std::pair<time::Time, geometry::Pose>> last_pose_;  // T_map_base
  std::optional<time::Time> graph_stamp_;
  std::uint64_t graph_version_ = 0;  // published last
  std::optional<std::pair<time::Time, std::pair<TrackingState, PoseSource>>> reported_;
  std::string waits_for_;                 // before the first frame: what is missing
  std::optional<time::Time> waiting_at_;  // when that was published last
  runtime::SavedMap disk_;
  MapSaver saver_;
  std::uint64_t saved_version_ = 0;  // of the graph, handed to the saver last
  time::Time saved_stamp_;           // of the frame then
  std::string save_problem_;         // of the newest save, if any
  SubMapSummary sub_maps_;           // as reported last
  std::uint64_t frames_total_ = 0;
  std::uint64_t frames_tracked_ = 0;
  std::uint64_t frames_dropped_ = 0;
};

}  // namespace lapis::slam
