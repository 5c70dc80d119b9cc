#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/dds/executor.hpp"
#include "common/dds/publisher.hpp"
#include "common/dds/service.hpp"
#include "common/dds/subscription.hpp"
#include "idl/rmw_dds_common.hpp"
#include "tests/support/child_process.hpp"

namespace lapis::test {

/// What every node says of itself once its endpoints exist. Not in the topic table: it belongs to ROS 2's middleware.
inline constexpr dds::Topic<rmw_dds_common::msg::ParticipantEntitiesInfo> kRosGraph{
    "ros_discovery_info", {.depth = 100, .latched = true}, "all", "on change", "ROS 2 graph", true, true};

/// Takes part in the DDS domain of a test: collects what is published and publishes what a test wants to say.
/// Nothing happens in the background: samples are taken while the test waits.
class TopicProbe {
 public:
  explicit TopicProbe(const std::string& name = "probe", const std::string& name_space = "");
  explicit TopicProbe(const dds::ParticipantOptions& options) : participant_(options) {}

  /// All samples of a topic from now on, in order of arrival. The reference stays valid as long as the probe.
  template <class Message>
  const std::vector<Message>& collect(const dds::Topic<Message>& topic) {
    auto inbox = std::make_shared<std::vector<Message>>();
    listen<Message>(topic, [inbox](Message& message) { inbox->push_back(message); });
    inboxes_.push_back(inbox);
    return *inbox;
  }
  /// Calls a handler for each sample instead.
  template <class Message>
  dds::Source& listen(const dds::Topic<Message>& topic, std::function<void(Message&)> handler) {
    sources_.push_back(std::make_unique<dds::Subscription<Message>>(participant_, topic, std::move(handler)));
    executor_.add(*sources_.back());
    return *sources_.back();
  }
  template <class Message>
  dds::Publisher<Message>& advertise(const dds::Topic<Message>& topic) {
    auto publisher = std::make_unique<dds::Publisher<Message>>(participant_, topic);
    auto& reference = *publisher;
    writers_.push_back(std::move(publisher));
    return reference;
  }
  template <class Service>
  dds::ServiceClient<Service>& client(const dds::ServiceTopic<Service>& service) {
    auto client = std::make_unique<dds::ServiceClient<Service>>(participant_, service);
    auto& reference = *client;
    executor_.add(*client);
    sources_.push_back(std::move(client));
    return reference;
  }

  /// Handles samples until the condition holds; false at the deadline.
  bool wait_until(const std::function<bool()>& condition, Seconds deadline = Seconds(10));
  /// Waits until every publisher and subscription of the probe has found at least `peers` counterparts.
  bool wait_until_matched(std::size_t peers = 1, Seconds deadline = Seconds(10));
  /// Waits until the process of that name sends to every subscription of the probe. That a subscription is matched()
  /// says only that the probe has found the writer, and what a VOLATILE writer sends to a reader that it has not found
  /// yet is lost.
  bool wait_until_known_by(const std::string& component, Seconds deadline = Seconds(10));

  dds::Participant& participant() { return participant_; }
  dds::Executor& executor() { return executor_; }

 private:
  dds::Participant participant_;
  dds::Executor executor_;
  std::vector<std::shared_ptr<void>> inboxes_;
  std::vector<std::unique_ptr<dds::Writer>> writers_;
  std::vector<std::unique_ptr<dds::Source>> sources_;
};

/// Participant options of a test's own participants: the environment's domain, on the loopback interface.
dds::ParticipantOptions participant_options(const std::string& name, const std::string& name_space = "");

}  // namespace lapis::test
