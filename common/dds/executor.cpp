#include "common/dds/executor.hpp"

#include <algorithm>

namespace lapis::dds {

Executor::Executor() { wait_set_.attach_condition(guard_); }

void Executor::add(Source& source) {
  sources_.push_back(&source);
  wait_set_.attach_condition(source.condition());
}

void Executor::every(Clock::duration period, std::function<void()> action) {
  timers_.push_back({period, Clock::now() + period, std::move(action)});
}

void Executor::at(Clock::time_point due, std::function<void()> action) {
  timers_.push_back({Clock::duration::zero(), due, std::move(action)});
}

void Executor::spin() {
  while (!stopping_) spin_once(std::chrono::seconds(1));
  for (Source* source : sources_) source->dispatch();  // samples that arrived before the stop
}

void Executor::spin_once(Clock::duration timeout) {
  const auto patience = std::chrono::duration_cast<std::chrono::nanoseconds>(until_next_timer(timeout));
  compat::fdds::ConditionSeq active;
  wait_set_.wait(active, compat::duration(patience.count()));
  bool worked = guard_.get_trigger_value();
  if (worked) guard_.set_trigger_value(false);  // an unconditional reset could lose a wake() that came in between
  for (Source* source : sources_) worked |= source->dispatch() > 0;
  worked |= run_due_timers();
  if (worked && cycle_ && !stopping_) cycle_();
}

void Executor::stop() {
  stopping_ = true;
  wake();
}

void Executor::wake() { guard_.set_trigger_value(true); }

Executor::Clock::duration Executor::until_next_timer(Clock::duration longest) const {
  const auto now = Clock::now();
  for (const auto& timer : timers_) longest = std::min(longest, std::max(timer.due - now, Clock::duration::zero()));
  return longest;
}

bool Executor::run_due_timers() {
  std::vector<std::function<void()>> due;  // actions may add timers
  const auto now = Clock::now();
  std::erase_if(timers_, [&](Timer& timer) {
    if (timer.due > now) return false;
    due.push_back(timer.action);
    timer.due = std::max(timer.due + timer.period, now);
    return timer.period == Clock::duration::zero();
  });
  for (const auto& action : due) action();
  return !due.empty();
}

}  // namespace lapis::dds
