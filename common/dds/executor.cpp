#include "common/dds/executor.hpp"

#include <algorithm>

namespace lapis::dds {

Executor::Executor() { wait_set_.attach_condition(guard_); }

void Executor::add(Source& source) {
  sources_.push_back(&source);
  wait_set_.attach_condition(source.condition());
}

void Executor::become_best_effort(Source& source) {
  wait_set_.detach_condition(source.condition());
  source.become_best_effort();
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
  constexpr int kLastTurns = 100;  // for the samples that arrived before the stop; a flood would have no end
  for (int turn = 0; turn < kLastTurns && dispatch_all() > 0; ++turn) {
  }
  for (Source* source : sources_) source->finish();
}

void Executor::spin_once(Clock::duration timeout) {
  const auto longest = has_more_ ? Clock::duration::zero() : until_next_timer(timeout);
  const auto patience = std::chrono::duration_cast<std::chrono::nanoseconds>(longest);
  compat::fdds::ConditionSeq active;
  wait_set_.wait(active, compat::duration(patience.count()));
  bool worked = guard_.get_trigger_value();
  if (worked) guard_.set_trigger_value(false);  // an unconditional reset could lose a wake() that came in between
  worked |= dispatch_all() > 0;
  worked |= run_due_timers();
  if (worked && cycle_ && !stopping_) cycle_();
}

/// Gives every source its turn; returns the number of samples.
std::size_t Executor::dispatch_all() {
  std::size_t samples = 0;
  has_more_ = false;
  for (Source* source : sources_) {
    const std::size_t taken = source->dispatch(kMostPerTurn);
    samples += taken;
    has_more_ |= taken >= kMostPerTurn;
  }
  return samples;
}

void Executor::stop() {
  stopping_ = true;
  wake();
}

void Executor::wake() { guard_.set_trigger_value(true); }

Executor::Clock::duration Executor::until_next_timer(Clock::duration longest) const {
  const auto now = Clock::now();
  const auto wait_for = [&](Clock::time_point due) {
    longest = std::min(longest, std::max(due - now, Clock::duration::zero()));
  };
  for (const auto& timer : timers_) wait_for(timer.due);
  for (const Source* source : sources_) {
    if (const auto due = source->due()) wait_for(*due);
  }
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
