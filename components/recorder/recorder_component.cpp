#include "recorder/recorder_component.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "common/bags/leading_stamp.hpp"
#include "common/topics.hpp"
#include "idl/type_table.hpp"

namespace lapis::recorder {
namespace {

constexpr double kDiscoveryPeriod_s = 0.1;
constexpr double kReportPeriod_s = 1.0;
constexpr std::uint64_t kMega = 1'000'000;
/// Samples that wait in a reader while this process has other work; large ones are images.
constexpr int kDepth = 1000, kLargeDepth = 200;
/// Of topics that are not in the table.
constexpr dds::Qos kForeign{.depth = 100, .sensor = true};

dds::ParticipantOptions reading_options(const runtime::Context& context) {
  dds::ParticipantOptions options = context.options().participant;
  options.node_name = "recorder_topics";
  options.watches_endpoints = true;
  return options;
}

bags::BagOptions bag_options(const RecorderConfig& config) {
  return {.storage = config.storage == "mcap" ? bags::Storage::kMcap : bags::Storage::kSqlite3,
          .mcap = {.compression_level = config.compression_level},
          .split_bytes = kMega * static_cast<std::uint64_t>(config.split_mb),
          .split_s = config.split_s};
}

/// A list of one profile, as rosbag2 writes it up to version 8 of its metadata: numbers for what rmw counts.
std::string qos_profiles(const dds::Qos& qos) {
  constexpr const char* kInfinite = "sec: 9223372036\n    nsec: 854775807\n";
  const std::string infinite = kInfinite;
  return "- history: 1\n  depth: " + std::to_string(qos.depth) + "\n  reliability: " + (qos.best_effort ? "2" : "1") +
         "\n  durability: " + (qos.latched ? "1" : "2") + "\n  deadline:\n    " + infinite + "  lifespan:\n    " +
         infinite + "  liveliness: 1\n  liveliness_lease_duration:\n    " + infinite +
         "  avoid_ros_namespace_conventions: false\n";
}

}  // namespace

void RecorderComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("output", config.output, "folder of the bag; it must not exist, or be empty");
  app.add_option("--topic", config.topics, "record this topic alone; * stands for any text (repeatable)");
  app.add_option("--exclude", config.exclude, "do not record this topic; * stands for any text (repeatable)");
  app.add_option("--storage", config.storage, "mcap or sqlite3")->check(CLI::IsMember({"mcap", "sqlite3"}));
  app.add_option("--snapshot", config.snapshot_s,
                 "keep this many seconds in memory, and write them when /recorder/snapshot is called");
}

RecorderComponent::RecorderComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), choice_{config.topics, config.exclude},
      participant_(context.add_participant(reading_options(context))) {
  if (config.output.empty()) throw std::runtime_error("no folder given; call: lapis_recorder FOLDER");
  const std::uint64_t most_bytes = kMega * static_cast<std::uint64_t>(config.memory_mb);
  if (config.snapshot_s > 0.0) {
    snapshot_.emplace(time::Duration::from_seconds(config.snapshot_s).nanoseconds, most_bytes);
    context.serve(topics::kSnapshot, [this](const auto&) { return take_snapshot(); });
  } else {
    worker_ = std::make_unique<RecordingWorker>(config.output, bag_options(config), most_bytes);
  }
  if (config.time == "clock") follow_clock();
  follow_table();
  context.every(kDiscoveryPeriod_s, [this] { follow_discovery(); });
  context.every(kReportPeriod_s, [this] { report(); });
}

/// Subscribes to the topics of Lapis before anybody publishes them, so that nothing is missed, and lock-step waits.
void RecorderComponent::follow_table() {
  topics::for_each([this](const auto& topic) {
    using Support = idl::TypeSupport<typename std::decay_t<decltype(topic)>::Type>;
    if constexpr (!Support::kIsKeyed) {
      record(participant_.names().full(topic.name, topic.is_global), Support::kDdsName, Support::kHash, topic.qos);
    }
  });
  participant_.announce_graph();
}

