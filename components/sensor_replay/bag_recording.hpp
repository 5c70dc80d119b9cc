#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/bags/bag_reader.hpp"
#include "common/dds/raw.hpp"
#include "common/runtime/context.hpp"
#include "idl/rosgraph_msgs.hpp"
#include "sensor_replay/core/bag_frames.hpp"
#include "sensor_replay/recording.hpp"
#include "sensor_replay/sensor_replay_config.hpp"

namespace lapis::sensor_replay {

/// A bag of rosbag2: what a robot and its camera have published is published again, under the same names, byte by byte.
class BagRecording : public Recording {
 public:
  /// Throws std::runtime_error when the bag cannot be read, or lacks what a camera has to publish; the message names
  /// what the bag has.
  BagRecording(const SensorReplayConfig& config, runtime::Context& context);
  /// Summary for `--list`.
  static std::string describe(const SensorReplayConfig& config);

  std::size_t size() const override { return size_; }
  double length_s() const override { return length_s_; }
  bool has_readers(std::size_t number) override;
  std::optional<time::Time> next_stamp() override;
  Step publish_next() override;
  void publish_again() override;
  time::Time stamp() const override { return stamp_; }
  void end() override { last_.reset(); }

 private:
  /// A topic of the table that is played: its channel of the bag and its writer.
  struct Played {
    std::size_t channel = 0;
    std::optional<Role> role;  // nothing: latched
    dds::RawPublisher* writer = nullptr;
  };
  template <class Message>
  const Played* play(const dds::Topic<Message>& topic, std::optional<Role> role);
  void play_all(bool with_labels);
  void require(const Played* played, const char* topic) const;
  void publish_latched();
  void select_rest();
  void read_ahead();
  void publish(const BagFrames::Frame& frame);
  dds::RawPublisher& writer_of(std::size_t channel) const;

  const SensorReplayConfig config_;
  runtime::Context& context_;
  bags::BagReader bag_;
  std::vector<Played> played_;
  dds::RawPublisher* depth_ = nullptr;
  std::optional<BagFrames> frames_;
  dds::Publisher<rosgraph_msgs::msg::Clock>& clock_;
  std::optional<BagFrames::Frame> ahead_, last_;
  time::Time stamp_;
  std::size_t size_ = 0;
  double length_s_ = 0.0;
  std::optional<std::chrono::steady_clock::time_point> matched_since_;
};

}  // namespace lapis::sensor_replay
