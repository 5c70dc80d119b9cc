#pragma once

#include <optional>
#include <string>

#include "common/runtime/camera_publisher.hpp"
#include "common/runtime/context.hpp"
#include "sensor_replay/conversions.hpp"
#include "sensor_replay/core/frame_prefetcher.hpp"
#include "sensor_replay/core/tum_dataset.hpp"
#include "sensor_replay/recording.hpp"
#include "sensor_replay/sensor_replay_config.hpp"

namespace lapis::sensor_replay {

/// A data set in the layout of the TUM RGB-D benchmark.
class TumRecording : public Recording {
 public:
  TumRecording(const SensorReplayConfig& config, runtime::Context& context);
  /// Summary for `--list`.
  static std::string describe(const SensorReplayConfig& config);

  std::size_t size() const override { return range_.size(); }
  double length_s() const override;
  bool has_readers(std::size_t number) override { return camera_.has_readers(number); }
  std::optional<time::Time> next_stamp() override;
  Step publish_next() override;
  void publish_again() override;
  time::Time stamp() const override { return stamp_; }
  void end() override { last_.reset(); }

 private:
  void count(const SkippedFrame& skipped);
  void count(const ImageProblem& problem);

  runtime::Context& context_;
  TumDataset dataset_;
  FrameRange range_;
  FramePrefetcher frames_;
  runtime::CameraPublisher camera_;
  std::size_t next_;  // index
  std::optional<messages::CameraMessages> last_;
  time::Time stamp_;
};

}  // namespace lapis::sensor_replay
