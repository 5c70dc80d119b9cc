#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "common/dds/participant.hpp"
#include "common/dds/qos.hpp"

namespace lapis::dds {

/// The untyped half of a subscription: the DDS reader, its writers and how many samples of each have been taken.
class Reader : private compat::fdds::DataReaderListener {
 public:
  Reader(Participant& participant, const std::string& dds_name, const std::string& type_name,
         compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos);
  ~Reader() override;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  enum class Taken { kNothing, kSample, kKeyEnded };
  /// Takes the next sample into `sample`. Only for the thread of the wait set.
  Taken take(void* sample, compat::fdds::SampleInfo& info);

  /// Sequence number of the newest sample taken from a writer; 0 = none. Only for the thread of the wait set.
  std::uint64_t received(const Gid& writer) const;
  /// Number of samples that were overwritten or lost before they could be taken.
  std::uint64_t missed() const { return missed_; }
  std::uint64_t incompatible() const { return incompatible_; }
  const std::string& dds_name() const { return dds_name_; }
  /// True when writers give a late joiner their last samples.
  bool is_latched() const { return is_latched_; }
  Gid gid() const { return gid_; }
  std::size_t matched() const;
  bool is_matched(const Gid& writer) const;
  /// True when any writer of a participant is matched.
  bool is_participant_matched(const Gid& participant) const;
  compat::fdds::StatusCondition& condition() { return reader_->get_statuscondition(); }

 private:
  void on_subscription_matched(compat::fdds::DataReader* reader,
                               const compat::fdds::SubscriptionMatchedStatus& status) override;
  void on_requested_incompatible_qos(compat::fdds::DataReader* reader,
                                     const compat::fdds::RequestedIncompatibleQosStatus& status) override;

  Participant& participant_;
  std::string dds_name_;
  compat::fdds::DataReader* reader_ = nullptr;
  bool is_latched_ = false;
  Gid gid_{};
  std::map<Gid, std::uint64_t> newest_;
  std::uint64_t missed_ = 0;
  std::atomic<std::uint64_t> incompatible_{0};
  mutable std::mutex mutex_;  // guards writers_, which DDS threads change
  std::set<Gid> writers_;
};

}  // namespace lapis::dds
