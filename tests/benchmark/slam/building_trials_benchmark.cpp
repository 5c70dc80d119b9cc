// Trials of slam in any building, without DDS, a row each.
//   lapis_slam_building_trials --kinds carried --scenes office_1,clinic_3 --world config/worlds/w.yaml --last 5
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "simulator/set_up.hpp"
#include "tests/benchmark/slam/carried_trial.hpp"
#include "tests/benchmark/slam/dark_trial.hpp"
#include "tests/benchmark/slam/heading_trial.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"

namespace lapis::slam::benchmark {
namespace {

struct Options {
  std::vector<std::string> kinds{"carried"};
  std::vector<std::string> scenes{"apartment"};
  int first = 1, last = 5;
  std::vector<std::string> worlds;
  std::vector<std::string> overrides;
  std::string folder = "recordings";
  double longest_s = 0.0;
  bool with_stretches = false;
  bool with_frames = false;
};

// Of all trials of one kind.
struct Tally {
  int trials = 0, passed = 0, wrong = 0, failed_to_run = 0;

  void count(bool has_passed, bool is_wrong) {
    ++trials;
    if (has_passed) ++passed;
    if (is_wrong) ++wrong;
  }
};

void print_course(const Options& options, const WatchedMap& map, const std::vector<WatchedFrame>& frames, double from_s,
                  bool is_bad) {
  for (const std::string& remark : map.remarks) std::printf("    %s\n", remark.c_str());
  if (options.with_frames) {
    print_frames(frames);
  } else if (options.with_stretches && is_bad) {
    print_stretches(frames, from_s);
  }
  std::fflush(stdout);
}

void print_carried(const std::string& scene, int trial, const CarriedTrial& course, const CarriedVerdict& v) {
  std::printf(
      "carried %-12s %4d | lifted %6.1f s, set down %5.1f m off at %6.2f %6.2f %4.0f dg; before %5.2f m %3.0f dg | "
      "lost "
      "after %5.1f s | found after %5.1f s, %5.1f m | off by > 1 m: vision %5.1f s, surfaces %5.1f s, odometry %5.1f "
      "s, "
      "once lost %5.1f s | loops %3zu, wrong %zu, removed %zu; key-frames %zu, far %zu | %s%s\n",
      scene.c_str(), trial, course.frames[course.lifted].t_s, course.carried_m, course.place.position.x(),
      course.place.position.y(), course.place.yaw_rad * kDegrees, v.before.m, v.before.rad * kDegrees, v.declared_s,
      v.found_s, v.found_m, v.wrong_vision_s, v.wrong_surfaces_s, v.wrong_odometry_s, v.wrong_return_s,
      course.map.loops, course.map.wrong_loops, course.map.removed, course.map.keyframes, course.map.far_keyframes,
      v.is_found ? "found" : "NOT FOUND", v.is_wrong ? ", WRONG" : "");
}

void print_elsewhere(const std::string& scene, int trial, const CarriedTrial& course, const ElsewhereVerdict& v) {
  const WatchedMap& map = course.map;
  std::printf(
      "elsewhere %-12s %4d | lifted %6.1f s, set down %5.1f m off | sub-map after %5.1f s | joined after %6.1f s, "
      "%5.1f m (known %5.1f m, seen again over %4.1f m), off by %6.2f m %4.0f dg | sub-maps %zu, joined %zu, given up "
      "%zu | loops %3zu, wrong %zu; key-frames %zu, far %zu, unconnected %zu | CPU lost %4.1f ms, tracked %4.1f ms | "
      "%s%s%s\n",
      scene.c_str(), trial, course.frames[course.lifted].t_s, course.carried_m, v.begun_s, v.joined_s, v.joined_m,
      v.known_m, v.seen_m, v.joined.m, v.joined.rad * kDegrees, map.parts.begun, map.parts.joined, map.parts.given_up,
      map.loops, map.wrong_loops, map.keyframes, map.far_keyframes, map.unconnected, v.lost_ms, v.tracked_ms,
      v.has_begun ? "" : "AT ONCE, ", v.is_found ? "found" : "NOT FOUND", v.is_wrong ? ", WRONG" : "");
}

void print_heading(const std::string& scene, int trial, const HeadingTrial& t, const HeadingVerdict& v) {
  const auto &bent = t.bent.map, &straight = t.straight.map;
  std::printf(
      "heading %-12s %4d | blind %5.1f to %5.1f s, heading %+5.1f dg | right again after %5.1f s | ATE of key-frames "
      "%5.1f "
      "cm, without the error %5.1f cm, ratio %5.2f | loops %3zu (%3zu), wrong %zu (%zu), removed %zu (%zu); key-frames "
      "%zu, far %zu | %s%s\n",
      scene.c_str(), trial, t.stretch.from_s, t.stretch.to_s, t.stretch.heading_error_rad * kDegrees, v.right_again_s,
      100.0 * bent.ate_m, 100.0 * straight.ate_m, v.ratio, bent.loops, straight.loops, bent.wrong_loops,
      straight.wrong_loops, bent.removed, straight.removed, bent.keyframes, bent.far_keyframes,
      v.is_passed ? "pass" : "FAIL", v.is_wrong ? ", WRONG" : "");
}

void print_dark(const std::string& scene, int trial, const BlindStretch& cover, const BlindTour& tour,
                const BlindTour& plain, const DarkVerdict& v) {
  std::printf(
      "dark    %-12s %4d | covered %5.1f to %5.1f s: odometry %5.2f s, lost %5.2f s, then off by %5.1f cm %4.1f dg, "
      "sigma %5.1f cm %4.1f dg | vision after %5.2f s, off by > 1 m for %5.1f s | end %5.1f cm %4.1f dg; ATE of "
      "key-frames %5.1f cm, uncovered "
      "%5.1f cm | loops %3zu, wrong %zu, removed %zu | %s%s\n",
      scene.c_str(), trial, cover.from_s, cover.to_s, v.odometry_s, v.lost_s, 100.0 * v.drift.m, v.drift.rad * kDegrees,
      100.0 * v.sigma_m, v.sigma_rad * kDegrees, v.vision_s, v.wrong_s, 100.0 * v.end.m, v.end.rad * kDegrees,
      100.0 * tour.map.ate_m, 100.0 * plain.map.ate_m, tour.map.loops, tour.map.wrong_loops, tour.map.removed,
      v.is_passed ? "pass" : "FAIL", v.is_wrong ? ", WRONG" : "");
}

// One building, entered by trials with numbers.
class Building {
 public:
  Building(const std::string& scene, const Options& options)
      : options_(options), setting_(tour_config(options.overrides, options.worlds)), scene_(scene) {
    setting_.simulated.scene = scene;
  }

