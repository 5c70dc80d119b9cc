// A participant as ROS 2 Jazzy's rmw_fastrtps sets it up (participant.cpp of rmw_fastrtps_shared_cpp), without any code
// of ours around Fast DDS: publishes images and prints a line per odometry, which the echo component answers with.
//   lapis_test_jazzy_like LOCALHOST|SUBNET [STATIC_PEER]
// It takes ROS_DOMAIN_ID from the environment and ends on SIGTERM.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

#include "common/dds/compat.hpp"
#include "common/dds/type_support.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::test {
namespace {

namespace compat = dds::compat;
namespace fdds = compat::fdds;

constexpr std::size_t kImageBytes = 640 * 360 * 3;  // sent in datagrams of 64 kB

volatile std::sig_atomic_t is_asked_to_stop = 0;

compat::rtps::Locator_t peer(const char* address) {
  compat::rtps::Locator_t locator;
  compat::IPLocator::setIPv4(locator, address);
  return locator;
}

/// Jazzy has shared memory beside UDP, which Lapis has not.
fdds::DomainParticipantQos qos_of(const std::string& range, const char* static_peer) {
  fdds::DomainParticipantQos qos;
  qos.name("/");
  auto udp = std::make_shared<compat::UDPv4TransportDescriptor>();
  if (range == "LOCALHOST") udp->maxInitialPeersRange = 32;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  auto& builtin = qos.wire_protocol().builtin;
  builtin.readerHistoryMemoryPolicy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  builtin.writerHistoryMemoryPolicy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  if (range == "LOCALHOST") {
    builtin.metatrafficUnicastLocatorList.push_back(compat::rtps::Locator_t());
    builtin.initialPeersList.push_back(peer("127.0.0.1"));
  }
  if (static_peer != nullptr) builtin.initialPeersList.push_back(peer(static_peer));
  compat::announce_no_type_information(qos);
  return qos;
}

template <class Message>
fdds::Topic* topic(fdds::DomainParticipant& participant, const char* name) {
  fdds::TypeSupport type = dds::make_type_support<Message>();
  compat::announce_no_type_information(type);
  type.register_type(&participant, idl::TypeSupport<Message>::kDdsName);
  return participant.create_topic(name, idl::TypeSupport<Message>::kDdsName, fdds::TOPIC_QOS_DEFAULT);
}

void run(fdds::DomainParticipant& participant) {
  auto* publisher = participant.create_publisher(fdds::PUBLISHER_QOS_DEFAULT);
  auto* subscriber = participant.create_subscriber(fdds::SUBSCRIBER_QOS_DEFAULT);
  auto* images = publisher->create_datawriter(topic<sensor_msgs::msg::Image>(participant, "rt/camera/color/image_raw"),
                                              fdds::DATAWRITER_QOS_DEFAULT);
  auto* answers = subscriber->create_datareader(topic<nav_msgs::msg::Odometry>(participant, "rt/slam/odometry"),
                                                fdds::DATAREADER_QOS_DEFAULT);
  sensor_msgs::msg::Image image;
  image.data().resize(kImageBytes);
  nav_msgs::msg::Odometry odometry;
  fdds::SampleInfo info;
  for (int count = 0; is_asked_to_stop == 0;) {
    image.header().stamp().sec(image.header().stamp().sec() + 1);
    compat::rtps::WriteParams params;
    compat::write(*images, &image, params);
    answers->wait_for_unread_message(compat::duration(100'000'000));
    while (compat::ok(answers->take_next_sample(&odometry, &info))) std::cout << "answer " << ++count << std::endl;
  }
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  using namespace lapis::test;  // NOLINT(google-build-using-namespace): the file is one program
  if (argc < 2) return 2;
  std::signal(SIGTERM, [](int) { is_asked_to_stop = 1; });
  const char* domain = std::getenv("ROS_DOMAIN_ID");  // NOLINT(concurrency-mt-unsafe): no thread yet
  auto* factory = fdds::DomainParticipantFactory::get_instance();
  auto* participant = factory->create_participant(
      static_cast<std::uint32_t>(std::strtoul(domain == nullptr ? "0" : domain, nullptr, 10)),
      qos_of(argv[1], argc > 2 ? argv[2] : nullptr));
  if (participant == nullptr) return 1;
  run(*participant);
  participant->delete_contained_entities();
  factory->delete_participant(participant);
}
