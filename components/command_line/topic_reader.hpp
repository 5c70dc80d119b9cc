#pragma once

#include <string>

#include "command_line/domain.hpp"
#include "common/cdr/layout.hpp"
#include "common/dds/raw.hpp"

namespace lapis::command_line {

/// A topic that somebody publishes.
struct FoundTopic {
  std::string name;      ///< as users see it
  std::string dds_name;  ///< on the wire
  std::string dds_type;
  std::string type;  ///< ROS name
  std::string type_hash;
  dds::Gid writer{};  ///< of the first of its writers
  dds::Qos qos;       ///< what all its writers offer
};

/// Waits for a writer of a topic. Throws Failure, which says what there is instead, when none comes, or when the topic
/// cannot be read as bytes.
FoundTopic find_topic(Domain& domain, const std::string& name);

/// Reads the topic from now on.
dds::RawSubscription& read(Domain& domain, const FoundTopic& topic, dds::RawSubscription::Handler handler);

/// The fields of a topic's messages: of this build's type, or, where it has none or another one, as the publisher's
/// node describes it. Throws Failure when nobody knows them.
cdr::Layout layout_of(Domain& domain, const FoundTopic& topic);

}  // namespace lapis::command_line
