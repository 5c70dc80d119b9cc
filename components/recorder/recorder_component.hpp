#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"
#include "common/dds/raw.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/run_component.hpp"
#include "idl/std_srvs.hpp"
#include "recorder/core/snapshot_buffer.hpp"
#include "recorder/core/topic_choice.hpp"
#include "recorder/recorder_config.hpp"
#include "recorder/recording_worker.hpp"

namespace lapis::recorder {

/// Records topics of ROS 2 as bags of rosbag2: those of Lapis from the start, those of others when discovery finds
/// them.
class RecorderComponent {
 public:
  using Config = RecorderConfig;
  static constexpr const char* kName = "recorder";
  static constexpr const char* kSummary = "Records topics as bags of rosbag2 (MCAP or SQLite).";

  static void add_options(CLI::App& app, Config& config);

  RecorderComponent(const Config& config, runtime::Context& context);
  void finish();

 private:
  /// A topic that is recorded.
  struct Recorded {
    bags::Channel channel;
    bool is_latched = false;
    dds::RawSubscription* source = nullptr;
    std::uint32_t messages = 0;
    std::optional<std::size_t> in_bag;  // index in the bag, once it has a message
  };
  void follow_table();
  void follow_clock();
  void follow_discovery();
  void record(const std::string& topic, const std::string& dds_type, const std::string& type_hash, const dds::Qos& qos);
  void store(std::size_t index, const dds::RawType::Bytes& bytes, const dds::compat::fdds::SampleInfo& info);
  void set_clock(const dds::RawType::Bytes& bytes);
  void keep(bags::Message message);
  void take_waiting();
  void write(bags::Message message);
  std_srvs::srv::Trigger_Response take_snapshot();
  void report();
  std::uint64_t missed() const;

  const Config config_;
  runtime::Context& context_;
  TopicChoice choice_;
  dds::Participant& participant_;   // of the raw readers: the context's one knows some of the types as messages
  std::uint64_t seen_version_ = 0;  // of the endpoints
  std::vector<Recorded> recorded_;
  std::optional<std::int64_t> clock_ns_;     // of /clock
  std::vector<bags::Message> early_;         // that wait for the first /clock
  std::unique_ptr<RecordingWorker> worker_;  // null: snapshots
  std::optional<SnapshotBuffer> snapshot_;
  int snapshots_ = 0;
  std::uint64_t received_ = 0, without_room_ = 0;
};

}  // namespace lapis::recorder
