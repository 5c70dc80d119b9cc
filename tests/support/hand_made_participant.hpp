#pragma once

#include <string>
#include <vector>

#include "common/topics/lockstep.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {

/// A participant of lock-step whose answers the test decides on. Joining is answered as often as asked.
class HandMadeParticipant {
 public:
  using Ack = lapis_msgs::msg::Ack;
  using Tick = lapis_msgs::msg::Tick;

  HandMadeParticipant(TopicProbe& probe, std::string name)
      : probe_(probe), name_(std::move(name)), acks_(probe.advertise(topics::kAck)) {
    probe.listen<Tick>(topics::kTick, [this](Tick& tick) {
      ticks.push_back(tick);
      if (tick.tick() == 0) answer(tick);
    });
  }

  /// A tick with that number or a later one.
  bool wait_for_tick(std::uint64_t number) {
    return probe_.wait_until([&] { return !ticks.empty() && ticks.back().tick() >= number; });
  }
  /// DONE, unless the test changes it.
  Ack answer_to(const Tick& tick) const {
    Ack ack;
    ack.run_gid(tick.run_gid());
    ack.tick(tick.tick());
    ack.stage(tick.stage());
    ack.participant(name_);
    ack.participant_gid(probe_.participant().gid());
    return ack;
  }
  /// DONE, with this many samples of a writer of the probe.
  Ack answer_to(const Tick& tick, const dds::Writer& writer, std::uint64_t samples) const {
    Ack ack = answer_to(tick);
    ack.counts().resize(1);
    ack.counts()[0].topic(writer.dds_name());
    ack.counts()[0].writer_gid(writer.gid());
    ack.counts()[0].count(samples);
    return ack;
  }
  Ack busy_with(const Tick& tick, const std::string& reason) const {
    Ack ack = answer_to(tick);
    ack.status(lapis_msgs::msg::Ack_Constants::STATUS_BUSY);
    ack.reason(reason);
    return ack;
  }
  void publish(const Ack& ack) { acks_.publish(ack); }
  void answer(const Tick& tick) { publish(answer_to(tick)); }

  std::vector<Tick> ticks;

 private:
  TopicProbe& probe_;
  std::string name_;
  dds::Publisher<Ack>& acks_;
};

}  // namespace lapis::test
