#pragma once

#include <functional>
#include <future>
#include <optional>
#include <thread>

#include "common/messages/camera.hpp"
#include "segmenter/core/segmenter.hpp"

namespace lapis::segmenter {

/// What became of a colour image.
struct SegmentedImage {
  std_msgs::msg::Header header;  ///< of the colour image
  messages::Converted<Segmentation> segmentation;
  double wall_s = 0.0;  ///< decoding included
  double cpu_s = 0.0;   ///< of the whole process meanwhile: the network may use several threads
};

/// Segments one image at a time in a thread of its own. For use by one thread; the destructor waits for the image.
class SegmentationWorker {
 public:
  /// @param on_done called from the worker's thread when take() has something
  SegmentationWorker(const Model& model, std::function<void()> on_done);

  const Segmenter& segmenter() const { return segmenter_; }
  /// True from begin() until the result has been taken.
  bool is_busy() const { return result_.valid(); }
  /// Must not be called while busy.
  void begin(messages::ColorMessage color);
  /// The result, once there is one; `waits`: after a wait if there is work under way.
  std::optional<SegmentedImage> take(bool waits);

 private:
  SegmentedImage segment(const messages::ColorMessage& color);

  Segmenter segmenter_;
  std::function<void()> on_done_;
  std::future<SegmentedImage> result_;
  std::jthread thread_;  // last member, because it uses the others
};

}  // namespace lapis::segmenter
