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
  dds::Qos qos;  ///< what all its writers offer
};

/// Waits for a writer of a topic. Throws Failure, which says what there is instead, when none comes, or when the topic
/// cannot be read as bytes.
FoundTopic find_topic(Domain& domain, const std::string& name);

/// Reads the topic from now on.
dds::RawSubscription& read(Domain& domain, const FoundTopic& topic, dds::RawSubscription::Handler handler);

/// The fields of a type by its ROS name. Throws Failure when this build does not know it.
cdr::Layout layout_of(const std::string& type);

}  // namespace lapis::command_line
