#include "sensor_replay/sensor_replay_component.hpp"

#include <CLI/CLI.hpp>

#include <spdlog/fmt/fmt.h>

#include <iostream>

#include "common/runtime/run_component.hpp"
#include "sensor_replay/camera_yaml.hpp"
#include "sensor_replay/core/dataset_summary.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr double kProgressPeriod_s = 2.0;
constexpr double kMatchingPeriod_s = 0.05;
constexpr double kFarewell_s = 2.0;  // longest wait at the end for readers that still miss the last frame

TumDatasetConfig dataset_config(const SensorReplayConfig& config) {
  if (config.dataset.empty()) {
    throw std::runtime_error(
        "no data set given; call: lapis_sensor_replay DATASET (a folder with rgb.txt, depth.txt, camera.yaml)");
  }
  return {config.dataset, config.class_list, config.max_stamp_difference_s, config.labels};
}

FrameRange selected(const TumDataset& dataset, const SensorReplayConfig& config) {
  std::optional<time::Duration> duration;
  if (config.duration_s > 0.0) duration = time::Duration::from_seconds(config.duration_s);
  return dataset.select(time::Duration::from_seconds(config.start_s), duration);
}

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

void SensorReplayComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("dataset", config.dataset, "folder in the layout of the TUM RGB-D benchmark, with camera.yaml");
  app.add_option("--labels", config.class_list, "CSV file class_id,class,... that names the labels");
  app.add_option("--rate", config.rate, "speed relative to the recording; default: lock-step");
  app.add_option("--start", config.start_s, "skip this many seconds");
  app.add_option("--duration", config.duration_s, "play this many seconds");
  app.add_flag("--list", config.list, "say what the data set contains and exit");
}

std::optional<int> SensorReplayComponent::run_tool(const Config& config) {
  if (!config.list) return std::nullopt;
  std::cout << describe(TumDataset(dataset_config(config), read_camera_file));
  return 0;
}

SensorReplayComponent::SensorReplayComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), dataset_(dataset_config(config), read_camera_file),
      range_(selected(dataset_, config)),
      frames_([this](std::size_t index) { return dataset_.load_frame(index); }, range_),
      camera_(context, {dataset_.has_labels(), dataset_.has_ground_truth()}, config.rate > 0.0) {
  const auto labels = dataset_.has_labels() ? to_label_list(dataset_.classes()) : mapping::LabelList();
  camera_.publish_latched(to_set_up(dataset_.camera()), labels, dataset_.stamp(range_.begin));
  spdlog::info("{}: {} frames, {:.1f} s", config_.dataset, range_.size(),
               (dataset_.stamp(range_.end - 1) - dataset_.stamp(range_.begin)).seconds());
  if (config_.rate > 0.0) {
    context.every(kMatchingPeriod_s, [this] { play_by_wall_clock(); });
  } else {
    driver_ = std::make_unique<runtime::LockstepDriver>(context, config_.lockstep, [this] {
      if (last_) camera_.publish(*last_);
    });
    context.on_cycle([this](const runtime::Cycle&) { work(); });
  }
}

// In lock-step, publishes a frame whenever all participants have answered the last one.
void SensorReplayComponent::work() {
  using State = runtime::LockstepDriver::State;
  while (driver_->state() == State::kIdle) {
    if (has_ended_) {
      report_progress(true);
      context_.finish();
      return;
    }
    has_ended_ = !publish_next();
    if (has_ended_) {
      longest_tick_s_ = driver_->longest_tick_s();
      closing_ = Clock::now();
    }
    driver_->begin(stamp_, has_ended_);
  }
  if (driver_->state() == State::kFailed) context_.fail(driver_->failure());
}

void SensorReplayComponent::play_by_wall_clock() {
  if (began_ || !camera_.has_readers(static_cast<std::size_t>(config_.wait_for_readers))) return;
  began_ = Clock::now();
  for (std::size_t index = range_.begin; index < range_.end; ++index) {
    const double at_s = (dataset_.stamp(index) - dataset_.stamp(range_.begin)).seconds() / config_.rate;
    const auto due = *began_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(at_s));
    context_.executor().at(due, [this] { publish_next(); });
    if (index + 1 == range_.end) {
      context_.executor().at(due, [this] {
        report_progress(true);
        context_.finish();
      });
    }
  }
}

/// Publishes the next frame that has a colour image. By the wall clock, a frame without one is only counted. Returns
/// false when there is no further frame.
bool SensorReplayComponent::publish_next() {
  if (!began_) began_ = Clock::now();
  while (auto loaded = frames_.next()) {
    ++played_;
    if (const auto* skipped = std::get_if<SkippedFrame>(&*loaded)) {
      count(*skipped);
      if (driver_ == nullptr) return true;
      continue;
    }
    const auto& frame = std::get<ReplayFrame>(*loaded);
    for (const auto& problem : frame.problems) count(problem);
    stamp_ = frame.stamp;
    last_ = to_messages(frame, dataset_.camera(), camera_.ids());
    camera_.publish(*last_);
    report_progress(false);
    return true;
  }
  last_.reset();
  return false;
}

void SensorReplayComponent::count(const SkippedFrame& skipped) {
  context_.status().count("frames skipped: " + to_string(skipped.problem.fault));
  spdlog::warn("frame {} skipped: {}", skipped.index, to_string(skipped.problem));
}

void SensorReplayComponent::count(const ImageProblem& problem) {
  const std::string kind = problem.part == ImagePart::kDepth ? "depth" : "label";
  const std::string key = kind + " images unusable: " + to_string(problem.fault);
  context_.status().count(key);
  if (context_.rate_limit().pass(key)) spdlog::warn("{} image not published: {}", kind, to_string(problem));
}

void SensorReplayComponent::report_progress(bool is_last) {
  context_.status().value("frames", played_);
  const auto now = Clock::now();
  if (!is_last && seconds_between(reported_, now) < kProgressPeriod_s) return;
  reported_ = now;
  const double elapsed_s = seconds_between(*began_, now);
  const double rate = static_cast<double>(played_) / std::max(elapsed_s, 1e-3);
  const double left_s = static_cast<double>(range_.size() - played_) / std::max(rate, 1e-3);
  const std::string text =
      fmt::format("frame {} of {}, {:.1f} frames/s, {:.0f} s left", played_, range_.size(), rate, left_s);
  spdlog::info(text);
  context_.heart().set_progress(text);
}

void SensorReplayComponent::finish() {
  if (driver_ == nullptr) {
    for (const auto& writer : context_.writers()) writer->wait_until_acknowledged(kFarewell_s);
  } else if (closing_) {
    spdlog::info("longest tick {:.3f} s; the closing one, in which others finish their work, {:.3f} s", longest_tick_s_,
                 seconds_between(*closing_, Clock::now()));
  }
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
}

}  // namespace lapis::sensor_replay

template int lapis::runtime::run_component<lapis::sensor_replay::SensorReplayComponent>(int argc, char** argv);
