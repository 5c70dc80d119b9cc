#include "common/dds/participant.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "common/dds/endpoint_qos.hpp"
#include "common/dds/participant_listener.hpp"
#include "common/dds/shared_memory.hpp"
#include "common/dds/type_support.hpp"
#include "idl/rmw_dds_common.hpp"

namespace lapis::dds {
namespace {

using compat::IPLocator;
using compat::rtps::Locator_t;

// How long a silent participant counts as there. Safety goes by the age of data, never by this.
constexpr std::int64_t kLeaseNs = 3'000'000'000;
// That of ROS 2. Only the server drops who is silent, and tells those that it reaches: a process that is cut off keeps
// its readers when they have dropped it. It takes for received what they then ask for anew (Fast DDS 2.9), so that a
// map that was sent before the cut would stay incomplete.
constexpr std::int64_t kLeaseByServerNs = 20'000'000'000;
// Fast DDS reserves memory for a hundred samples of each topic, and takes sequences for 100 long, those in sequences,
// too: 8 MB for a sample of /slam/get_type_descriptionReply.
constexpr std::uint32_t kMostReservedBytes = 4096;
constexpr std::uint32_t kSharedMemorySegmentBytes = 16u << 20;  // ten times the largest image

Locator_t peer_locator(const std::string& address) {
  Locator_t locator;
  if (!IPLocator::setIPv4(locator, address)) {
    throw std::runtime_error("ROS_STATIC_PEERS: '" + address + "' is not an IPv4 address");
  }
  return locator;
}

void add_udp(const ParticipantOptions& options, const LinkSettings& link, const std::shared_ptr<PacketGuard>& guard,
             compat::fdds::DomainParticipantQos& qos) {
  auto udp = std::make_shared<compat::UDPv4TransportDescriptor>();
  udp->sendBufferSize = udp->receiveBufferSize = static_cast<std::uint32_t>(options.socket_buffer_bytes);
  udp->maxMessageSize = static_cast<std::uint32_t>(link.message_bytes);
  udp->maxInitialPeersRange = kPeersPerHost;
  if (stays_on_host(options.discovery)) udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(std::make_shared<compat::InspectedTransportDescriptor>(udp, guard));
}

void add_shared_memory(compat::fdds::DomainParticipantQos& qos) {
  auto shared = std::make_shared<compat::SharedMemTransportDescriptor>();
  shared->segment_size(kSharedMemorySegmentBytes);
  qos.transport().user_transports.push_back(shared);
}

void apply_pace(const LargeSettings& large, compat::fdds::DomainParticipantQos& qos) {
  if (large.bytes_per_period == 0 || !compat::kHasFlowControllers) return;
  auto pace = std::make_shared<eprosima::fastdds::rtps::FlowControllerDescriptor>();
  pace->name = kPaceName;
  pace->scheduler = eprosima::fastdds::rtps::FlowControllerSchedulerPolicy::ROUND_ROBIN;
  pace->max_bytes_per_period = large.bytes_per_period;
  pace->period_ms = static_cast<std::uint64_t>(large.pace_period_ms);
  qos.flow_controllers().push_back(pace);
}

// Mirrors what Jazzy's rmw_fastrtps does for the same environment (ros2-interop 3.1).
void apply_discovery(const DiscoverySettings& discovery, compat::fdds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.readerHistoryMemoryPolicy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  builtin.writerHistoryMemoryPolicy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  builtin.discovery_config.leaseDuration = compat::duration(discovery.has_server ? kLeaseByServerNs : kLeaseNs);
  builtin.discovery_config.leaseDuration_announcementperiod = compat::duration(1'000'000'000);
  if (discovery.range != DiscoveryRange::kSubnet) {
    // A unicast locator keeps Fast DDS from adding the default multicast one.
    builtin.metatrafficUnicastLocatorList.push_back(Locator_t());
  } else if (!discovery.static_peers.empty()) {
    // A list of peers replaces the default multicast peer, so the list must contain it, too.
    Locator_t multicast = peer_locator("239.255.0.1");
    multicast.port = 7400u + 250u * static_cast<std::uint32_t>(discovery.domain);
    builtin.initialPeersList.push_back(multicast);
  }
  if (discovery.range == DiscoveryRange::kLocalhost) builtin.initialPeersList.push_back(peer_locator("127.0.0.1"));
  if (discovery.range != DiscoveryRange::kOff) {
    for (const auto& peer : discovery.static_peers) builtin.initialPeersList.push_back(peer_locator(peer));
  }
}

compat::fdds::DomainParticipant* create_participant(int domain, const compat::fdds::DomainParticipantQos& qos,
                                                    compat::fdds::DomainParticipantListener* listener = nullptr) {
  auto* factory = compat::fdds::DomainParticipantFactory::get_instance();
  auto* participant =
      factory->create_participant(static_cast<std::uint32_t>(domain), qos, listener, compat::fdds::StatusMask::none());
  if (participant == nullptr) {
    throw std::runtime_error("DDS participant could not be created in domain " + std::to_string(domain) +
                             "; see the Fast DDS message above");
  }
  return participant;
}

rmw_dds_common::msg::Gid to_message(const Gid& gid) {
  rmw_dds_common::msg::Gid message;
  message.data(gid);
  return message;
}

}  // namespace

class Participant::Listener : public ParticipantListener {
 public:
  Listener(Peers& peers, Endpoints* endpoints, Bell& changes)
      : peers_(peers), endpoints_(endpoints), changes_(changes) {}
  void found(const FoundParticipant& participant) override { peers_.add(participant.gid, participant.user_data); }
  void lost(const Gid& participant) override {
    change([&](Endpoints& endpoints) { endpoints.remove_participant(participant); });
  }
  void found(Endpoint endpoint) override {
    change([&](Endpoints& endpoints) { endpoints.add(std::move(endpoint)); });
  }
  void lost_endpoint(const Gid& endpoint) override {
    change([&](Endpoints& endpoints) { endpoints.remove(endpoint); });
  }