void RecorderComponent::follow_discovery() {
  const std::uint64_t version = participant_.endpoints().version();
  if (version == seen_version_) return;
  seen_version_ = version;
  const std::size_t before = recorded_.size();
  const auto endpoints = participant_.endpoints().all();
  for (const dds::Endpoint& endpoint : endpoints) {
    const std::string topic = dds::ros_topic_name(endpoint.topic);
    if (!endpoint.is_writer || endpoint.is_keyed || topic.empty()) continue;
    const auto is_weaker = [&](const auto& has) {
      return std::any_of(endpoints.begin(), endpoints.end(), [&](const dds::Endpoint& other) {
        return other.is_writer && other.topic == endpoint.topic && !has(other);
      });
    };
    dds::Qos qos = kForeign;
    qos.latched = !is_weaker([](const dds::Endpoint& other) { return other.is_latched; });
    qos.best_effort = is_weaker([](const dds::Endpoint& other) { return other.is_reliable; });
    record(topic, endpoint.type, dds::type_hash_of(endpoint), qos);
  }
  if (recorded_.size() > before) participant_.announce_graph();
}

/// Begins to read a topic, if it is wanted and not read yet.
void RecorderComponent::record(const std::string& topic, const std::string& dds_type, const std::string& type_hash,
                               const dds::Qos& qos) {
  const auto is_same = [&](const Recorded& other) { return other.channel.topic == topic; };
  if (!choice_.includes(topic) || std::any_of(recorded_.begin(), recorded_.end(), is_same)) return;
  const std::string type = dds::ros_type_name(dds_type);
  if (type.empty()) return;
  const idl::TypeEntry* known = idl::find(type);
  const std::string hash = type_hash.empty() && known != nullptr ? std::string(known->hash) : type_hash;
  Recorded recorded{.channel = {.topic = topic,
                                .type = type,
                                .encoding = "cdr",
                                .schema_encoding = known == nullptr ? "" : "ros2msg",
                                .schema = known == nullptr ? "" : std::string(known->ros2msg_text),
                                .type_hash = hash,
                                .offered_qos = qos_profiles(qos)},
                    .is_latched = qos.latched,
                    .source = nullptr,
                    .messages = 0,
                    .in_bag = {}};
  const std::size_t index = recorded_.size();
  dds::Qos patient = qos;  // bursts wait here, not in the writer, which may drop them
  patient.reader_depth = qos.large ? kLargeDepth : kDepth;
  auto source = std::make_unique<dds::RawSubscription>(
      participant_, dds::topic_dds_name(topic), dds_type, hash, patient,
      [this, index](const auto& bytes, const auto& info) { store(index, bytes, info); });
  recorded.source = source.get();
  recorded_.push_back(std::move(recorded));
  context_.add(std::move(source));
}

void RecorderComponent::store(std::size_t index, const dds::RawType::Bytes& bytes,
                              const dds::compat::fdds::SampleInfo& info) {
  Recorded& recorded = recorded_[index];
  ++received_;
  bags::Message message{index, recorded.messages++, context_.now().nanoseconds, info.source_timestamp.to_ns(), bytes};
  if (recorded.messages == 1) spdlog::info("records {} ({})", recorded.channel.topic, recorded.channel.type);
  if (config_.time == "system") return keep(std::move(message));
  if (!clock_ns_) return early_.push_back(std::move(message));
  message.log_time_ns = message.publish_time_ns = *clock_ns_;
  keep(std::move(message));
}

void RecorderComponent::follow_clock() {
  using Support = idl::TypeSupport<rosgraph_msgs::msg::Clock>;
  const std::string name = dds::dds_name(topics::kClock, participant_.names());
  context_.add(std::make_unique<dds::RawSubscription>(participant_, name, Support::kDdsName, Support::kHash,
                                                      topics::kClock.qos,
                                                      [this](const auto& bytes, const auto&) { set_clock(bytes); }));
}

