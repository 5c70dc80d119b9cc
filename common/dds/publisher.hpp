#pragma once

#include "common/dds/topic.hpp"
#include "common/dds/type_support.hpp"
#include "common/dds/writer.hpp"

namespace lapis::dds {

/// Publishes messages of one topic of the topic table.
template <class Message>
class Publisher : public Writer {
 public:
  Publisher(Participant& participant, const Topic<Message>& topic)
      : Writer(participant, lapis::dds::dds_name(topic, participant.names()), Support::kDdsName,
               make_type_support<Message>(), Support::kHash, topic.qos) {}

  /// Returns false when DDS refuses the sample, which is counted.
  bool publish(const Message& message) { return write(&message); }
  /// Unregisters the key of `message` on a keyed topic.
  bool end_key(const Message& message) { return unregister(&message); }

 private:
  using Support = idl::TypeSupport<Message>;
};

}  // namespace lapis::dds