 private:
  template <class Action>
  void change(const Action& action) {
    if (endpoints_ == nullptr) return;
    action(*endpoints_);
    changes_.ring();
  }

  Peers& peers_;
  Endpoints* endpoints_;  // null: nobody wants to know
  Bell& changes_;
};

Participant::Participant(const ParticipantOptions& options)
    : options_(options), link_(options.link.value_or(link_of(options.discovery, options.transport))),
      pace_(compat::kHasFlowControllers ? link_.large : LargeSettings{}), peers_(options.discovery.run),
      guard_(std::make_shared<PacketGuard>(options.discovery)),
      listener_(std::make_unique<Listener>(peers_, options.watches_endpoints ? &endpoints_ : nullptr, changes_)) {
  compat::fdds::DomainParticipantQos qos;
  qos.name("/");  // the enclave, which is also the name that rmw_fastrtps gives its participants
  std::string user_data = "enclave=/;";
  if (!peers_.run().empty()) user_data += "run=" + peers_.run() + ";";
  qos.user_data().setValue(std::vector<unsigned char>(user_data.begin(), user_data.end()));
  add_udp(options, link_, guard_, qos);
  apply_pace(link_.large, qos);
  apply_discovery(options.discovery, qos);
  compat::announce_no_type_information(qos);
  join(qos);
  peers_.add(gid(), user_data);
  publisher_ = participant_->create_publisher(compat::fdds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(compat::fdds::SUBSCRIBER_QOS_DEFAULT);
  using Info = rmw_dds_common::msg::ParticipantEntitiesInfo;
  using Support = idl::TypeSupport<Info>;
  auto& graph_topic = topic("ros_discovery_info", Support::kDdsName, make_type_support<Info>());
  graph_writer_ = publisher_->create_datawriter(&graph_topic, writer_qos(kLatched, Support::kHash));
  if (graph_writer_ == nullptr) throw std::runtime_error("DDS writer of ros_discovery_info could not be created");
}

/// Creates the participant, by shared memory too if that is wanted and has room.
void Participant::join(compat::fdds::DomainParticipantQos qos) {
  const compat::fdds::DomainParticipantQos by_udp = qos;
  const SharedMemory memory;
  std::optional<SharedMemory::Turn> turn;
  if (options_.transport == Transport::kSharedMemory) {
    turn.emplace(memory);
    memory.reap(*turn);
    shared_memory_obstacle_ = memory.obstacle(kSharedMemorySegmentBytes);
    if (shared_memory_obstacle_.empty()) add_shared_memory(qos);
  }
  participant_.reset(create_participant(options_.discovery.domain, qos, listener_.get()));
  // Fast DDS announces a participant before it listens, and other participants answer only the first announcement. So a
  // second participant is created and deleted, and the first one hears the answers to its announcement: decision 0029.
  compat::fdds::DomainParticipantFactory::get_instance()->delete_participant(
      create_participant(options_.discovery.domain, by_udp));
}

Participant::~Participant() = default;

void Participant::Deleter::operator()(compat::fdds::DomainParticipant* participant) const {
  participant->delete_contained_entities();
  compat::fdds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

/// Each filter has a name of its own, because a writer applies a filter of that name that its own process has.
compat::fdds::ContentFilteredTopic& Participant::filter(compat::fdds::Topic& topic, compat::SignatureFilter& filter) {
  const std::string name = "lapis/" + to_text(gid()) + "/" + std::to_string(++filters_);
  participant_->register_content_filter_factory(name.c_str(), &filter);
  auto* filtered = participant_->create_contentfilteredtopic(name, &topic, "signature", {}, name.c_str());
  if (filtered == nullptr) throw std::runtime_error("DDS topic " + topic.get_name() + " could not be filtered");
  return *filtered;
}

void Participant::drop(compat::fdds::ContentFilteredTopic& topic) {
  const std::string name = topic.get_name();
  participant_->delete_contentfilteredtopic(&topic);
  participant_->unregister_content_filter_factory(name.c_str());
}

compat::fdds::Topic& Participant::topic(const std::string& dds_name, const std::string& type_name,
                                        compat::fdds::TypeSupport type) {
  if (auto* known = participant_->lookup_topicdescription(dds_name)) {
    if (known->get_type_name() != type_name) {
      throw std::runtime_error("topic " + dds_name + " is already in use with type " + known->get_type_name());
    }
    return *static_cast<compat::fdds::Topic*>(known);
  }
  compat::announce_no_type_information(type);
  compat::reserved_bytes(type) = std::min(compat::reserved_bytes(type), kMostReservedBytes);
  type.register_type(participant_.get(), type_name);
  auto* topic = participant_->create_topic(dds_name, type_name, compat::fdds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw std::runtime_error("DDS topic " + dds_name + " could not be created");
  return *topic;
}

Gid Participant::gid() const { return to_gid(participant_->guid()); }

std::string Participant::describe_other_run(const std::string& run) const {
  return "run " + run + " is in DDS domain " + std::to_string(options_.discovery.domain) +
         ", too: what it publishes is refused; ROS_DOMAIN_ID gives one of the two another domain";
}

void Participant::announce_graph() {
  rmw_dds_common::msg::NodeEntitiesInfo node;
  node.node_namespace("/" + options_.names.name_space);
  node.node_name(options_.node_name);
  for (const auto& reader : readers_) node.reader_gid_seq().push_back(to_message(reader));
  for (const auto& writer : writers_) node.writer_gid_seq().push_back(to_message(writer));
  rmw_dds_common::msg::ParticipantEntitiesInfo info;
  info.gid(to_message(gid()));
  info.node_entities_info_seq().push_back(node);
  compat::rtps::WriteParams params;
  compat::write(*graph_writer_, &info, params);
}

int effective_socket_buffer_bytes(int wanted) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (socket < 0) return 0;
  int smallest = wanted;
  for (const int option : {SO_RCVBUF, SO_SNDBUF}) {
    int granted = 0;
    socklen_t size = sizeof granted;
    setsockopt(socket, SOL_SOCKET, option, &wanted, sizeof wanted);
    getsockopt(socket, SOL_SOCKET, option, &granted, &size);
    // Linux doubles the size for its own book-keeping and reports the doubled value.
    smallest = std::min(smallest, granted / 2);
  }
  ::close(socket);
  return smallest;
}

}  // namespace lapis::dds
