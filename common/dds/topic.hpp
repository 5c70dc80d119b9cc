#pragma once

#include <string>

#include "common/dds/names.hpp"
#include "common/dds/qos.hpp"

namespace lapis::dds {

/// A row of the topic table (common/topics.hpp), which alone relates a name, a type and a QoS.
template <class Message>
struct Topic {
  using Type = Message;
  const char* name;  ///< ROS name ("/slam/odometry") or, for keyed topics, a plain DDS name without leading slash
  Qos qos;
  const char* from;        ///< who publishes it
  const char* rate;        ///< when
  const char* meaning;     ///< one line for docs/topics.md
  bool is_global = false;  ///< true: never prefixed by --namespace (/tf, /clock, ...)
  bool has_many_writers = false;
};

/// A service; the names of its request and reply topics derive from its name.
template <class Service>
struct ServiceTopic {
  using Type = Service;
  const char* name;
  const char* from;
  const char* meaning;
  bool is_global = false;          ///< true: never prefixed by --namespace
  bool every_call_counts = false;  ///< false: equal calls that wait together are answered as one
};

template <class Message>
std::string dds_name(const Topic<Message>& topic, const Names& names) {
  return topic_dds_name(names.full(topic.name, topic.is_global));
}

/// Name of a service as ROS 2 shows it.
template <class Service>
std::string full_name(const ServiceTopic<Service>& service, const Names& names) {
  return names.full(service.name, service.is_global);
}

}  // namespace lapis::dds