  void run(const std::string& kind, int trial, Tally& tally) {
    if (kind == "carried") return carry(trial, tally);
    if (kind == "elsewhere") return carry_elsewhere(trial, tally);
    if (kind == "heading") return turn_heading(trial, tally);
    cover(trial, tally);
  }

 private:
  CarriedTrial drive(int trial, const Carry& carry) {
    auto config = setting_.simulated;
    config.seed = trial;
    const TourSetting tour{world(), simulation_config(config), tour_config(config), start_pose(world(), config),
                           options_.longest_s};
    return drive_carried(tour, setting_.slam.method, carry);
  }

  void carry_elsewhere(int trial, Tally& tally) {
    const Carry carry{false, true, 0.5, 0.7, 3.0, 120.0, 3.0, true, 2.0};
    const CarriedTrial course = drive(trial, carry);
    const ElsewhereVerdict verdict = judge_elsewhere(course);
    print_elsewhere(scene_, trial, course, verdict);
    note(course, verdict, tally);
  }

  void carry(int trial, Tally& tally) {
    const CarriedTrial course = drive(trial, {});
    const CarriedVerdict verdict = judge(course);
    print_carried(scene_, trial, course, verdict);
    note(course, verdict, tally);
  }

  template <class Verdict>
  void note(const CarriedTrial& course, const Verdict& verdict, Tally& tally) {
    tally.count(verdict.is_found, verdict.is_wrong);
    print_course(options_, course.map, course.frames, course.frames[course.lifted].t_s,
                 !verdict.is_found || verdict.is_wrong);
  }

  void turn_heading(int trial, Tally& tally) {
    auto config = setting_.simulated;
    config.tour = write_round_tour(world(), config, options_.longest_s, options_.folder);
    const HeadingTrial course =
        play_heading(config, options_.folder, setting_.slam.method, static_cast<std::uint64_t>(trial));
    const HeadingVerdict verdict = judge(course);
    tally.count(verdict.is_passed, verdict.is_wrong);
    print_heading(scene_, trial, course, verdict);
    print_course(options_, course.bent.map, course.bent.frames, 0.0, !verdict.is_passed || verdict.is_wrong);
  }

  void cover(int trial, Tally& tally) {
    const auto seed = static_cast<std::uint64_t>(trial);
    auto config = setting_.simulated;
    config.duration_s = options_.longest_s;
    if (!plain_) plain_ = play_blind(config, options_.folder, setting_.slam.method, {});
    const BlindStretch covered = draw_cover(plain_->frames.back().t_s, seed);
    const BlindTour tour = play_blind(config, options_.folder, setting_.slam.method, covered);
    const DarkVerdict verdict = judge(tour, covered, plain_->frames, config.wheels.odometry);
    tally.count(verdict.is_passed, verdict.is_wrong);
    print_dark(scene_, trial, covered, tour, *plain_, verdict);
    print_course(options_, tour.map, tour.frames, covered.from_s, !verdict.is_passed || verdict.is_wrong);
  }

  const simulator::World& world() {
    if (!world_) world_.emplace(simulator::open_world(setting_.simulated));
    return *world_;
  }

