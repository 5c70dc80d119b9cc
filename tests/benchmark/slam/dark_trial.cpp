#include "tests/benchmark/slam/dark_trial.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tests/benchmark/slam/dice.hpp"

namespace lapis::slam::benchmark {
namespace {

void judge_cover(const BlindTour& tour, const BlindStretch& cover, DarkVerdict& verdict) {
  for (std::size_t i = 1; i < tour.frames.size(); ++i) {
    const WatchedFrame& frame = tour.frames[i];
    if (frame.t_s < cover.from_s || frame.t_s >= cover.to_s) continue;
    const double period_s = frame.t_s - tour.frames[i - 1].t_s;
    if (frame.source == PoseSource::kNone) verdict.lost_s += period_s;
    if (frame.source != PoseSource::kOdometry) continue;
    verdict.odometry_s += period_s;
    verdict.drift = frame.error;
    verdict.sigma_m = frame.sigma_m;
    verdict.sigma_rad = frame.sigma_rad;
  }
}

}  // namespace

BlindStretch draw_cover(double duration_s, std::uint64_t seed) {
  constexpr double kCovered_s = 20.0, kMargin_s = 10.0;
  if (duration_s < kCovered_s + 2.0 * kMargin_s) throw std::runtime_error("the tour is too short: 40 s are needed");
  Dice dice(seed);
  const double from_s = dice.between(kMargin_s, duration_s - kMargin_s - kCovered_s);
  return {from_s, from_s + kCovered_s, 0.0};
}

DarkVerdict judge(const BlindTour& tour, const BlindStretch& cover, const std::vector<WatchedFrame>& plain,
                  bool has_odometry) {
  constexpr double kBackWithin_s = 2.0, kWrong_m = 1.0, kWrongFor_s = 2.0;
  DarkVerdict verdict;
  judge_cover(tour, cover, verdict);
  std::optional<double> could_see_s;
  for (std::size_t i = 0; i < tour.frames.size(); ++i) {
    const WatchedFrame& frame = tour.frames[i];
    if (frame.source != PoseSource::kNone) verdict.end = frame.error;
    if (frame.t_s < cover.to_s) continue;
    if (is_held(frame) && frame.error.m > kWrong_m) verdict.wrong_s += frame.t_s - tour.frames[i - 1].t_s;
    if (!could_see_s && plain[i].source == PoseSource::kVision) could_see_s = frame.t_s;
    if (could_see_s && frame.source == PoseSource::kVision) {
      verdict.vision_s = std::min(verdict.vision_s, frame.t_s - *could_see_s);
    }
  }
  verdict.is_passed =
      has_odometry ? verdict.lost_s == 0.0 && verdict.vision_s <= kBackWithin_s : std::isfinite(verdict.vision_s);
  verdict.is_wrong = tour.map.wrong_loops > 0 || verdict.wrong_s > kWrongFor_s;
  return verdict;
}

}  // namespace lapis::slam::benchmark
