#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/dds/executor.hpp"
#include "common/dds/publisher.hpp"
#include "common/dds/service.hpp"
#include "common/dds/subscription.hpp"
#include "common/logging/logging.hpp"
#include "common/logging/rate_limit.hpp"
#include "common/runtime/heart.hpp"
#include "common/runtime/status.hpp"
#include "common/time/clock.hpp"
#include "idl/diagnostic_msgs.hpp"
#include "idl/rosgraph_msgs.hpp"

namespace lapis::runtime {

class LockstepParticipant;

/// One cycle of a component's work. Handlers only store their input; the work is done in the cycle.
struct Cycle {
  /// In lock-step: all inputs of this tick have arrived; what is missing was not published. False: more may come.
  bool inputs_complete = false;
  /// In lock-step: no input follows; finish all pending work.
  bool is_final = false;
};

/// Thrown when a bad set-up shows only with the first data: the process ends with the same exit status as for any other
/// bad set-up.
struct BadSetup : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ContextOptions {
  std::string name;
  dds::ParticipantOptions participant;
  bool use_sim_time = false;
  bool is_color_compressed = false;
  bool is_depth_compressed = false;
};

/// What the runtime provides to a component: endpoints, clock and status. For use on the component's only thread.
class Context {
 public:
  explicit Context(const ContextOptions& options);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  template <class Message>
  dds::Publisher<Message>& advertise(const dds::Topic<Message>& topic) {
    auto publisher = std::make_unique<dds::Publisher<Message>>(participant_, topic);
    auto& reference = *publisher;
    writers_.push_back(std::move(publisher));
    return reference;
  }
  template <class Message>
  dds::Subscription<Message>& subscribe(const dds::Topic<Message>& topic,
                                        typename dds::Subscription<Message>::Handler handler) {
    auto subscription = std::make_unique<dds::Subscription<Message>>(participant_, topic, std::move(handler));
    auto& reference = *subscription;
    executor_.add(*subscription);
    sources_.push_back(std::move(subscription));
    return reference;
  }
  /// A source or a writer that the component has made itself; it is counted in lock-step like others.
  void add(std::unique_ptr<dds::Source> source);
  void add(std::unique_ptr<dds::Writer> writer);
  /// Another participant, for endpoints of the component that cannot use participant(): one participant knows one type
  /// support for each type. Whoever adds it announces its graph.
  dds::Participant& add_participant(const dds::ParticipantOptions& options);
  template <class Service>
  void serve(const dds::ServiceTopic<Service>& service, typename dds::ServiceServer<Service>::Handler handler) {
    auto server = std::make_unique<dds::ServiceServer<Service>>(participant_, service, std::move(handler));
    executor_.add(*server);
    services_.push_back(std::move(server));
  }
  /// Sets the function that is called after handlers have run, or, in lock-step, when a tick's inputs are complete.
  void on_cycle(std::function<void(const Cycle&)> cycle) { cycle_ = std::move(cycle); }
  /// Names the topic in the log and on /diagnostics whenever nothing has come on it for a while, in free run.
  void require(dds::Source& source) { required_.push_back({&source}); }
  /// Which required topics nothing comes on, and why; empty when all come.
  std::string silent_topics() const;
  /// Calls `action` every `period_s` seconds of wall-clock time.
  void every(double period_s, std::function<void()> action);

  Status& status() { return status_; }
  Heart& heart() { return heart_; }
  logging::RateLimit& rate_limit() { return rate_limit_; }
  time::Time now() const { return clock_.now(); }
  /// True while the process works on its inputs as they come, not in lock-step.
  bool is_free() const;
  const std::string& name() const { return options_.name; }
  const ContextOptions& options() const { return options_; }
  /// Frame id as in messages, remapped and with the robot's namespace: "map" -> "robot1/map".
  std::string frame(const std::string& id) const;
  dds::Executor& executor() { return executor_; }
  dds::Participant& participant() { return participant_; }
  const std::vector<std::unique_ptr<dds::Writer>>& writers() const { return writers_; }
  const std::vector<std::unique_ptr<dds::Source>>& sources() const { return sources_; }

  /// End the process: finish() with status 0 because the work is done, fail() with status 1 and the reason.
  void finish();
  void fail(const std::string& reason);
  int exit_status() const { return exit_status_; }
  /// True when somebody waits for the end at a terminal (SIGINT): output that can be produced later is left out.
  bool is_in_a_hurry() const { return is_in_a_hurry_; }

  /// Used by the runtime only: announces the endpoints, then handles events until the end.
  void run();
  /// Used by the runtime only, from any thread: ends run().
  void stop(bool is_in_a_hurry);

 private:
  friend class LockstepParticipant;
  void run_cycle(const Cycle& cycle);
  struct RequiredTopic {
    dds::Source* source;
    std::string silence = {};  // what was reported; empty: it is not silent
  };
  void follow_sensor_writers();
  void watch_required_topics();
  std::string silence_of(const dds::Source& source) const;
  void publish_diagnostics();
  void report_process(diagnostic_msgs::msg::DiagnosticStatus& entry) const;
  void report_writer(const dds::Writer& writer, diagnostic_msgs::msg::DiagnosticStatus& entry);
  void report_source(const dds::Source& source, diagnostic_msgs::msg::DiagnosticStatus& entry);
  void report_strangers(diagnostic_msgs::msg::DiagnosticStatus& entry);
  void report_dropped_packets(diagnostic_msgs::msg::DiagnosticStatus& entry);
  template <class Endpoint>
  void add_incompatible(const Endpoint& endpoint, diagnostic_msgs::msg::DiagnosticStatus& entry);

  ContextOptions options_;
  time::Clock clock_;
  dds::Participant participant_;
  std::vector<std::unique_ptr<dds::Participant>> more_participants_;  // they outlive their endpoints
  dds::Executor executor_;
  Status status_;
  Heart heart_;
  logging::RateLimit rate_limit_;
  std::vector<std::unique_ptr<dds::Writer>> writers_;
  std::vector<std::unique_ptr<dds::Source>> sources_;
  std::vector<std::unique_ptr<dds::Source>> services_;
  std::vector<RequiredTopic> required_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::unique_ptr<dds::Publisher<diagnostic_msgs::msg::DiagnosticArray>> diagnostics_;
  std::unique_ptr<dds::Subscription<rosgraph_msgs::msg::Clock>> clock_source_;
  std::unique_ptr<LockstepParticipant> lockstep_;
  std::function<void(const Cycle&)> cycle_;
  int exit_status_ = 0;
  std::atomic<bool> is_in_a_hurry_{false};
};

}  // namespace lapis::runtime
