#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "evaluator/core/run/metrics.hpp"
#include "evaluator/core/run/timeline.hpp"

namespace lapis::evaluator {

/// What slam published of one frame. Poses are of the camera's optical frame.
struct FrameRecord {
  time::Time stamp;
  std::int64_t session = 0;  ///< of slam
  PoseTier tier = PoseTier::kNone;
  std::optional<geometry::Pose> T_map_camera;    ///< none: slam had no pose, whatever the tier
  std::optional<geometry::Pose> T_world_camera;  ///< true pose; none: not published
  std::optional<double> position_sigma_m;        ///< as TimelineRow; none: not published
};

/// What became of a run's frames: what held slam's pose of them, and where the camera was, by slam's word and in truth.
/// The run is judged in the frame of slam's first map: poses of a later session have another origin.
class RunRecord {
 public:
  /// A frame of the camera, whether slam publishes it or not: one that it had to drop, or never got, is a frame without
  /// a pose. Lock-step may repeat a stamp.
  void count_camera_frame(time::Time stamp);
  /// Published on change, and lock-step may repeat it: a collision is the beginning of a contact.
  void count_contact(bool is_in_contact);
  /// False for a frame of a later session: it counts as lost.
  bool add(const FrameRecord& frame);

  bool is_empty() const { return frames_total_ == 0 && frames_judged_ == 0; }
  std::int64_t frames_judged() const { return frames_judged_; }
  std::int64_t collisions() const { return collisions_.value_or(0); }
  /// Of slam, in which the run is judged; none before the first frame.
  std::optional<std::int64_t> session() const { return session_; }
  /// A row for each frame that slam answered.
  const std::vector<FrameRow>& frames() const { return frames_; }
  /// The one fixed transform, from the first frame that has both poses.
  const std::optional<geometry::Pose>& T_map_world() const { return T_map_world_; }
  const Trajectory& estimate() const { return estimate_; }
  Trajectory truth_in_map() const;
  /// Of the newest frame that slam answered, since the run's first one [s].
  double time_s() const { return (last_stamp_ - *first_stamp_).seconds(); }
  /// Of the newest frame [m]; none when slam has no pose of it, or there is no true one.
  std::optional<double> position_error_m() const;
  /// Of the true path so far [m].
  std::optional<double> path_length_m() const { return path_length_m_; }

  /// Fills in what RunMetrics has of frames, trajectories and collisions.
  /// @param keyframes final poses, in the map
  /// @param frames_missed camera frames lost on their way here
  void write_to(RunMetrics& metrics, const Trajectory& keyframes, std::int64_t frames_missed, bool has_ended) const;

 private:
  void count_time(time::Time stamp, PoseTier tier);
  void add_truth(time::Time stamp, const geometry::Pose& T_world_camera);
  void write_times(RunMetrics& metrics) const;
  time::Time end() const;
  bool is_lost() const;
  std::int64_t frames_of(PoseTier tier) const { return frames_of_tier_[static_cast<std::size_t>(tier)]; }

  std::optional<std::int64_t> session_;
  Trajectory estimate_;     // T_map_camera, as published at its time
  Trajectory truth_world_;  // T_world_camera
  std::optional<geometry::Pose> T_map_world_;
  std::optional<double> path_length_m_;
  std::optional<time::Time> first_stamp_;   // of the camera or of slam
  time::Time last_stamp_;                   // of slam
  std::optional<time::Time> camera_stamp_;  // newest
  std::int64_t frames_total_ = 0;           // of the camera
  std::int64_t frames_judged_ = 0;          // that slam answered, with a pose or without
  std::array<std::int64_t, kPoseTiers> frames_of_tier_{};
  std::array<double, kPoseTiers> seconds_of_tier_{};
  std::vector<FrameRow> frames_;
  std::optional<std::int64_t> collisions_;  // none when nobody publishes contacts
  bool is_in_contact_ = false;
};

}  // namespace lapis::evaluator
