#include "segmenter/segmentation_worker.hpp"

#include <chrono>
#include <ctime>
#include <utility>

namespace lapis::segmenter {
namespace {

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

SegmentationWorker::SegmentationWorker(const Model& model, std::function<void()> on_done)
    : segmenter_(model), on_done_(std::move(on_done)) {}

void SegmentationWorker::begin(messages::ColorMessage color) {
  std::promise<SegmentedImage> promise;
  result_ = promise.get_future();
  thread_ = std::jthread([this, promise = std::move(promise), color = std::move(color)]() mutable {
    try {
      promise.set_value(segment(color));
    } catch (...) {  // for example, out of memory: take() throws it
      promise.set_exception(std::current_exception());
    }
    on_done_();
  });
}

std::optional<SegmentedImage> SegmentationWorker::take(bool waits) {
  if (!is_busy()) return std::nullopt;
  if (!waits && result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return result_.get();
}

SegmentedImage SegmentationWorker::segment(const messages::ColorMessage& color) {
  using Result = messages::Converted<Segmentation>;
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const double cpu_s = process_cpu_s();
  const auto image = std::visit([](const auto& message) { return messages::to_color(message); }, color);
  SegmentedImage out{std::visit([](const auto& message) { return message.header(); }, color),
                     image ? Result(segmenter_.segment(*image)) : Result::refused(image.reason)};
  out.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
  out.cpu_s = process_cpu_s() - cpu_s;
  return out;
}

}  // namespace lapis::segmenter
