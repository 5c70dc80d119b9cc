#include "common/runtime/heart.hpp"

#include <unistd.h>

#include <algorithm>
#include "common/topics/heartbeat.hpp"

namespace lapis::runtime {

Heart::Heart(dds::Participant& participant, const std::string& name) : publisher_(participant, topics::kHeartbeat) {
  message_.name(name);
  message_.pid(getpid());
  enter(Phase::kStarting);
}

void Heart::enter(Phase phase) {
  message_.phase(static_cast<std::uint8_t>(phase));
  message_.silence_s(phase == Phase::kRunning ? 0.0 : kTransition_s);
  beat();
}

void Heart::beat() { publisher_.publish(message_); }

LongWork::LongWork(Heart& heart, const std::string& activity, double longest_s)
    : heart_(heart), activity_before_(heart.message_.activity()), silence_before_s_(heart.message_.silence_s()) {
  heart.message_.activity(activity);
  heart.message_.silence_s(std::max(longest_s, silence_before_s_));
  heart.beat();
}

LongWork::~LongWork() {
  heart_.message_.activity(activity_before_);
  heart_.message_.silence_s(silence_before_s_);
  heart_.beat();
}

}  // namespace lapis::runtime
