#pragma once

#include <memory>
#include <optional>

#include "common/messages/labels.hpp"
#include "common/runtime/context.hpp"
#include "segmenter/model_yaml.hpp"
#include "segmenter/segmentation_worker.hpp"
#include "segmenter/segmenter_config.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls itself so
class App;
}

namespace lapis::segmenter {

/// Labels colour images by a network: each one in lock-step, else the newest whenever the network is free.
class SegmenterComponent {
 public:
  using Config = SegmenterConfig;
  static constexpr const char* kName = "segmenter";
  static constexpr const char* kSummary = "Labels of colour images by an ONNX network.";

  static void add_options(CLI::App& app, Config& config);

  SegmenterComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  using Image = sensor_msgs::msg::Image;

  struct Cost {
    std::uint64_t images = 0;
    double wall_s = 0.0;
    double cpu_s = 0.0;
  };

  void store(messages::ColorMessage color);
  void work(const runtime::Cycle& cycle);
  void publish(const SegmentedImage& image);
  void report_cost();
  void drop(const std::string& reason);

  runtime::Context& context_;
  ModelFile file_;
  dds::Publisher<Image>& labels_;
  dds::Publisher<vision_msgs::msg::LabelInfo>& label_info_;
  dds::Publisher<Image>* confidence_ = nullptr;  // null: the network gives labels alone

  std::optional<messages::ColorMessage> newest_;  // not segmented yet
  std::optional<time::Time> stamp_;               // of the newest image that was stored
  Cost total_;
  Cost recent_;  // since the last report
  std::unique_ptr<SegmentationWorker> worker_;
};

}  // namespace lapis::segmenter
