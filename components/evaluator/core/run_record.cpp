#include "evaluator/core/run_record.hpp"

#include <algorithm>

#include "common/time/stamp_buffer.hpp"

namespace lapis::evaluator {

void RunRecord::count_camera_frame(time::Time stamp) {
  const bool is_repeated = camera_stamp_ && stamp <= *camera_stamp_ && *camera_stamp_ - stamp <= time::kRestartGap;
  if (is_repeated) return;
  camera_stamp_ = stamp;
  ++frames_total_;
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
  const bool is_tracked = is_judged && frame.T_map_camera;
  count_time(frame.stamp, is_tracked);
  const auto append = [&](Trajectory& trajectory, const geometry::Pose& pose) {
    if (trajectory.empty() || trajectory.back().stamp < frame.stamp) trajectory.push_back({frame.stamp, pose});
  };
  if (frame.T_world_camera) append(truth_world_, *frame.T_world_camera);
  if (!is_tracked) return is_judged;
  ++frames_tracked_;
  append(estimate_, *frame.T_map_camera);
  if (frame.T_world_camera && !T_map_world_) T_map_world_ = *frame.T_map_camera * frame.T_world_camera->inverse();
  return true;
}

void RunRecord::count_time(time::Time stamp, bool is_tracked) {
  if (!first_stamp_) first_stamp_ = last_stamp_ = stamp;
  if (stamp <= last_stamp_) return;  // a source that began anew goes back
  if (!is_tracked) lost_time_s_ += (stamp - last_stamp_).seconds();
  last_stamp_ = stamp;
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

std::optional<double> RunRecord::path_length_m() const {
  if (truth_world_.empty()) return std::nullopt;
  return trajectory::path_length_m(truth_world_);
}

void RunRecord::write_to(RunMetrics& m, const Trajectory& keyframes, std::int64_t frames_missed, bool has_ended) const {
  m.frames_total = std::max(frames_total_ + frames_missed, frames_judged_);
  m.exit_reason = judged_exit_reason(has_ended ? "completed" : "stopped", frames_tracked_, *m.frames_total);
  m.frames_tracked = frames_tracked_;
  m.lost_time_s = lost_time_s_;
  m.collisions = collisions_;
  m.correction_rmse_m = trajectory_figures(estimate_, keyframes).ate_raw_rmse_m;
  if (first_stamp_) m.duration_s = time_s();
  const Trajectory truth = truth_in_map();
  if (truth.empty()) return;
  m.online = trajectory_figures(truth, estimate_);
  m.keyframes = trajectory_figures(truth, keyframes);
  m.path_length_m = trajectory::path_length_m(truth);
  m.ate_at_80_m = ate_raw_rmse_up_to(80.0, truth, estimate_);
  if (*m.path_length_m > 0.0 && m.online.ate_raw_rmse_m) m.ate_per_metre = *m.online.ate_raw_rmse_m / *m.path_length_m;
}

}  // namespace lapis::evaluator
