#include "common/dds/reader.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/dds/endpoint_qos.hpp"

namespace lapis::dds {

class Reader::Filter : public compat::SignatureFilter {
 public:
  explicit Filter(Reader& reader) : reader_(reader) {}
  bool admits(const compat::rtps::GUID_t& signer) const override { return reader_.admits(signer); }

 private:
  Reader& reader_;
};

Reader::Reader(Participant& participant, const std::string& dds_name, const std::string& type_name,
               compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos, Writers writers)
    : participant_(participant), dds_name_(dds_name), type_hash_(type_hash), qos_(qos), writers_(participant.peers()) {
  qos_.best_effort |= qos.sensor && participant.sensor_qos() == SensorQos::kBestEffort;
  topic_ = &participant.topic(dds_name, type_name, std::move(type));
  if (writers == Writers::kOne && !participant.peers().run().empty()) {
    filter_ = std::make_unique<Filter>(*this);
    topic_ = filtered_ = &participant.filter(static_cast<compat::fdds::Topic&>(*topic_), *filter_);
  }
  try {
    create();
  } catch (const std::runtime_error&) {
    if (filtered_ != nullptr) participant.drop(*filtered_);
    throw;
  }
}

void Reader::create() {
  const auto mask = compat::fdds::StatusMask::subscription_matched()
                    << compat::fdds::StatusMask::requested_incompatible_qos();
  reader_ = participant_.subscriber().create_datareader(topic_, reader_qos(qos_, type_hash_, participant_.link()), this,
                                                        mask);
  if (reader_ == nullptr) throw std::runtime_error("DDS reader of " + dds_name_ + " could not be created");
  reader_->get_statuscondition().set_enabled_statuses(compat::fdds::StatusMask::data_available());
  gid_ = to_gid(reader_->guid());
  participant_.add_reader(gid_);
}

bool Reader::wants_best_effort() const {
  return has_best_effort_writer_ && qos_.sensor && !qos_.best_effort && participant_.sensor_qos() == SensorQos::kAuto;
}

void Reader::become_best_effort() {
  participant_.remove_reader(gid_);
  participant_.subscriber().delete_datareader(reader_);
  reader_ = nullptr;
  {
    const std::lock_guard lock(mutex_);
    writers_.unmatch_all();
  }
  incompatible_ = 0;
  qos_.best_effort = true;
  create();
}

Reader::~Reader() {
  if (reader_ != nullptr) participant_.subscriber().delete_datareader(reader_);
  if (filtered_ != nullptr) participant_.drop(*filtered_);
}

Reader::Taken Reader::take(void* sample, compat::fdds::SampleInfo& info) {
  if (!compat::ok(reader_->take_next_sample(sample, &info))) {
    if (qos_.keyed) newest_ = reached_;
    return Taken::kNothing;
  }
  const Gid writer = to_gid(info.sample_identity.writer_guid());
  const Welcome welcome = welcome_of(writer);
  const std::uint64_t sequence = info.sample_identity.sequence_number().to64long();
  std::uint64_t& newest = reached_[writer];
  // Latched (and so all keyed) topics skip sequence numbers by design.
  if (welcome == Welcome::kExpected && !qos_.latched && newest != 0 && sequence > newest + 1) {
    missed_ += sequence - newest - 1;
  }
  newest = std::max(newest, sequence);
  // Samples of a keyed topic come in the order of their keys, so none is missing only when none is left.
  if (!qos_.keyed) newest_[writer] = newest;
  if (welcome == Welcome::kRefused) return Taken::kRefused;
  heard_ = std::chrono::steady_clock::now();
  return info.valid_data ? Taken::kSample : Taken::kKeyEnded;
}

bool Reader::admits(const compat::rtps::GUID_t& signer) {
  const bool is_signed = signer != compat::rtps::GUID_t::unknown();
  const std::lock_guard lock(mutex_);
  if (writers_.admits(is_signed ? std::optional(to_gid(signer)) : std::nullopt)) return true;
  note_refusal(is_signed ? to_gid(signer) : Gid{});
  return false;
}

Reader::Welcome Reader::welcome_of(const Gid& writer) {
  const std::lock_guard lock(mutex_);
  const bool is_accepted = filter_ ? writers_.accepts(writer, StreamOwner::Clock::now())
                                   : participant_.peers().kinship(writer) != Kinship::kOtherRun;
  if (is_accepted) return writers_.was_interrupted(writer) ? Welcome::kInterrupted : Welcome::kExpected;
  note_refusal(writer);
  return Welcome::kRefused;
}

bool Reader::refuses(const Gid& writer) const {
  const std::lock_guard lock(mutex_);
  return filter_ ? writers_.refuses(writer) : participant_.peers().kinship(writer) == Kinship::kOtherRun;
}

/// The mutex must be locked.
void Reader::note_refusal(const Gid& writer) {
  ++refused_.count;
  refused_.newest = writer;
}

Reader::Refused Reader::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
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
  {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change >= 0) {  // 0: a match and a loss at once; the handle is that of the match
      writers_.match(writer);
    } else {
      writers_.unmatch(writer);
    }
  }
  participant_.changes().ring();
}

void Reader::on_requested_incompatible_qos(compat::fdds::DataReader* /*reader*/,
                                           const compat::fdds::RequestedIncompatibleQosStatus& status) {
  ++incompatible_;
  if (status.last_policy_id == compat::fdds::RELIABILITY_QOS_POLICY_ID) has_best_effort_writer_ = true;
}

}  // namespace lapis::dds
