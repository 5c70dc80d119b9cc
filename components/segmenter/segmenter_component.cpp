#include "segmenter/segmenter_component.hpp"

#include <CLI/CLI.hpp>

#include <spdlog/fmt/fmt.h>

#include <stdexcept>
#include <utility>

#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"

namespace lapis::segmenter {
namespace {

constexpr double kReportPeriod_s = 10.0;
constexpr double kLongestStart_s = 120.0;  // to read a network and run it once

ModelFile read_model(const SegmenterConfig& config) {
  if (config.model.empty()) {
    throw std::runtime_error(
        "no model given (segmenter.model); call: lapis_segmenter MODEL.yaml (components/segmenter/README.md)");
  }
  return read_model_file(config.model);
}

}  // namespace

void SegmenterComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("model", config.model, "YAML file that names the network and its classes");
}

SegmenterComponent::SegmenterComponent(const Config& config, runtime::Context& context)
    : context_(context), file_(read_model(config)), labels_(context.advertise(topics::kLabels)),
      label_info_(context.advertise(topics::kLabelInfo)) {
  const Model& model = file_.model;
  if (model.output.values != Values::kLabels) confidence_ = &context.advertise(topics::kLabelConfidence);
  set_threads(config.threads);
  {
    const runtime::LongWork work(context.heart(), "reads the network", kLongestStart_s);
    worker_ = std::make_unique<SegmentationWorker>(model, [&context] { context.executor().wake(); });
  }
  const OutputShape& output = worker_->segmenter().output();
  spdlog::info("{}: input {} x {}, output {} x {}, {} label classes", model.network.string(), model.input.width,
               model.input.height, output.width, output.height, file_.labels.size());
  label_info_.publish(messages::to_message(file_.labels, {}, ""));
  if (context.options().is_color_compressed) {
    context.require(context.subscribe(topics::kCompressedColor, [this](auto& m) { store(std::move(m)); }));
  } else {
    context.require(context.subscribe(topics::kColor, [this](auto& m) { store(std::move(m)); }));
  }
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
  context.every(kReportPeriod_s, [this] { report_cost(); });
  context.status().set(runtime::Status::Level::kOk, "waits for colour images");
}

/// The newest image wins. In lock-step a tick has one, which comes again when a participant is late.
void SegmenterComponent::store(messages::ColorMessage color) {
  const auto& header = std::visit(
      [](const auto& message) -> const auto& { return message.header(); }, color);
  const time::Time stamp = messages::from_message(header.stamp());
  if (stamp_ == stamp) return drop("stamp was there before");
  if (newest_) context_.status().count("colour replaced: a newer image came while the network worked");
  stamp_ = stamp;
  newest_ = std::move(color);
}

void SegmenterComponent::work(const runtime::Cycle& cycle) {
  if (const auto done = worker_->take(cycle.inputs_complete)) publish(*done);
  if (worker_->is_busy() || !newest_) return;
  worker_->begin(std::move(*newest_));
  newest_.reset();
  if (!cycle.inputs_complete) return;
  if (const auto done = worker_->take(true)) publish(*done);
}

void SegmenterComponent::publish(const SegmentedImage& image) {
  if (!image.segmentation) return drop(image.segmentation.reason);
  const Segmentation& segmentation = *image.segmentation;
  labels_.publish(messages::to_label_image(segmentation.labels, image.header));
  if (confidence_ != nullptr) confidence_->publish(messages::to_image(segmentation.confidence, "mono8", image.header));
  if (segmentation.unusable > 0) {
    context_.status().count("pixels unlabelled: the network's output is not a number", segmentation.unusable);
  }
  for (Cost* cost : {&total_, &recent_}) {
    ++cost->images;
    cost->wall_s += image.wall_s;
    cost->cpu_s += image.cpu_s;
  }
  context_.status().set(runtime::Status::Level::kOk, "labels images");
  context_.status().value("frames", total_.images);
  context_.status().value("wall_ms", fmt::format("{:.1f}", 1e3 * image.wall_s));
  context_.status().value("cpu_ms", fmt::format("{:.1f}", 1e3 * image.cpu_s));
}

void SegmenterComponent::report_cost() {
  if (recent_.images == 0) return;
  const auto images = static_cast<double>(recent_.images);
  const std::string text = fmt::format("{} images labelled, {:.1f} ms each ({:.1f} ms of CPU)", total_.images,
                                       1e3 * recent_.wall_s / images, 1e3 * recent_.cpu_s / images);
  spdlog::info(text);
  context_.heart().set_progress(text);
  recent_ = {};
}

void SegmenterComponent::drop(const std::string& reason) {
  context_.status().count("colour dropped: " + reason);
  if (context_.rate_limit().pass(reason)) spdlog::warn("colour image dropped: {}", reason);
}

void SegmenterComponent::finish() {
  recent_ = total_;
  report_cost();
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
}

}  // namespace lapis::segmenter

template int lapis::runtime::run_component<lapis::segmenter::SegmenterComponent>(int argc, char** argv);
