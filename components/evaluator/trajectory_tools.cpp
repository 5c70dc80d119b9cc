#include "evaluator/trajectory_tools.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <string>

#include "common/report/report.hpp"
#include "evaluator/core/trajectory/ate.hpp"
#include "evaluator/core/trajectory/rpe.hpp"

namespace lapis::evaluator {
namespace {

using nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

const std::map<std::string, Alignment> kAlignments = {
    {"none", Alignment::kNone}, {"origin", Alignment::kOrigin}, {"se3", Alignment::kSe3}};
const std::map<std::string, AssociationRule> kRules = {{"nearest", AssociationRule::kNearest},
                                                       {"interpolate", AssociationRule::kInterpolate}};
const std::map<std::string, DeltaUnit> kUnits = {
    {"s", DeltaUnit::kSeconds}, {"m", DeltaUnit::kMetres}, {"frames", DeltaUnit::kFrames}};
const std::map<std::string, MotionError> kMotionErrors = {{"benchmark", MotionError::kBenchmark},
                                                          {"paper", MotionError::kPaper}};

struct PairOptions {
  std::string reference;
  std::string estimate;
  std::string association = "nearest";
  double max_difference_s = 0.02;
  bool as_json = false;
};

struct AteOptions : PairOptions {
  std::string align;
};

struct RpeOptions : PairOptions {
  double delta = 1.0;
  std::string unit = "s";
  std::string motion_error = "benchmark";
};

struct MatchedPair {
  Trajectory reference;
  Trajectory estimate;
  std::vector<Match> matches;
};

void add_pair_options(CLI::App& tool, PairOptions& options) {
  tool.add_option("--reference", options.reference,
                  "ground-truth trajectory, a TUM text file: timestamp tx ty tz qx qy qz qw")
      ->required();
  tool.add_option("--estimate", options.estimate, "trajectory to judge, a TUM text file")->required();
  tool.add_option(
          "--association", options.association,
          "rule that assigns true poses to estimated ones: nearest (one-to-one by time stamp, the TUM benchmark's\n"
          "rule) or interpolate (true pose at the estimate's stamp, as the evaluator judges runs)")
      ->check(CLI::IsMember(kRules))
      ->capture_default_str();
  tool.add_option("--max-difference", options.max_difference_s,
                  "largest difference in time to the nearest true pose; other estimates are left out [s]")
      ->check(CLI::Range(1e-9, 1e6))
      ->capture_default_str();
  tool.add_flag("--json", options.as_json, "print JSON with all digits instead of text");
}

std::string stamps_of(const Trajectory& trajectory) {
  return time::to_string(trajectory.front().stamp) + " s to " + time::to_string(trajectory.back().stamp) + " s";
}

MatchedPair load_pair(const PairOptions& options) {
  MatchedPair pair;
  pair.reference = trajectory::read_trajectory(options.reference);
  pair.estimate = trajectory::read_trajectory(options.estimate);
  const AssociationConfig config{kRules.at(options.association),
                                 time::Duration::from_seconds(options.max_difference_s)};
  pair.matches = associate(pair.reference, pair.estimate, config);
  if (pair.matches.empty()) {
    throw std::runtime_error("no pose of " + options.estimate + " (" + stamps_of(pair.estimate) +
                             ") is near in time to one of " + options.reference + " (" + stamps_of(pair.reference) +
                             "); check that both use one clock, or raise --max-difference");
  }
  return pair;
}

ordered_json to_json(const ErrorStatistics& s, double factor = 1.0) {
  return {{"rmse", s.rmse * factor}, {"mean", s.mean * factor}, {"median", s.median * factor},
          {"std", s.std * factor},   {"min", s.min * factor},   {"max", s.max * factor}};
}

ordered_json to_json(const PairOptions& options, const MatchedPair& pair) {
  return {{"reference", options.reference},
          {"estimate", options.estimate},
          {"reference_poses", pair.reference.size()},
          {"estimate_poses", pair.estimate.size()},
          {"reference_path_length_m", path_length_m(pair.reference)},
          {"estimate_path_length_m", path_length_m(pair.estimate)},
          {"association", options.association},
          {"max_difference_s", options.max_difference_s},
          {"matched_pairs", pair.matches.size()}};
}

ordered_json to_json(const geometry::Pose& T) {
  const Eigen::Vector3d t = T.translation();
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  return {{"translation_m", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

void run_ate(const AteOptions& options, std::ostream& out) {
  const MatchedPair pair = load_pair(options);
  const AbsoluteError error = *absolute_error(pair.matches, kAlignments.at(options.align));
  ordered_json result = to_json(options, pair);
  result["align"] = options.align;
  result["T_reference_estimate"] = to_json(error.T_reference_estimate);
  result["position_m"] = to_json(error.position_m);
  result["heading_rad"] = to_json(error.heading_rad);
  report::print(out, result, options.as_json);
}

void run_rpe(const RpeOptions& options, std::ostream& out) {
  const MatchedPair pair = load_pair(options);
  const RelativeErrorConfig config{options.delta, kUnits.at(options.unit), kMotionErrors.at(options.motion_error)};
  if (config.unit == DeltaUnit::kFrames && config.delta != std::floor(config.delta)) {
    throw std::runtime_error("--delta must be a whole number with --unit frames");
  }
  const auto error = relative_error(pair.estimate, pair.matches, config);
  if (!error) {
    throw std::runtime_error(options.estimate + ": no interval of " + std::to_string(options.delta) + " " +
                             options.unit + " lies inside the matched poses; give a smaller --delta");
  }
  ordered_json result = to_json(options, pair);
  result["delta"] = options.delta;
  result["unit"] = options.unit;
  result["motion_error"] = options.motion_error;
  result["intervals"] = error->intervals.size();
  result["translation_m"] = to_json(error->translation_m);
  result["rotation_deg"] = to_json(error->rotation_rad, kDegreesPerRadian);
  report::print(out, result, options.as_json);
}

}  // namespace

void add_ate_tool(CLI::App& app, std::ostream& out) {
  auto options = std::make_shared<AteOptions>();
  CLI::App* tool = app.add_subcommand("ate", "absolute trajectory error of one TUM file against another");
  add_pair_options(*tool, *options);
  tool->add_option("--align", options->align,
                   "alignment of the trajectories: se3 (least squares over all positions, without scale),\n"
                   "origin (first poses) or none (both are in one frame)")
      ->required()
      ->check(CLI::IsMember(kAlignments));
  tool->footer(
      "Example:\n"
      "  lapis_evaluator ate --reference run/trajectory_ground_truth.txt --estimate run/trajectory_estimate.txt \\\n"
      "      --align se3 --json");
  tool->callback([options, &out] { run_ate(*options, out); });
}

void add_rpe_tool(CLI::App& app, std::ostream& out) {
  auto options = std::make_shared<RpeOptions>();
  CLI::App* tool = app.add_subcommand("rpe", "relative pose error (drift) over intervals of fixed length");
  add_pair_options(*tool, *options);
  tool->add_option("--delta", options->delta, "length of the intervals, in the unit of --unit")
      ->check(CLI::Range(1e-6, 1e9))
      ->capture_default_str();
  tool->add_option("--unit", options->unit, "unit of --delta: s, m (path of the reference) or frames (matched poses)")
      ->check(CLI::IsMember(kUnits))
      ->capture_default_str();
  tool->add_option("--error", options->motion_error,
                   "error of an interval, where A is the estimated and B the true motion: benchmark = A*B^-1 (the TUM\n"
                   "benchmark's tool), paper = B^-1*A (Sturm et al. 2012, evo)")
      ->check(CLI::IsMember(kMotionErrors))
      ->capture_default_str();
  tool->footer(
      "Example:\n"
      "  lapis_evaluator rpe --reference groundtruth.txt --estimate estimate.txt --delta 1 --unit m --error paper");
  tool->callback([options, &out] { run_rpe(*options, out); });
}

}  // namespace lapis::evaluator