void RecorderComponent::set_clock(const dds::RawType::Bytes& bytes) {
  const auto stamp = bags::leading_stamp(bytes);
  if (!stamp) return;
  clock_ns_ = std::max(clock_ns_.value_or(stamp->nanoseconds), stamp->nanoseconds);
  for (bags::Message& message : std::exchange(early_, {})) {
    message.log_time_ns = message.publish_time_ns = *clock_ns_;
    keep(std::move(message));
  }
}

void RecorderComponent::keep(bags::Message message) {
  Recorded& recorded = recorded_[message.channel];
  if (snapshot_) return snapshot_->add(std::move(message), recorded.is_latched);
  if (!recorded.in_bag) recorded.in_bag = worker_->add_channel(recorded.channel);
  message.channel = *recorded.in_bag;
  write(std::move(message));
}

void RecorderComponent::write(bags::Message message) {
  if (worker_->write(std::move(message), !context_.is_free())) return;
  if (const auto failure = worker_->failure()) throw std::runtime_error(*failure);
  ++without_room_;
  context_.status().count("messages lost: no room in memory");
  if (context_.rate_limit().pass("no room")) {
    spdlog::warn("messages are lost, because the disk is too slow: exclude topics, or see recorder.memory_mb");
  }
}

/// Takes what has arrived, but has not had its turn yet.
void RecorderComponent::take_waiting() {
  for (std::size_t i = 0; i < recorded_.size(); ++i) recorded_[i].source->dispatch(kDepth);
}

std_srvs::srv::Trigger_Response RecorderComponent::take_snapshot() {
  take_waiting();
  std_srvs::srv::Trigger_Response response;
  const std::filesystem::path folder =
      std::filesystem::path(config_.output) / ("snapshot_" + std::to_string(snapshots_));
  try {
    std::vector<bags::Message> messages = snapshot_->take();
    bags::BagWriter writer(folder, bag_options(config_));
    std::vector<std::optional<std::size_t>> in_bag(recorded_.size());
    for (bags::Message& message : messages) {
      auto& index = in_bag[message.channel];
      if (!index) index = writer.add_channel(recorded_[message.channel].channel);
      message.channel = *index;
      writer.write(message);
    }
    writer.close();
    ++snapshots_;
    response.success(true);
    response.message(std::to_string(messages.size()) + " messages in " + folder.string());
    spdlog::info("{}", response.message());
  } catch (const std::exception& error) {
    response.success(false);
    response.message(error.what());
    spdlog::error("{}", error.what());
  }
  return response;
}

std::uint64_t RecorderComponent::missed() const {
  std::uint64_t sum = 0;
  for (const Recorded& recorded : recorded_) sum += recorded.source->missed();
  return sum;
}

void RecorderComponent::report() {
  context_.status().value("messages", received_);
  context_.status().value("lost", missed() + without_room_);
  const auto failure = worker_ ? worker_->failure() : std::nullopt;
  if (failure) return context_.fail(*failure);
  context_.heart().set_progress(std::to_string(received_) + " messages");
}

void RecorderComponent::finish() {
  take_waiting();
  if (!early_.empty()) {
    spdlog::warn("{} messages came, but no /clock: they get the time 0", early_.size());
    set_clock({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  }
  if (worker_) worker_->close();
  if (const auto failure = worker_ ? worker_->failure() : std::nullopt) throw std::runtime_error(*failure);
  const std::uint64_t lost = missed() + without_room_;
  spdlog::info("{}: {} messages of {} topics", config_.output, worker_ ? worker_->written() : received_,
               std::count_if(recorded_.begin(), recorded_.end(), [](const auto& r) { return r.messages > 0; }));
  if (lost == 0) return;
  for (const Recorded& recorded : recorded_) {
    if (recorded.source->missed() > 0) {
      spdlog::error("{}: {} messages were lost on the way", recorded.channel.topic, recorded.source->missed());
    }
  }
  if (without_room_ > 0) spdlog::error("{} messages found no room in memory", without_room_);
  throw std::runtime_error(std::to_string(lost) + " messages are not in the bag");
}

}  // namespace lapis::recorder

template int lapis::runtime::run_component<lapis::recorder::RecorderComponent>(int argc, char** argv);
