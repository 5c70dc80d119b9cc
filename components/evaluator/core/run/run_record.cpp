#include "evaluator/core/run/run_record.hpp"

#include <algorithm>

#include "common/time/stamp_buffer.hpp"

namespace lapis::evaluator {
namespace {

constexpr double kLostAtEnd_s = 5.0;               // longer than this without a pose at the end: the run is lost
constexpr time::Duration kLeastPeriod{1'000'000};  // of frames between which the clock was set

}  // namespace

void RunRecord::count_camera_frame(time::Time stamp) {
  const bool is_repeated = camera_stamp_ && stamp <= *camera_stamp_ && *camera_stamp_ - stamp <= time::kRestartGap;
  if (is_repeated) return;
  if (!first_stamp_) first_stamp_ = last_stamp_ = stamp;
  camera_stamp_ = stamp;
  ++frames_total_;
}

void RunRecord::follow_camera_clock(time::Duration step) {
  camera_clock_steps_ = {camera_clock_steps_.nanoseconds + step.nanoseconds};
  if (!session_) clock_steps_ = camera_clock_steps_;
}

void RunRecord::follow_clock(time::Duration step, time::Time first) {
  if (!session_) return;  // before slam's first frame the camera tells
  const time::Duration steps{clock_steps_.nanoseconds + step.nanoseconds};
  clock_steps_ = std::min(steps, first - (last_stamp_ + kLeastPeriod));  // so that time does not go back
}

void RunRecord::count_contact(bool is_in_contact) {
  if (!collisions_) collisions_ = 0;
  if (is_in_contact && !is_in_contact_) ++*collisions_;
  is_in_contact_ = is_in_contact;
}

bool RunRecord::add(const FrameRecord& frame) {
  ++frames_judged_;
  if (!session_) session_ = frame.session;
  const bool is_judged = *session_ == frame.session;
  const PoseTier tier = is_judged && frame.T_map_camera ? frame.tier : PoseTier::kNone;
  const time::Time stamp = frame.stamp - clock_steps_;
  const bool is_new = frames_.empty() || last_stamp_ < stamp;
  count_time(stamp, tier);
  ++frames_of_tier_[static_cast<std::size_t>(tier)];
  if (frame.T_world_camera) add_truth(stamp, *frame.T_world_camera);
  if (is_judged && frame.keyframe_id) keyframe_stamps_[*frame.keyframe_id] = stamp;
  if (tier != PoseTier::kNone) {
    if (estimate_.empty() || estimate_.back().stamp < stamp) {
      estimate_.push_back({stamp, *frame.T_map_camera});
    }
    if (frame.T_world_camera && !T_map_world_) T_map_world_ = *frame.T_map_camera * frame.T_world_camera->inverse();
  }
  if (is_new) {
    const bool has_pose = tier != PoseTier::kNone;
    frames_.push_back(
        {time_s(), tier, path_length_m_, has_pose ? frame.position_sigma_m : std::nullopt, position_error_m()});
  }
  return is_judged;
}

/// Counts the time since the previous frame for this frame's tier; before slam's first answer, there was no pose.
void RunRecord::count_time(time::Time stamp, PoseTier tier) {
  if (!first_stamp_) first_stamp_ = last_stamp_ = stamp;
  if (stamp <= last_stamp_) return;  // the stamps of a restarted source go back
  const PoseTier held_by = frames_.empty() ? PoseTier::kNone : tier;
  seconds_of_tier_[static_cast<std::size_t>(held_by)] += (stamp - last_stamp_).seconds();
  last_stamp_ = stamp;
}

void RunRecord::add_truth(time::Time stamp, const geometry::Pose& T_world_camera) {
  if (truth_world_.empty()) {
    path_length_m_ = 0.0;
  } else if (stamp <= truth_world_.back().stamp) {
    return;
  } else {
    *path_length_m_ += (T_world_camera.translation() - truth_world_.back().T_world_body.translation()).norm();
  }
  truth_world_.push_back({stamp, T_world_camera});
}

Trajectory RunRecord::truth_in_map() const {
  return T_map_world_ ? express_in(*T_map_world_, truth_world_) : Trajectory{};
}

std::optional<double> RunRecord::position_error_m() const {
  const auto is_of_newest = [&](const Trajectory& t) { return !t.empty() && t.back().stamp == last_stamp_; };
  if (!T_map_world_ || !is_of_newest(estimate_) || !is_of_newest(truth_world_)) return std::nullopt;
  const geometry::Pose truth = *T_map_world_ * truth_world_.back().T_world_body;
  return (estimate_.back().T_world_body.translation() - truth.translation()).norm();
}

void RunRecord::write_to(RunMetrics& m, const KeyframePoses& keyframe_poses, std::int64_t frames_missed,
                         bool has_ended) const {
  const Trajectory keyframes = trajectory_of(keyframe_poses);
  m.frames_total = std::max(frames_total_ + frames_missed, frames_judged_);
  m.frames_tracked = frames_of(PoseTier::kVision) + frames_of(PoseTier::kSurfaces);
  m.exit_reason = is_lost() ? "lost" : has_ended ? "completed" : "stopped";
  write_times(m);
  m.collisions = collisions_;
  m.correction_rmse_m = trajectory_figures(estimate_, keyframes).ate_raw_rmse_m;
  const Trajectory truth = truth_in_map();
  if (truth.empty()) return;
  m.online = trajectory_figures(truth, estimate_);
  m.keyframes = trajectory_figures(truth, keyframes);
  m.path_length_m = trajectory::path_length_m(truth);
  m.ate_at_80_m = ate_raw_rmse_up_to(80.0, truth, estimate_);
  if (*m.path_length_m > 0.0 && m.online.ate_raw_rmse_m) m.ate_per_metre = *m.online.ate_raw_rmse_m / *m.path_length_m;
}

Trajectory RunRecord::trajectory_of(const KeyframePoses& keyframes) const {
  Trajectory trajectory;
  for (const auto& [id, stamp] : keyframe_stamps_) {
    const auto keyframe = keyframes.find(id);
    const bool is_later = trajectory.empty() || trajectory.back().stamp < stamp;
    if (keyframe != keyframes.end() && is_later) trajectory.push_back({stamp, keyframe->second});
  }
  return trajectory;
}

time::Time RunRecord::end() const {
  return camera_stamp_ ? std::max(*camera_stamp_ - camera_clock_steps_, last_stamp_) : last_stamp_;
}

bool RunRecord::is_lost() const {
  return estimate_.empty() || (end() - estimate_.back().stamp).seconds() > kLostAtEnd_s;
}

/// The time of camera frames after slam's last answer counts as time without a pose, too.
void RunRecord::write_times(RunMetrics& m) const {
  if (!first_stamp_) return;
  const auto seconds_of = [&](PoseTier tier) { return seconds_of_tier_[static_cast<std::size_t>(tier)]; };
  m.lost_time_s = seconds_of(PoseTier::kNone) + (end() - last_stamp_).seconds();
  m.duration_s = (end() - *first_stamp_).seconds();
  if (*m.duration_s <= 0.0) return;
  m.tier_vision_share = seconds_of(PoseTier::kVision) / *m.duration_s;
  m.tier_surfaces_share = seconds_of(PoseTier::kSurfaces) / *m.duration_s;
  m.tier_odometry_share = seconds_of(PoseTier::kOdometry) / *m.duration_s;
  m.lost_share = *m.lost_time_s / *m.duration_s;
}

}  // namespace lapis::evaluator
