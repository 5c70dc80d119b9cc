#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "common/dds/participant.hpp"
#include "common/dds/qos.hpp"
#include "common/dds/stream_owner.hpp"

namespace lapis::dds {

/// Whether more than one process publishes a topic.
enum class Writers { kOne, kMany };

/// The untyped half of a subscription: the DDS reader, its writers and how many samples of each have been taken.
class Reader : private compat::fdds::DataReaderListener {
 public:
  Reader(Participant& participant, const std::string& dds_name, const std::string& type_name,
         compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos, Writers writers);
  ~Reader() override;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  enum class Taken { kNothing, kSample, kKeyEnded, kRefused };
  /// Takes the next sample into `sample`. Only for the thread of the wait set.
  Taken take(void* sample, compat::fdds::SampleInfo& info);

  /// Sequence number of the newest sample taken from a writer; 0 = none. Only for the thread of the wait set.
  std::uint64_t received(const Gid& writer) const;
  /// Number of samples that were overwritten or lost before they could be taken.
  std::uint64_t missed() const { return missed_; }
  std::uint64_t incompatible() const { return incompatible_; }
  /// Number of samples that were refused, because they came from another run or from a second writer of the stream.
  std::uint64_t refused() const { return refused_; }
  /// The writer of the newest refused sample.
  const Gid& refused_writer() const { return refused_writer_; }
  const std::string& dds_name() const { return dds_name_; }
  /// True when writers give a late joiner their last samples.
  bool is_latched() const { return is_latched_; }
  Gid gid() const { return gid_; }
  /// Number of matched writers that are not of another run.
  std::size_t matched() const;
  bool is_matched(const Gid& writer) const;
  /// True when any writer of a participant is matched.
  bool is_participant_matched(const Gid& participant) const;
  compat::fdds::StatusCondition& condition() { return reader_->get_statuscondition(); }

 private:
  bool is_accepted(const Gid& writer);
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
  std::uint64_t refused_ = 0;
  Gid refused_writer_{};
  std::atomic<std::uint64_t> incompatible_{0};
  mutable std::mutex mutex_;  // guards writers_, which DDS threads change
  StreamOwner writers_;
};

}  // namespace lapis::dds
