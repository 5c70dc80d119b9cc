#pragma once

#include <functional>
#include <utility>

#include "common/dds/reader.hpp"
#include "common/dds/topic.hpp"
#include "common/dds/type_support.hpp"

namespace lapis::dds {

/// A reader that passes the samples it takes to a handler; the executor drives it.
class Source : public Reader {
 public:
  using Reader::Reader;
  /// Takes all samples that are available and calls the handler for each; returns the number of samples, including
  /// those that only end a key.
  virtual std::size_t dispatch() = 0;
};

/// Receives the messages of one topic of the topic table. The handler runs on the executor's thread and may move from
/// the message.
template <class Message>
class Subscription : public Source {
 public:
  using Handler = std::function<void(Message&)>;

  Subscription(Participant& participant, const Topic<Message>& topic, Handler handler)
      : Source(participant, lapis::dds::dds_name(topic, participant.name_space()), Support::kDdsName,
               make_type_support<Message>(), Support::kHash, topic.qos),
        handler_(std::move(handler)) {}

  std::size_t dispatch() override {
    std::size_t count = 0;
    compat::fdds::SampleInfo info;
    for (auto taken = take(&message_, info); taken != Taken::kNothing; taken = take(&message_, info)) {
      if (taken == Taken::kSample) handler_(message_);
      ++count;
    }
    return count;
  }

 private:
  using Support = idl::TypeSupport<Message>;
  Handler handler_;
  Message message_;
};

}  // namespace lapis::dds
