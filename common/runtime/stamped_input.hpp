#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/messages/converted.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/context.hpp"
#include "common/time/stamp_buffer.hpp"
#include "common/time/stamp_judge.hpp"

namespace lapis::runtime {

/// The messages of one topic, which wait in the order of their stamps to be joined with those of other topics. Unusable
/// messages are counted on /diagnostics by stream and reason. In free run a message whose stamp does not fit its
/// arrival waits for the next one, which decides whether the clock of the source was set. In lock-step stamps are
/// believed.
template <class Message>
class StampedInput {
 public:
  /// `name`: name of the stream in counters. `capacity`: number of messages that may wait; when there are more, the
  /// oldest is dropped. A sample of the topic is a Message or converts to one.
  template <class Sample>
  StampedInput(Context& context, const dds::Topic<Sample>& topic, std::string name, std::size_t capacity)
      : context_(context), name_(std::move(name)), buffer_(capacity),
        source_(context.subscribe(topic, [this](Sample& sample) { store(sample); })) {}
  /// The same for samples that `decode` makes messages of, or refuses with a reason.
  template <class Sample>
  StampedInput(Context& context, const dds::Topic<Sample>& topic, std::string name, std::size_t capacity,
               std::function<messages::Converted<Message>(const Sample&)> decode)
      : context_(context), name_(std::move(name)), buffer_(capacity),
        source_(context.subscribe(topic, [this, decode = std::move(decode)](const Sample& sample) {
          auto message = decode(sample);
          if (message) return store(*message);
          context_.status().count(name_ + " dropped: " + message.reason);
        })) {}
  StampedInput(const StampedInput&) = delete;
  StampedInput& operator=(const StampedInput&) = delete;

  /// Sets the function that is called for every message before it is stored.
  void on_arrival(std::function<void(time::Time stamp)> action) { on_arrival_ = std::move(action); }
  /// Sets the function that is called when the source has restarted in lock-step: its stamps went back by more than a
  /// second.
  void on_restart(std::function<void()> action) { on_restart_ = std::move(action); }
  /// Sets the function that is called in free run when the clock of the source was set, or the source has restarted:
  /// the oldest message is the first one since. `step`: how far the clock was set.
  void on_clock_set(std::function<void(time::Duration step)> action) { on_clock_set_ = std::move(action); }

  /// See Context::require.
  void require() { context_.require(source_); }
  bool has_publisher() const { return source_.matched() > 0; }
  /// Number of messages that were lost before they could be taken.
  std::uint64_t missed() const { return source_.missed(); }
  /// True when the next message would displace the oldest.
  bool is_full() const { return buffer_.is_full(); }
  bool empty() const { return buffer_.empty(); }
  /// Oldest message and its stamp; the input must not be empty.
  const std::pair<time::Time, Message>& front() const { return buffer_.front(); }
  std::pair<time::Time, Message>& front() { return buffer_.front(); }
  /// See StampBuffer::match.
  time::Match match(time::Time stamp, time::Duration tolerance, bool is_complete, Message*& found) {
    return buffer_.match(stamp, tolerance, is_complete, found);
  }
  /// See StampBuffer::second, newest, drop_until and expect_restart.
  std::optional<time::Time> newest() const { return buffer_.newest(); }
  std::optional<time::Time> second() const { return buffer_.second(); }
  std::size_t drop_until(time::Time stamp) { return buffer_.drop_until(stamp); }
  void expect_restart(time::Time stamp) { buffer_.expect_restart(stamp); }

 private:
  template <class Sample>
  void store(Sample& sample) {
    using Verdict = time::StampJudge::Verdict;
    const time::Time stamp = messages::from_message(sample.header().stamp());
    if (!context_.is_free()) return believe(stamp, Message(std::move(sample)));
    const Verdict verdict = judge_.judge(stamp, time::Arrival::clock::now());
    const bool is_stray = verdict == Verdict::kStray || (verdict == Verdict::kDoubtful && doubtful_);
    if (is_stray) count(" dropped: stamp far from those before and after it");
    if (verdict == Verdict::kDoubtful) {
      doubtful_.emplace(stamp, Message(std::move(sample)));
      return;
    }
    const bool was_set = verdict == Verdict::kStepped;
    if (was_set) {
      if (!buffer_.empty()) count(" dropped: waited when the clock of its source was set", buffer_.size());
      buffer_.begin_anew();
      put(doubtful_->first, std::move(doubtful_->second));
    }
    doubtful_.reset();
    put(stamp, Message(std::move(sample)));
    if (!was_set) return;
    count(": the clock of its source was set");
    if (on_clock_set_) on_clock_set_(judge_.step());
  }
  /// In lock-step. Free run begins anew afterwards, because the driver may have set the clock.
  void believe(time::Time stamp, Message message) {
    judge_ = {};
    if (doubtful_) put(doubtful_->first, std::move(doubtful_->second));
    doubtful_.reset();
    put(stamp, std::move(message));
  }
  void put(time::Time stamp, Message message) {
    using time::Push;
    if (on_arrival_) on_arrival_(stamp);
    const std::size_t waiting = buffer_.size();
    switch (buffer_.push(stamp, std::move(message))) {
      case Push::kStored: return;
      case Push::kDuplicate: return count(" dropped: stamp was there before");
      case Push::kLate: return count(" dropped: older than what was processed");
      case Push::kOverflow: return count(" dropped: its partners did not come");
      case Push::kRestarted:
        count(": stamps went back");
        if (waiting > 0) count(" dropped: waited when stamps went back", waiting);
        if (on_restart_ && !context_.is_free()) on_restart_();
        return;
    }
  }
  void count(const char* what, std::uint64_t number = 1) { context_.status().count(name_ + what, number); }

  Context& context_;
  std::string name_;
  time::StampBuffer<Message> buffer_;
  std::function<void(time::Time)> on_arrival_;
  std::function<void()> on_restart_;
  std::function<void(time::Duration)> on_clock_set_;
  time::StampJudge judge_;
  std::optional<std::pair<time::Time, Message>> doubtful_;
  dds::Source& source_;  // last member, because its handler uses the others
};

}  // namespace lapis::runtime
