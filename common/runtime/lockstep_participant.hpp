#pragma once

#include <optional>
#include <string>
#include <utility>

#include "common/dds/publisher.hpp"
#include "common/dds/subscription.hpp"
#include "common/runtime/counted_inputs.hpp"

namespace lapis::runtime {

class Context;

/// A component's side of lock-step (docs/architecture.md): waits until the counted inputs of a tick have been received,
/// lets the component work, and answers with the counts of its outputs. Outside lock-step it only passes cycles on.
class LockstepParticipant {
 public:
  explicit LockstepParticipant(Context& context);

  /// The executor's cycle function, called after handlers have run.
  void after_handlers();
  /// True when cycles follow their inputs as they come: outside lock-step, and in the process that drives it.
  bool is_free() const;

 private:
  using Tick = lapis_msgs::msg::Tick;

  void on_tick(const Tick& tick);
  void leave_if_demoted(const Tick& tick);
  void answer_pending();
  bool is_active() const;
  std::string obstacle(const Tick& tick) const;
  bool are_endpoints_matched(const Tick& tick) const;
  bool is_admitted(const Tick& tick) const;
  void publish_ack(const Tick& tick, std::uint8_t status, const std::string& reason);
  void say_busy();

  Context& context_;
  dds::Publisher<lapis_msgs::msg::Ack> ack_;
  dds::Subscription<Tick> ticks_;
  dds::Gid run_{};                                                   // the driver's tick writer; zero: not in lock-step
  bool has_joined_ = false;                                          // has answered a tick of this run
  std::optional<Tick> pending_;                                      // received, not answered
  std::optional<std::pair<std::uint64_t, std::uint32_t>> answered_;  // tick and stage of the last answer
  std::uint64_t last_due_ = 0;                                       // newest tick that was due for this process
  // The run of the newest tick, whoever it was due for; the first tick of that run that was received; and whether the
  // run works without this process.
  dds::Gid watched_{};
  std::uint64_t first_watched_ = 0;
  bool is_bystander_ = false;
  CountedInputs inputs_;
  double cpu_s_at_answer_ = 0.0;
};

}  // namespace lapis::runtime
