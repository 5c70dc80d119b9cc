#include "common/dds/reader.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/dds/endpoint_qos.hpp"

namespace lapis::dds {

Reader::Reader(Participant& participant, const std::string& dds_name, const std::string& type_name,
               compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos, Writers writers)
    : participant_(participant), dds_name_(dds_name), is_latched_(qos.latched),
      writers_(participant.peers(), writers == Writers::kOne) {
  auto& topic = participant.topic(dds_name, type_name, std::move(type));
  const auto mask = compat::fdds::StatusMask::subscription_matched()
                    << compat::fdds::StatusMask::requested_incompatible_qos();
  reader_ = participant.subscriber().create_datareader(&topic, reader_qos(qos, type_hash), this, mask);
  if (reader_ == nullptr) throw std::runtime_error("DDS reader of " + dds_name + " could not be created");
  reader_->get_statuscondition().set_enabled_statuses(compat::fdds::StatusMask::data_available());
  gid_ = to_gid(reader_->guid());
  participant.add_reader(gid_);
}

Reader::~Reader() { participant_.subscriber().delete_datareader(reader_); }

Reader::Taken Reader::take(void* sample, compat::fdds::SampleInfo& info) {
  if (!compat::ok(reader_->take_next_sample(sample, &info))) return Taken::kNothing;
  const Gid writer = to_gid(info.sample_identity.writer_guid());
  const std::uint64_t sequence = info.sample_identity.sequence_number().to64long();
  std::uint64_t& newest = newest_[writer];
  // Latched (and so all keyed) topics skip sequence numbers by design.
  if (!is_latched_ && newest != 0 && sequence > newest + 1) missed_ += sequence - newest - 1;
  newest = std::max(newest, sequence);
  if (!is_accepted(writer)) return Taken::kRefused;
  return info.valid_data ? Taken::kSample : Taken::kKeyEnded;
}

bool Reader::is_accepted(const Gid& writer) {
  {
    const std::lock_guard lock(mutex_);
    if (writers_.accepts(writer, StreamOwner::Clock::now())) return true;
  }
  ++refused_;
  refused_writer_ = writer;
  return false;
}

std::uint64_t Reader::received(const Gid& writer) const {
  const auto it = newest_.find(writer);
  return it == newest_.end() ? 0 : it->second;
}

std::size_t Reader::matched() const {
  const std::lock_guard lock(mutex_);
  return writers_.matched();
}

bool Reader::is_matched(const Gid& writer) const {
  const std::lock_guard lock(mutex_);
  return writers_.is_matched(writer);
}

bool Reader::is_participant_matched(const Gid& participant) const {
  const std::lock_guard lock(mutex_);
  return writers_.is_participant_matched(participant);
}

void Reader::on_subscription_matched(compat::fdds::DataReader* /*reader*/,
                                     const compat::fdds::SubscriptionMatchedStatus& status) {
  const Gid writer = to_gid(compat::rtps::iHandle2GUID(status.last_publication_handle));
  const std::lock_guard lock(mutex_);
  if (status.current_count_change >= 0) {  // 0: a match and a loss at once; the handle is that of the match
    writers_.match(writer);
  } else {
    writers_.unmatch(writer);
  }
}

void Reader::on_requested_incompatible_qos(compat::fdds::DataReader* /*reader*/,
                                           const compat::fdds::RequestedIncompatibleQosStatus& /*status*/) {
  ++incompatible_;
}

}  // namespace lapis::dds
