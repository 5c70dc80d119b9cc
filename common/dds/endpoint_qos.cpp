#include "common/dds/endpoint_qos.hpp"

#include <algorithm>

namespace lapis::dds {
namespace {

using namespace compat::fdds;  // NOLINT(google-build-using-namespace): policy names only

// Policies that readers and writers share.
template <class EndpointQos>
void apply_common(const Qos& wanted, const std::string& type_hash, const LinkSettings& link, EndpointQos& qos) {
  qos.reliability().kind = wanted.best_effort ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = compat::duration(100'000'000);
  qos.durability().kind = wanted.latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = wanted.depth;
  if (wanted.large && !wanted.latched) qos.history().depth = std::max(wanted.depth, link.large.depth);
  // A keyed topic has no limit on keys and keeps one sample per key. With the default limit of ten instances, a reader
  // is matched but receives nothing for further keys.
  qos.resource_limits().max_instances = wanted.keyed ? 0 : 1;
  qos.resource_limits().max_samples = wanted.keyed ? 0 : 5000;
  qos.resource_limits().max_samples_per_instance = wanted.keyed ? 1 : 5000;
  qos.ownership().kind = SHARED_OWNERSHIP_QOS;
  qos.liveliness().kind = AUTOMATIC_LIVELINESS_QOS;
  qos.deadline().period = compat::infinite();
  qos.lifespan().duration =
      wanted.lifespan_s > 0 ? compat::duration(wanted.lifespan_s * std::int64_t{1'000'000'000}) : compat::infinite();
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = compat::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  const std::string user_data = "typehash=" + type_hash + ";";
  qos.user_data().setValue(std::vector<unsigned char>(user_data.begin(), user_data.end()));
}

void apply_large(const LargeSettings& large, DataWriterQos& qos) {
  if (large.bytes_per_period > 0) {
    qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
    if (compat::kHasFlowControllers) qos.publish_mode().flow_controller_name = kPaceName;
  }
  if (large.heartbeat_ns > 0) compat::set_timings(qos, compat::duration(large.heartbeat_ns), compat::duration(0));
  compat::set_nack_suppression(qos, compat::duration(large.nack_suppression_ns));
  // While a history is full, which it always is after a while, Fast DDS adds a heartbeat to each datagram, and each
  // heartbeat makes the reader ask for all that is still under way.
  qos.reliable_writer_qos().disable_heartbeat_piggyback = !large.heartbeat_with_data;
}

}  // namespace

DataWriterQos writer_qos(const Qos& wanted, const std::string& type_hash, const LinkSettings& link) {
  DataWriterQos qos;
  apply_common(wanted, type_hash, link, qos);
  qos.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
  qos.representation().m_value = {XCDR_DATA_REPRESENTATION};
  // Fast DDS resends a lost last datagram only after the next heartbeat; its default period of 3 s stalls lock-step.
  compat::set_timings(qos, compat::duration(wanted.urgent ? kUrgentHeartbeatNs : kHeartbeatNs), compat::duration(0));
  if (wanted.large) apply_large(link.large, qos);
  return qos;
}

DataReaderQos reader_qos(const Qos& wanted, const std::string& type_hash, const LinkSettings& link) {
  DataReaderQos qos;
  apply_common(wanted, type_hash, link, qos);
  if (wanted.reader_depth > 0) qos.history().depth = wanted.reader_depth;
  compat::set_reader_timings(qos, compat::duration(wanted.large ? link.large.heartbeat_response_ns : 0));
  return qos;
}

}  // namespace lapis::dds
