#include "sensor_replay/sensor_replay_component.hpp"

#include <CLI/CLI.hpp>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iostream>

#include "common/bags/bag_reader.hpp"
#include "common/runtime/run_component.hpp"
#include "sensor_replay/bag_recording.hpp"
#include "sensor_replay/tum_recording.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr double kProgressPeriod_s = 2.0;
constexpr double kMatchingPeriod_s = 0.05;
constexpr double kFarewell_s = 2.0;  // longest wait at the end for readers that still miss the last frame

void require_data_set(const SensorReplayConfig& config) {
  if (!config.dataset.empty()) return;
  throw std::runtime_error(
      "no data set given; call: lapis_sensor_replay DATASET (a folder with rgb.txt, depth.txt, camera.yaml; or a "
      "bag of rosbag2)");
}

std::unique_ptr<Recording> open_recording(const SensorReplayConfig& config, runtime::Context& context) {
  require_data_set(config);
  if (bags::looks_like_a_bag(config.dataset)) return std::make_unique<BagRecording>(config, context);
  return std::make_unique<TumRecording>(config, context);
}

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

void SensorReplayComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("dataset", config.dataset,
                 "folder in the layout of the TUM RGB-D benchmark, with camera.yaml; or bag of rosbag2: its folder, or "
                 "a .mcap or .db3");
  app.add_option("--labels", config.class_list, "CSV file class_id,class,... that names the labels");
  app.add_option("--rate", config.rate, "speed relative to the recording; default: lock-step");
  app.add_option("--start", config.start_s, "skip this many seconds");
  app.add_option("--duration", config.duration_s, "play this many seconds");
  app.add_flag("--list", config.list, "say what the data set contains and exit");
}

std::optional<int> SensorReplayComponent::run_tool(const Config& config) {
  if (!config.list) return std::nullopt;
  require_data_set(config);
  const bool is_bag = bags::looks_like_a_bag(config.dataset);
  std::cout << (is_bag ? BagRecording::describe(config) : TumRecording::describe(config));
  return 0;
}

SensorReplayComponent::SensorReplayComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), recording_(open_recording(config, context)) {
  spdlog::info("{}: {} frames, {:.1f} s", config_.dataset, recording_->size(), recording_->length_s());
  if (config_.rate > 0.0) {
    context.every(kMatchingPeriod_s, [this] { play_by_wall_clock(); });
  } else {
    driver_ =
        std::make_unique<runtime::LockstepDriver>(context, config_.lockstep, [this] { recording_->publish_again(); });
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
    Recording::Step step = publish_next();
    while (step == Recording::Step::kSkipped) step = publish_next();
    has_ended_ = step == Recording::Step::kEnd;
    if (has_ended_) {
      longest_tick_s_ = driver_->longest_tick_s();
      closing_ = Clock::now();
      recording_->end();
    }
    driver_->begin(recording_->stamp(), has_ended_);
  }
  if (driver_->state() == State::kFailed) context_.fail(driver_->failure());
}

void SensorReplayComponent::play_by_wall_clock() {
  if (began_ || !recording_->has_readers(static_cast<std::size_t>(config_.wait_for_readers))) return;
  began_ = Clock::now();
  first_stamp_ = recording_->next_stamp();
  play_when_due();
}

/// Publishes each frame when as much time has passed since the first one as between their stamps.
void SensorReplayComponent::play_when_due() {
  const auto stamp = recording_->next_stamp();
  if (!stamp) {
    report_progress(true);
    context_.finish();
    return;
  }
  const double at_s = (*stamp - *first_stamp_).seconds() / config_.rate;
  const auto due = *began_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(at_s));
  context_.executor().at(due, [this] {
    publish_next();
    play_when_due();
  });
}

Recording::Step SensorReplayComponent::publish_next() {
  if (!began_) began_ = Clock::now();
  const Recording::Step step = recording_->publish_next();
  if (step == Recording::Step::kEnd) return step;
  ++played_;
  if (step == Recording::Step::kPublished) report_progress(false);
  return step;
}

void SensorReplayComponent::report_progress(bool is_last) {
  context_.status().value("frames", played_);
  const auto now = Clock::now();
  if (!is_last && seconds_between(reported_, now) < kProgressPeriod_s) return;
  reported_ = now;
  const double elapsed_s = seconds_between(*began_, now);
  const double rate = static_cast<double>(played_) / std::max(elapsed_s, 1e-3);
  const double left_s =
      static_cast<double>(recording_->size() - std::min(played_, recording_->size())) / std::max(rate, 1e-3);
  const std::string text =
      fmt::format("frame {} of {}, {:.1f} frames/s, {:.0f} s left", played_, recording_->size(), rate, left_s);
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
