#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/schema.hpp"
#include "common/runtime/context.hpp"
#include "common/runtime/counted_inputs.hpp"

namespace lapis::runtime {

struct LockstepConfig {
  config::Words stages;
  double soft_timeout_s = 5.0;
  double hard_timeout_s = 30.0;
  std::string silent_participant = "abort";
};

template <class Field>
void describe(Field& field, LockstepConfig& c) {
  field("stages", c.stages, config::anything(),
        "names of the participants, in the order in which a tick passes through them");
  field("soft_timeout_s", c.soft_timeout_s, config::in_range(0.1, 600.0),
        "time without an answer from a participant after which frame and tick are published again [s]");
  field("hard_timeout_s", c.hard_timeout_s, config::in_range(0.1, 3600.0),
        "time without an answer from a participant, busy or not, after which silent_participant applies [s]");
  field("silent_participant", c.silent_participant, config::one_of({"abort", "wait", "demote"}),
        "what a silent participant leads to: abort ends the run, wait waits 60 s (or hard_timeout_s, if longer) "
        "for it, demote continues without it");
}

/// The clock's side of lock-step (docs/architecture.md). Its owner publishes a frame and /clock, calls begin(), and
/// publishes the next frame when the driver is idle again; in between, the tick is released to one stage after another.
/// Idle also means that all samples that participants published for the owner (commands) have been received; before the
/// first frame, this applies to latched samples only.
class LockstepDriver {
 public:
  enum class State { kJoining, kIdle, kWaiting, kFailed };

  /// `republish` publishes the samples of the current tick (frame and /clock) again: for a participant that is late, or
  /// for one that has been restarted and has not received them.
  /// Throws std::runtime_error where sensor topics are written by best effort.
  LockstepDriver(Context& context, const LockstepConfig& config, std::function<void()> republish);

  void begin(time::Time stamp, bool is_final);
  /// Begins a new run, which the participants join again; answers to the old run are ignored.
  void restart();
  /// Updates and returns the state; to be called after handlers have run.
  State state();
  /// The reason why the state is kFailed, which names the silent participants and the remedy.
  const std::string& failure() const { return failure_; }
  /// Longest wall-clock time of a tick so far [s].
  double longest_tick_s() const { return longest_tick_s_; }
  /// CPU time of each participant, summed over its answers of this run [ms].
  const std::map<std::string, double>& cpu_ms() const { return cpu_ms_; }
  /// Participants without which this run or an earlier one continued, with the tick that they did not answer.
  const std::map<std::string, std::uint64_t>& demoted() const { return demoted_; }

 private:
  using Clock = std::chrono::steady_clock;
  using Ack = lapis_msgs::msg::Ack;

  void on_ack(const Ack& ack);
  void check_time();
  void publish_tick();
  void publish_frame_again();
  void release_stage();
  void forget_the_dead();
  void admit_newcomers();
  void advance();
  bool has_answered(const std::string& participant) const;
  bool have_all_answered() const;
  bool is_matched(const Ack& ack) const;
  bool is_everybody_matched() const;
  bool are_outputs_received() const;
  std::vector<std::string> silent() const;
  const lapis_msgs::msg::TopicCount* missing_output(const Ack& ack) const;
  std::string describe_silence(double silence_s) const;
  void give_up(double silence_s);
  void fail(const std::string& reason);

  Context& context_;
  LockstepConfig config_;
  std::function<void()> republish_;
  std::optional<dds::Publisher<lapis_msgs::msg::Tick>> tick_;  // its GID names the run
  dds::Subscription<Ack> acks_;
  State state_ = State::kJoining;
  std::string failure_;
  CountedInputs outputs_;
  std::map<std::string, Ack> last_ack_;   // by participant
  std::map<std::string, Ack> newcomers_;  // joined in the middle of a run; our samples do not reach them yet
  std::map<std::string, std::uint64_t> demoted_;
  std::uint64_t number_ = 0;
  std::uint32_t stage_ = 0;
  time::Time stamp_;
  bool is_final_ = false;
  Clock::time_point tick_began_;
  Clock::time_point stage_began_;
  Clock::time_point tick_published_;
  Clock::time_point frame_published_;
  double longest_tick_s_ = 0.0;
  std::map<std::string, double> cpu_ms_;
};

}  // namespace lapis::runtime