  const Options& options_;
  TourConfig setting_;
  std::string scene_;
  std::optional<simulator::World> world_;
  std::optional<BlindTour> plain_;  // its tour without a cover
};

Tally run_kind(const std::string& kind, const Options& options) {
  Tally tally;
  for (const std::string& scene : options.scenes) {
    Building building(scene, options);
    for (int trial = options.first; trial <= options.last; ++trial) {
      try {
        building.run(kind, trial, tally);
      } catch (const std::exception& error) {
        std::printf("%-7s %-12s %4d failed to run: %s\n", kind.c_str(), scene.c_str(), trial, error.what());
        ++tally.failed_to_run;
      }
    }
  }
  return tally;
}

// Wilson's interval (95 %) of a share, in percent.
std::string interval(int count, int of) {
  constexpr double kQuantile = 1.96;
  const double n = of, p = count / n, z2 = kQuantile * kQuantile;
  const double middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kQuantile * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n)) / (1.0 + z2 / n);
  char text[48];
  std::snprintf(text, sizeof text, "%.1f to %.1f %%", 100.0 * (middle - half), 100.0 * (middle + half));
  return text;
}

int run(const Options& options) {
  bool is_good = true;
  for (const std::string& kind : options.kinds) {
    const Tally tally = run_kind(kind, options);
    std::printf("%s: %d of %d passed (%s), wrong %d (%s), failed to run %d\n", kind.c_str(), tally.passed, tally.trials,
                interval(tally.passed, tally.trials).c_str(), tally.wrong, interval(tally.wrong, tally.trials).c_str(),
                tally.failed_to_run);
    is_good = is_good && tally.failed_to_run == 0 && tally.wrong == 0;
  }
  return is_good ? 0 : 1;
}

constexpr const char* kHelp =
    R"(Trials of slam in any building, without DDS; the trial's number draws what happens, and noise; a row each.
  carried   On a tour through all rooms, in its second half, the robot is lifted for 2 s (the camera sees nothing, the
            wheels stand still) and set down at a place it has been to, at least 3 m away; it drives on through all rooms.
            Passed: within 120 s it is found (a pose by vision or surfaces within 0.3 m and 10 degrees of the truth, and
            for 2 s from there every frame has one). Wrong: once it had been lost, vision or surfaces gave poses that err
            by more than 1 m for more than 2 s, or the map has a wrong loop at the end.
  elsewhere The same without odometry, lifted after 50 to 70 % of the tour, and set down where it has not been: 4 m from
            its path. Passed: it has poses again (as above, within 120 s of driving through all rooms, the known ones first). Wrong: as above,
            or key-frames of the map err by more than 1 m at the end.
  heading   A tour that comes back to its start and drives its first legs again is played twice. Both are blind for the same
            2 to 5 s within the first 20 s; in one of them odometry's heading gains an error of 5 to 10 degrees meanwhile.
            Passed: the ATE (SE(3)) of its key-frames is at most 1.5 times the other's. Wrong: its map has a wrong loop.
  dark      The camera is covered for 20 s of a tour. Passed: never lost meanwhile, and vision is back within 2 s of the
            first frame afterwards in which it gives the pose without a cover, too. In a world without odometry: vision is
            back before the tour ends. Wrong: from then on vision or surfaces gave poses that err by more than 1 m for
            more than 2 s, or a wrong loop.
The last two play recordings, one for each scene; --set simulator.seed=N for another one. Blind: black, without depth.
Exit status 1 when any trial is wrong or cannot be run.
Tuning uses generated buildings with seeds below 10000 (docs/buildings.md).)";

}  // namespace
}  // namespace lapis::slam::benchmark

int main(int argc, char** argv) {
  using lapis::slam::benchmark::Options;
  CLI::App app(lapis::slam::benchmark::kHelp);
  Options options;
  app.add_option("--kinds", options.kinds)
      ->delimiter(',')
      ->check(CLI::IsMember({"carried", "elsewhere", "heading", "dark"}));
  app.add_option("--scenes", options.scenes, "bundled names, generated buildings or files")->delimiter(',');
  app.add_option("--first", options.first, "number of the first trial in each");
  app.add_option("--last", options.last, "number of the last trial");
  app.add_option("--world", options.worlds, "file of config/worlds: what wheels and camera are like")->delimiter(',');
  app.add_option("--set", options.overrides, "slam.KEY=VALUE, simulator.KEY=VALUE or robot.KEY=VALUE");
  app.add_option("--recordings", options.folder, "of heading and dark: keep the frames of tours here, 0.7 MB each")
      ->capture_default_str();
  app.add_option("--duration", options.longest_s, "cut tours [s]; of heading: leave out rooms; 0: whole tours")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--stretches", options.with_stretches, "of trials that fail also a line for each stretch of one source");
  app.add_flag("--frames", options.with_frames, "also a line for each frame");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    return lapis::slam::benchmark::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
