#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "evaluator/core/run/metrics.hpp"
#include "evaluator/core/run/timeline.hpp"

namespace lapis::evaluator {

/// What slam published for one frame. Poses are those of the camera's optical frame.
struct FrameRecord {
  time::Time stamp;
  std::int64_t session = 0;  ///< session of slam
  PoseTier tier = PoseTier::kNone;
  std::optional<geometry::Pose> T_map_camera;               ///< none: slam had no pose, whatever `tier` says
  std::optional<geometry::Pose> T_world_camera;             ///< true pose; none: it was not published
  std::optional<double> position_sigma_m;                   ///< as in TimelineRow; none: it was not published
  std::optional<std::uint64_t> keyframe_id = std::nullopt;  ///< none: the frame did not become a key-frame
};

/// Final poses of key-frames in the map, by id.
using KeyframePoses = std::map<std::uint64_t, geometry::Pose>;

/// Record of a run's frames: the source of slam's pose of each frame, and the estimated and true poses of the camera.
/// The run is judged in the frame of slam's first map, because poses of a later session have another origin. Its times
/// go on when the clock of the stamps is set.
class RunRecord {
 public:
  /// Counts a frame of the camera, whether or not slam answers it: a frame that slam dropped or never received is a
  /// frame without a pose. Lock-step may repeat a stamp.
  void count_camera_frame(time::Time stamp);
  /// The clock that stamps the camera's frames was set by `step`; the newest frame has its new time already.
  void follow_camera_clock(time::Duration step);
  /// The clock that stamps slam's frames was set by `step`, known to the jitter of delays; `first`: the next stamp.
  void follow_clock(time::Duration step, time::Time first);
  /// Counts collisions, each of which is the beginning of a contact. Contacts are published on change, and lock-step
  /// may repeat them.
  void count_contact(bool is_in_contact);
  /// Adds a frame. Returns false for a frame of a later session, which counts as lost.
  bool add(const FrameRecord& frame);

  bool is_empty() const { return frames_total_ == 0 && frames_judged_ == 0; }
  std::int64_t frames_judged() const { return frames_judged_; }
  std::int64_t collisions() const { return collisions_.value_or(0); }
  /// Session of slam in which the run is judged; none before the first frame.
  std::optional<std::int64_t> session() const { return session_; }
  /// A row for each frame that slam answered.
  const std::vector<FrameRow>& frames() const { return frames_; }
  /// Fixed transform from the first frame that has both an estimated and a true pose.
  const std::optional<geometry::Pose>& T_map_world() const { return T_map_world_; }
  const Trajectory& estimate() const { return estimate_; }
  Trajectory truth_in_map() const;
  /// Time of the newest frame that slam answered, by the clock as it was set when the run began.
  time::Time newest() const { return last_stamp_; }
  /// The same since the run's first frame [s].
  double time_s() const { return (last_stamp_ - *first_stamp_).seconds(); }
  /// Position error of the newest frame [m]; none without an estimated or a true pose.
  std::optional<double> position_error_m() const;
  /// Length of the true path so far [m].
  std::optional<double> path_length_m() const { return path_length_m_; }

  /// Fills in the figures of frames, trajectories and collisions.
  /// @param keyframes judged at the times of the frames that became these key-frames, because their own stamps have
  /// the time of slam's map; those of other frames are left out
  /// @param frames_missed camera frames that were lost in transit
  void write_to(RunMetrics& metrics, const KeyframePoses& keyframes, std::int64_t frames_missed, bool has_ended) const;

 private:
  void count_time(time::Time stamp, PoseTier tier);
  void add_truth(time::Time stamp, const geometry::Pose& T_world_camera);
  void write_times(RunMetrics& metrics) const;
  Trajectory trajectory_of(const KeyframePoses& keyframes) const;
  time::Time end() const;
  bool is_lost() const;
  std::int64_t frames_of(PoseTier tier) const { return frames_of_tier_[static_cast<std::size_t>(tier)]; }

  std::optional<std::int64_t> session_;
  Trajectory estimate_;     // T_map_camera as published at the time of each frame
  Trajectory truth_world_;  // T_world_camera
  std::optional<geometry::Pose> T_map_world_;
  std::optional<double> path_length_m_;
  std::map<std::uint64_t, time::Time> keyframe_stamps_;
  std::optional<time::Time> first_stamp_;   // first frame of the camera or of slam
  time::Time last_stamp_;                   // newest frame of slam
  time::Duration clock_steps_;              // sum of the steps by which the clock of slam's frames was set
  std::optional<time::Time> camera_stamp_;  // newest frame of the camera, by the clock as it is set now
  time::Duration camera_clock_steps_;       // the same sum for the camera
  std::int64_t frames_total_ = 0;           // frames of the camera
  std::int64_t frames_judged_ = 0;          // frames that slam answered, with or without a pose
  std::array<std::int64_t, kPoseTiers> frames_of_tier_{};
  std::array<double, kPoseTiers> seconds_of_tier_{};
  std::vector<FrameRow> frames_;
  std::optional<std::int64_t> collisions_;  // none when no contacts are published
  bool is_in_contact_ = false;
};

}  // namespace lapis::evaluator
