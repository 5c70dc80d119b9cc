#include "common/dds/writer.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/dds/endpoint_qos.hpp"

namespace lapis::dds {

Writer::Writer(Participant& participant, const std::string& dds_name, const std::string& type_name,
               compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos)
    : participant_(participant), dds_name_(dds_name), qos_(qos) {
  qos_.best_effort |= qos.sensor && participant.sensor_qos() == SensorQos::kBestEffort;
  auto& topic = participant.topic(dds_name, type_name, std::move(type));
  const auto mask = compat::fdds::StatusMask::publication_matched()
                    << compat::fdds::StatusMask::offered_incompatible_qos();
  writer_ =
      participant.publisher().create_datawriter(&topic, writer_qos(qos_, type_hash, participant.link()), this, mask);
  if (writer_ == nullptr) throw std::runtime_error("DDS writer of " + dds_name + " could not be created");
  gid_ = to_gid(writer_->guid());
  participant.add_writer(gid_);
}

Writer::~Writer() {
  // The history must be empty first: Fast DDS 2.9 frees the samples one by one while a periodic heartbeat may still
  // iterate over them, and that iteration never ends when it meets the gaps.
  std::size_t removed = 0;
  writer_->clear_history(&removed);
  participant_.publisher().delete_datawriter(writer_);
}

/// What is latched counts, too, when it is written; what late joiners are sent of it later does not.
void Writer::add_to_pace(const void* sample) {
  if (!qos_.large || !participant_.pace().is_limited() || matched() == 0) return;
  participant_.pace().add(compat::serialized_size(*writer_, sample), Pace::Clock::now());
}

bool Writer::write(const void* sample, compat::rtps::WriteParams& params) {
  add_to_pace(sample);
  if (!compat::ok(compat::write(*writer_, sample, params))) {
    ++failed_;
    return false;
  }
  written_ = params.sample_identity().sequence_number().to64long();
  return true;
}

/// In a run, a sample is signed with the identity of its writer, by which the filters of readers know it.
bool Writer::write(const void* sample) {
  compat::rtps::WriteParams params;
  if (!participant_.peers().run().empty()) {
    compat::rtps::SampleIdentity signature;
    signature.writer_guid(writer_->guid());
    params.related_sample_identity(signature);
  }
  return write(sample, params);
}

bool Writer::unregister(const void* sample) {
  // Fast DDS 2.9 takes void*, but only reads the key.
  if (!compat::ok(writer_->unregister_instance(const_cast<void*>(sample), compat::no_instance()))) {
    ++failed_;
    return false;
  }
  ++written_;
  return true;
}

bool Writer::wait_until_acknowledged(double timeout_s) {
  return compat::ok(writer_->wait_for_acknowledgments(compat::duration(static_cast<std::int64_t>(timeout_s * 1e9))));
}

std::size_t Writer::matched() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(std::count_if(readers_.begin(), readers_.end(), [this](const Gid& reader) {
    return participant_.peers().kinship(reader) != Kinship::kOtherRun;
  }));
}

bool Writer::is_matched(const Gid& reader) const {
  const std::lock_guard lock(mutex_);
  return readers_.contains(reader);
}

void Writer::on_publication_matched(compat::fdds::DataWriter* /*writer*/,
                                    const compat::fdds::PublicationMatchedStatus& status) {
  const Gid reader = to_gid(compat::rtps::iHandle2GUID(status.last_subscription_handle));
  {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change >= 0) {  // 0: a match and a loss at once; the handle is that of the match
      readers_.insert(reader);
      if (participant_.peers().kinship(reader) != Kinship::kOtherRun) ++total_matches_;
    } else {
      readers_.erase(reader);
    }
  }
  participant_.changes().ring();
}

void Writer::on_offered_incompatible_qos(compat::fdds::DataWriter* /*writer*/,
                                         const compat::fdds::OfferedIncompatibleQosStatus& /*status*/) {
  ++incompatible_;
}

}  // namespace lapis::dds
