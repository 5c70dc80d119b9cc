#include "tests/benchmark/slam/watched_slam.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>

#include "evaluator/core/trajectory/ate.hpp"
#include "slam/core/motion/covariance.hpp"

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;

std::string remark_on(const PoseGraphEdge& edge, const Pose& T_true, double from_s, double to_s) {
  const PoseError error = difference(edge.T_from_to, T_true);
  char text[200];
  std::snprintf(text, sizeof text, "wrong loop %zu (%.2f s) -> %zu (%.2f s): truly %.2f m apart, error %.2f m %.1f deg",
                static_cast<std::size_t>(edge.from), from_s, static_cast<std::size_t>(edge.to), to_s,
                T_true.translation().norm(), error.m, error.rad * kDegrees);
  return text;
}

double rms_aligned_m(const std::vector<Eigen::Vector3d>& actual, const std::vector<Eigen::Vector3d>& estimated) {
  if (actual.empty()) return NAN;
  const Pose T = evaluator::align_points(actual, estimated);
  double squares = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i) squares += (actual[i] - T * estimated[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(actual.size()));
}

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

std::string error_of(const WatchedFrame& frame) {
  if (frame.source == PoseSource::kNone) return "              ";
  char text[32];
  std::snprintf(text, sizeof text, "%6.2f m %4.0f dg", frame.error.m, frame.error.rad * kDegrees);
  return text;
}

}  // namespace

bool is_held(const WatchedFrame& frame) {
  return frame.source == PoseSource::kVision || frame.source == PoseSource::kSurfaces;
}

const char* word_for(const WatchedFrame& frame) {
  switch (frame.source) {
    case PoseSource::kVision: return "vision";
    case PoseSource::kSurfaces: return "surfaces";
    case PoseSource::kOdometry: return "odometry";
    case PoseSource::kNone: break;
  }
  if (frame.state == TrackingState::kUnconnected) return "sub-map";
  return frame.state == TrackingState::kInitializing ? "initializing" : "lost";
}

WatchedSlam::WatchedSlam(const SlamConfig& config, const Pose& T_base_camera)
    : config_(config), T_base_camera_(T_base_camera),
      slam_(std::make_unique<RgbdSlam>(config, T_base_camera, T_base_camera)) {}

void WatchedSlam::add_odometry(time::Time stamp, const Pose& T_odom_base) { slam_->add_odometry(stamp, T_odom_base); }

const WatchedFrame& WatchedSlam::process(const RgbdFrame& frame, const Pose& T_start_camera) {
  if (slam_->is_given_up()) {
    slam_ = std::make_unique<RgbdSlam>(config_, T_base_camera_, T_base_camera_);
    T_map_start_.reset();
    truth_.clear();
    ++map_;
  }
  const double begin_ms = thread_ms();
  const TrackingResult result = slam_->process(frame);
  WatchedFrame& watched = frames_.emplace_back();
  watched.cpu_ms = thread_ms() - begin_ms;
  watched.t_s = frame.stamp.seconds();
  watched.map = map_;
  watched.state = result.state;
  watched.source = has_pose(result) ? result.source : PoseSource::kNone;
  watched.is_keyframe = result.is_keyframe;
  watched.truth = T_start_camera;
  watched.matches = result.matches;
  watched.inliers = result.inliers;
  watched.reason = result.reason;
  const Pose T_map_camera = result.T_map_keyframe * result.T_keyframe_camera;
  if (!T_map_start_ && has_pose(result)) T_map_start_ = T_map_camera * T_start_camera.inverse();
  if (!T_map_start_) return watched;
  const Pose T_map_true = *T_map_start_ * T_start_camera;
  truth_[frame.stamp.nanoseconds] = T_map_true;
  if (!has_pose(result)) return watched;
  watched.error = difference(T_map_camera, T_map_true);
  watched.sigma_m = largest_sigma(result.map_covariance, 0);
  watched.sigma_rad = largest_sigma(result.map_covariance, 3);
  watched.reference = result.keyframe_id;
  return watched;
}

WatchedMap WatchedSlam::finish() {
  constexpr double kFar_m = 1.0;
  slam_->settle();
  const PoseGraphSnapshot graph = slam_->pose_graph();
  WatchedMap map;
  map.keyframes = graph.nodes.size();
  map.loops = slam_->loops().closures;
  map.removed = slam_->loops().removed;
  map.unconnected = slam_->keyframe_count() - graph.nodes.size();
  map.parts = slam_->sub_maps();
  std::vector<Eigen::Vector3d> actual, estimated;
  std::map<std::uint64_t, const PoseGraphNode*> nodes;
  for (const PoseGraphNode& node : graph.nodes) {
    nodes[node.id] = &node;
    actual.emplace_back(truth_.at(node.stamp.nanoseconds).translation());
    estimated.emplace_back(node.T_map_camera.translation());
    if ((actual.back() - estimated.back()).norm() > kFar_m) ++map.far_keyframes;
  }
  map.ate_m = rms_aligned_m(actual, estimated);
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.type != EdgeType::kLoopClosure) continue;
    const time::Time from = nodes.at(edge.from)->stamp, to = nodes.at(edge.to)->stamp;
    const Pose T_true = truth_.at(from.nanoseconds).inverse() * truth_.at(to.nanoseconds);
    if (!is_wrong(edge.T_from_to, T_true)) continue;
    ++map.wrong_loops;
    map.remarks.push_back(remark_on(edge, T_true, from.seconds(), to.seconds()));
  }
  return map;
}

void print_stretches(const std::vector<WatchedFrame>& frames, double from_s) {
  const auto word = [](const WatchedFrame& frame) { return is_held(frame) ? "held" : word_for(frame); };
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= frames.size(); ++i) {
    const WatchedFrame &first = frames[begin], &last = frames[i - 1];
    if (i < frames.size() && word(frames[i]) == word(first)) continue;
    begin = i;
    if (last.t_s < from_s) continue;
    std::printf("    %7.2f to %7.2f s %-12s %s -> %s sigma %5.2f m %4.1f dg, key-frame %4zu, %3u of %3u %s\n",
                first.t_s, last.t_s, word(first), error_of(first).c_str(), error_of(last).c_str(), last.sigma_m,
                last.sigma_rad * kDegrees, static_cast<std::size_t>(last.reference), last.inliers, last.matches,
                first.reason.c_str());
  }
}

void print_frames(const std::vector<WatchedFrame>& frames) {
  for (const WatchedFrame& frame : frames) {
    const Eigen::Vector3d p = frame.truth.translation();
    std::printf("    %7.2f s %-12s %s %s sigma %5.2f m %4.1f dg at %6.2f %6.2f, key-frame %4zu, %3u of %3u %s\n",
                frame.t_s, word_for(frame), frame.is_keyframe ? "KF" : "  ", error_of(frame).c_str(), frame.sigma_m,
                frame.sigma_rad * kDegrees, p.x(), p.y(), static_cast<std::size_t>(frame.reference), frame.inliers,
                frame.matches, frame.reason.c_str());
  }
}

}  // namespace lapis::slam::benchmark
