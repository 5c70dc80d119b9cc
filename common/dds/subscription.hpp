#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "common/dds/reader.hpp"
#include "common/dds/topic.hpp"
#include "common/dds/type_support.hpp"

namespace lapis::dds {

/// A reader that passes the samples it takes to a handler; the executor drives it.
class Source : public Reader {
 public:
  using Reader::Reader;
  /// Takes up to `most` available samples and calls the handler for each; returns the number of samples taken,
  /// including those that only end a key and those that were refused.
  virtual std::size_t dispatch(std::size_t most) = 0;
  /// Does at the end of the process what dispatch() has put off.
  virtual void finish() {}
  /// When dispatch() has work even if no sample arrives.
  virtual std::optional<std::chrono::steady_clock::time_point> due() const { return std::nullopt; }

 protected:
  /// Takes up to `most` samples into `sample` and calls `handle(info)` for each that carries data.
  template <class Handle>
  std::size_t take_each(std::size_t most, void* sample, const Handle& handle) {
    std::size_t count = 0;
    compat::fdds::SampleInfo info;
    for (; count < most; ++count) {
      const Taken taken = take(sample, info);
      if (taken == Taken::kNothing) break;
      if (taken == Taken::kSample) handle(info);
    }
    return count;
  }
};

/// Receives the messages of one topic of the topic table. The handler runs on the executor's thread and may move from
/// the message.
template <class Message>
class Subscription : public Source {
 public:
  using Handler = std::function<void(Message&)>;

  Subscription(Participant& participant, const Topic<Message>& topic, Handler handler)
      : Source(participant, lapis::dds::dds_name(topic, participant.names()), Support::kDdsName,
               make_type_support<Message>(), Support::kHash, topic.qos,
               topic.has_many_writers ? Writers::kMany : Writers::kOne),
        handler_(std::move(handler)) {}

  std::size_t dispatch(std::size_t most) override {
    return take_each(most, &message_, [this](const auto&) { handler_(message_); });
  }

 private:
  using Support = idl::TypeSupport<Message>;
  Handler handler_;
  Message message_;
};

}  // namespace lapis::dds
