#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/bell.hpp"
#include "common/dds/compat.hpp"
#include "common/dds/discovery.hpp"
#include "common/dds/endpoints.hpp"
#include "common/dds/gid.hpp"
#include "common/dds/link.hpp"
#include "common/dds/names.hpp"
#include "common/dds/pace.hpp"
#include "common/dds/packet_guard.hpp"
#include "common/dds/peers.hpp"
#include "common/dds/qos.hpp"

namespace lapis::dds {

struct ParticipantOptions {
  std::string node_name;  ///< "slam"; with the namespace the node's ROS name
  Names names;
  DiscoverySettings discovery;
  Transport transport = Transport::kUdp;
  SensorQos sensor_qos = SensorQos::kAuto;
  int socket_buffer_bytes = 4 << 20;
  std::optional<LinkSettings> link;  ///< none: link_of(discovery, transport)
  bool watches_endpoints = false;    ///< keeps what discovery announces of all readers and writers
};

/// One DDS participant, which is also one ROS 2 node: its endpoints appear in `ros2 node info`.
/// Publishers and subscriptions hold a reference to it and must be destroyed before it.
class Participant {
 public:
  /// Throws std::runtime_error, which names the domain, when DDS cannot create the participant.
  explicit Participant(const ParticipantOptions& options);
  ~Participant();  // in the source file, where Listener is known
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  compat::fdds::Publisher& publisher() { return *publisher_; }
  compat::fdds::Subscriber& subscriber() { return *subscriber_; }
  /// The topic with a DDS name, created at its first use. Throws std::runtime_error when the name is in use with
  /// another type.
  compat::fdds::Topic& topic(const std::string& dds_name, const std::string& type_name, compat::fdds::TypeSupport type);

  /// A topic whose samples the filter admits. Whoever makes it drops it, after its reader and before the filter.
  compat::fdds::ContentFilteredTopic& filter(compat::fdds::Topic& topic, compat::SignatureFilter& filter);
  void drop(compat::fdds::ContentFilteredTopic& topic);

  Gid gid() const;
  /// The other participants of the domain.
  Peers& peers() { return peers_; }
  const Peers& peers() const { return peers_; }
  /// The readers and writers of the domain, its own ones included; empty unless the options ask for them.
  const Endpoints& endpoints() const { return endpoints_; }
  /// Rings after discovery has found or lost an endpoint that is watched, and after one of its own has been matched.
  Bell& changes() { return changes_; }
  /// What has been kept away from Fast DDS.
  const PacketGuard& guard() const { return *guard_; }
  /// A line for the log: another run has been found in the domain, what follows, and the remedy.
  std::string describe_other_run(const std::string& run) const;
  const LinkSettings& link() const { return link_; }
  Pace& pace() { return pace_; }
  SensorQos sensor_qos() const { return options_.sensor_qos; }
  const Names& names() const { return options_.names; }
  /// Why shared memory is not used, although the options ask for it; empty when all is as asked for.
  const std::string& shared_memory_obstacle() const { return shared_memory_obstacle_; }

  /// Endpoints report themselves, so that the ROS 2 graph can list them.
  void add_reader(const Gid& gid) { readers_.push_back(gid); }
  void remove_reader(const Gid& gid) { std::erase(readers_, gid); }
  void add_writer(const Gid& gid) { writers_.push_back(gid); }
  /// Publishes the node's endpoints on `ros_discovery_info`; call it when all endpoints have been created, and when
  /// they have changed.
  void announce_graph();

 private:
  class Listener;

  void join(compat::fdds::DomainParticipantQos qos);

  struct Deleter {
    void operator()(compat::fdds::DomainParticipant* participant) const;
  };

  ParticipantOptions options_;
  LinkSettings link_;
  Pace pace_;
  Peers peers_;
  Endpoints endpoints_;
  Bell changes_;
  std::shared_ptr<PacketGuard> guard_;
  std::unique_ptr<Listener> listener_;
  std::unique_ptr<compat::fdds::DomainParticipant, Deleter> participant_;  // after what its threads use
  std::string shared_memory_obstacle_;
  int filters_ = 0;
  compat::fdds::Publisher* publisher_ = nullptr;
  compat::fdds::Subscriber* subscriber_ = nullptr;
  compat::fdds::DataWriter* graph_writer_ = nullptr;
  std::vector<Gid> readers_;
  std::vector<Gid> writers_;
};

/// Buffer size that the kernel grants to a UDP socket that asks for `wanted` bytes (it caps the size silently).
int effective_socket_buffer_bytes(int wanted);

}  // namespace lapis::dds
