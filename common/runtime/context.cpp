#include "common/runtime/context.hpp"

#include <sys/resource.h>

#include <algorithm>

#include "common/messages/time.hpp"
#include "common/runtime/lockstep_participant.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/lockstep.hpp"

namespace lapis::runtime {
namespace {

diagnostic_msgs::msg::KeyValue key_value(const std::string& key, const std::string& value) {
  diagnostic_msgs::msg::KeyValue pair;
  pair.key(key);
  pair.value(value);
  return pair;
}

constexpr double kWatchPeriod_s = 0.25;
constexpr std::chrono::milliseconds kLongestSilence{1500};  // of a required topic

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

}  // namespace

Context::Context(const ContextOptions& options)
    : options_(options), clock_(options.use_sim_time ? time::Clock::Kind::kSimulated : time::Clock::Kind::kSystem),
      participant_(options.participant), heart_(participant_, frame(options.name)) {
  if (const std::string& obstacle = participant_.shared_memory_obstacle(); !obstacle.empty()) {
    spdlog::warn("shared memory: {}; UDP is used instead", obstacle);
  }
  diagnostics_ =
      std::make_unique<dds::Publisher<diagnostic_msgs::msg::DiagnosticArray>>(participant_, topics::kDiagnostics);
  if (options.use_sim_time) {
    clock_source_ = std::make_unique<dds::Subscription<rosgraph_msgs::msg::Clock>>(
        participant_, topics::kClock,
        [this](auto& message) { clock_.announce(messages::from_message(message.clock())); });
    executor_.add(*clock_source_);
  }
  lockstep_ = std::make_unique<LockstepParticipant>(*this);
  executor_.set_cycle([this] { lockstep_->after_handlers(); });
  every(kWatchPeriod_s, [this] {
    follow_sensor_writers();
    watch_required_topics();
  });
  every(1.0, [this] { publish_diagnostics(); });
  every(Heart::kPeriod_s, [this] { heart_.beat(); });
}

Context::~Context() = default;

void Context::every(double period_s, std::function<void()> action) {
  const auto period =
      std::chrono::duration_cast<dds::Executor::Clock::duration>(std::chrono::duration<double>(period_s));
  executor_.every(period, std::move(action));
}

void Context::add(std::unique_ptr<dds::Source> source) {
  executor_.add(*source);
  sources_.push_back(std::move(source));
}

void Context::add(std::unique_ptr<dds::Writer> writer) { writers_.push_back(std::move(writer)); }

dds::Participant& Context::add_participant(const dds::ParticipantOptions& options) {
  return *more_participants_.emplace_back(std::make_unique<dds::Participant>(options));
}

std::string Context::frame(const std::string& id) const { return participant_.names().full(id); }

bool Context::is_free() const { return lockstep_->is_free(); }

void Context::finish() { executor_.stop(); }

void Context::fail(const std::string& reason) {
  spdlog::error("{}", reason);
  status_.set(Status::Level::kError, reason);
  publish_diagnostics();
  exit_status_ = 1;
  executor_.stop();
}

void Context::stop(bool is_in_a_hurry) {
  if (is_in_a_hurry) is_in_a_hurry_ = true;
  executor_.stop();
}

void Context::run() {
  began_ = std::chrono::steady_clock::now();
  participant_.announce_graph();
  heart_.enter(Heart::Phase::kRunning);
  spdlog::info("ready");
  executor_.spin();
  heart_.enter(Heart::Phase::kEnding);
  publish_diagnostics();
  for (const auto& source : sources_) {
    if (source->missed() > 0) spdlog::warn("missed samples {}: {}", source->dds_name(), source->missed());
  }
}

void Context::run_cycle(const Cycle& cycle) {
  if (cycle_) cycle_(cycle);
  if (status_.take_change()) publish_diagnostics();
}

/// Hears writers of sensor topics that offer less than RELIABLE. Lock-step counts samples, so it needs RELIABLE.
void Context::follow_sensor_writers() {
  if (!is_free()) return;
  for (const auto& source : sources_) {
    if (!source->wants_best_effort()) continue;
    spdlog::warn(
        "{}: a writer is BEST_EFFORT, so the topic is read BEST_EFFORT from now on, and samples may be lost; "
        "where the driver can be set to RELIABLE, do so and start this process again",
        source->dds_name());
    executor_.become_best_effort(*source);
    participant_.announce_graph();
  }
}

/// Why nothing comes on a topic; empty when something does, or may still.
std::string Context::silence_of(const dds::Source& source) const {
  const auto since = std::max(source.heard().value_or(began_), began_);
  if (!is_free() || std::chrono::steady_clock::now() - since < kLongestSilence) return "";
  if (source.matched() > 0) return "its publisher is there and silent";
  if (source.incompatible() > 0) return "the QoS of its publisher does not fit: see dds.sensor_qos";
  return "nobody publishes it: see --remap and config/cameras";
}

/// The beginning and the end of a silence are logged once.
void Context::watch_required_topics() {
  for (auto& [source, reported] : required_) {
    const std::string silence = silence_of(*source);
    if (silence == reported) continue;
    if (silence.empty()) {
      spdlog::info("{} comes again", source->dds_name());
    } else {
      spdlog::warn("nothing comes on {}: {}", source->dds_name(), silence);
    }
    reported = silence;
  }
}

std::string Context::silent_topics() const {
  std::string text;
  for (const auto& [source, silence] : required_) {
    if (!silence.empty()) text += (text.empty() ? "" : "; ") + source->dds_name() + ", " + silence;
  }
  return text;
}

template <class Endpoint>
void Context::add_incompatible(const Endpoint& endpoint, diagnostic_msgs::msg::DiagnosticStatus& entry) {
  entry.values().push_back(
      key_value("incompatible QoS " + endpoint.dds_name(), std::to_string(endpoint.incompatible())));
  if (rate_limit_.pass(endpoint.dds_name())) {
    spdlog::warn("{}: a peer was refused because of its QoS; docs/topics.md says what is needed", endpoint.dds_name());
  }
}

/// Reports datagrams that were kept away from Fast DDS.
void Context::report_dropped_packets(diagnostic_msgs::msg::DiagnosticStatus& entry) {
  for (std::size_t i = 0; i < dds::kPacketFaults; ++i) {
    const auto [count, sender] = participant_.guard().dropped(static_cast<dds::PacketFault>(i));
    if (count == 0) continue;
    const std::string name = dds::kPacketFaultNames[i];
    entry.values().push_back(key_value("dropped packets " + name, std::to_string(count)));
    if (rate_limit_.pass("dropped " + name)) {
      spdlog::warn("{} RTPS packets dropped ({}), the last of {}", count, name, sender);
    }
  }
}

/// Reports samples that were refused because of who wrote them, and other runs that have appeared in the domain.
void Context::report_strangers(diagnostic_msgs::msg::DiagnosticStatus& entry) {
  dds::Peers& peers = participant_.peers();
  if (!peers.run().empty()) entry.values().push_back(key_value("run", peers.run()));
  for (const std::string& run : peers.take_other_runs()) spdlog::warn("{}", participant_.describe_other_run(run));
  for (const dds::Source* source : executor_.sources()) {  // those of the runtime, too: /clock, /sim/tick, /sim/ack
    const auto [count, writer] = source->refused();
    if (count == 0) continue;
    entry.values().push_back(key_value("refused samples " + source->dds_name(), std::to_string(count)));
    if (rate_limit_.pass("refused " + source->dds_name())) {
      spdlog::warn("{}: {} samples refused, the last of {}; {}", source->dds_name(), count,
                   writer == dds::Gid{} ? "a writer without a run" : "writer " + dds::to_text(writer),
                   peers.kinship(writer) == dds::Kinship::kOtherRun ? "it belongs to another run"
                                                                    : "another process publishes this topic");
    }
  }
}

void Context::report_process(diagnostic_msgs::msg::DiagnosticStatus& entry) const {
  entry.level(static_cast<std::uint8_t>(status_.level()));
  entry.name(frame(options_.name));
  entry.message(status_.message());
  entry.hardware_id(options_.name);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  entry.values().push_back(key_value("cpu_s", std::to_string(seconds(usage.ru_utime) + seconds(usage.ru_stime))));
  entry.values().push_back(key_value("peak_rss_mb", std::to_string(usage.ru_maxrss / 1024)));
  for (const auto& [key, value] : status_.values()) entry.values().push_back(key_value(key, value));
  for (const auto& [key, value] : status_.counters()) entry.values().push_back(key_value(key, std::to_string(value)));
}

void Context::report_writer(const dds::Writer& writer, diagnostic_msgs::msg::DiagnosticStatus& entry) {
  if (writer.incompatible() > 0) add_incompatible(writer, entry);
  if (writer.failed() > 0) {
    entry.values().push_back(key_value("refused writes " + writer.dds_name(), std::to_string(writer.failed())));
  }
  if (writer.left_out() == 0) return;
  entry.values().push_back(key_value("left out " + writer.dds_name(), std::to_string(writer.left_out())));
  if (rate_limit_.pass("left out " + writer.dds_name())) {
    spdlog::warn("{}: {} samples left out, because the network is given less than they need", writer.dds_name(),
                 writer.left_out());
  }
}

void Context::report_source(const dds::Source& source, diagnostic_msgs::msg::DiagnosticStatus& entry) {
  if (source.incompatible() > 0) add_incompatible(source, entry);
  if (source.is_best_effort()) entry.values().push_back(key_value("best effort " + source.dds_name(), "1"));
  if (source.missed() > 0) {
    entry.values().push_back(key_value("missed samples " + source.dds_name(), std::to_string(source.missed())));
  }
}

void Context::publish_diagnostics() {
  diagnostic_msgs::msg::DiagnosticStatus entry;
  report_process(entry);
  for (const auto& writer : writers_) report_writer(*writer, entry);
  for (const auto& source : sources_) report_source(*source, entry);
  for (const auto& [source, silence] : required_) {
    if (!silence.empty()) entry.values().push_back(key_value("silent " + source->dds_name(), silence));
  }
  report_strangers(entry);
  report_dropped_packets(entry);
  if (const std::uint64_t undecodable = dds::undecodable_samples; undecodable > 0) {
    entry.values().push_back(key_value("samples that cannot be decoded", std::to_string(undecodable)));
    if (rate_limit_.pass("undecodable")) spdlog::warn("samples that cannot be decoded: {}", undecodable);
  }
  diagnostic_msgs::msg::DiagnosticArray array;
  array.header().stamp(messages::to_message(now()));
  array.status().push_back(entry);
  diagnostics_->publish(array);
}

}  // namespace lapis::runtime
