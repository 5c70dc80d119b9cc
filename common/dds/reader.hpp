#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
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
  /// True when a sensor topic is read RELIABLE, has a writer that offers less, and the participant may follow it.
  bool wants_best_effort() const;
  /// Reads the topic BEST_EFFORT from now on, by a new DDS reader. The old one must be in no wait set.
  void become_best_effort();
  bool is_best_effort() const { return qos_.best_effort; }
  /// Samples that were refused, because they came from another run or from a second writer of the stream.
  struct Refused {
    std::uint64_t count = 0;
    Gid newest{};  ///< writer of the newest one; zeros when it has not signed
  };
  Refused refused() const;
  /// Whether what a writer sends now would be refused, so that it need not be waited for.
  bool refuses(const Gid& writer) const;
  const std::string& dds_name() const { return dds_name_; }
  /// When the newest accepted sample was taken; nothing before the first one. Only for the thread of the wait set.
  std::optional<std::chrono::steady_clock::time_point> heard() const { return heard_; }
  /// True when writers give a late joiner their last samples.
  bool is_latched() const { return qos_.latched; }
  Gid gid() const { return gid_; }
  /// Number of matched writers that are not of another run.
  std::size_t matched() const;
  bool is_matched(const Gid& writer) const;
  /// True when any writer of a participant is matched.
  bool is_participant_matched(const Gid& participant) const;
  compat::fdds::StatusCondition& condition() { return reader_->get_statuscondition(); }

 private:
  class Filter;
  enum class Welcome { kExpected, kInterrupted /* samples before it may have been refused */, kRefused };

  void create();
  bool admits(const compat::rtps::GUID_t& signer);
  Welcome welcome_of(const Gid& writer);
  void note_refusal(const Gid& writer);
  void on_subscription_matched(compat::fdds::DataReader* reader,
                               const compat::fdds::SubscriptionMatchedStatus& status) override;
  void on_requested_incompatible_qos(compat::fdds::DataReader* reader,
                                     const compat::fdds::RequestedIncompatibleQosStatus& status) override;

  Participant& participant_;
  std::string dds_name_;
  std::string type_hash_;
  Qos qos_;
  Gid gid_{};
  std::map<Gid, std::uint64_t> newest_;   // all samples up to this number have been taken, or never will be
  std::map<Gid, std::uint64_t> reached_;  // largest number taken, be it refused
  std::uint64_t missed_ = 0;
  std::optional<std::chrono::steady_clock::time_point> heard_;
  std::atomic<std::uint64_t> incompatible_{0};
  std::atomic<bool> has_best_effort_writer_{false};  // that is not heard
  mutable std::mutex mutex_;                         // guards writers_ and refused_, which DDS threads change
  StreamOwner writers_;
  Refused refused_;
  std::unique_ptr<Filter> filter_;
  compat::fdds::TopicDescription* topic_ = nullptr;
  compat::fdds::ContentFilteredTopic* filtered_ = nullptr;  // null: the topic is not filtered
  compat::fdds::DataReader* reader_ = nullptr;
};

}  // namespace lapis::dds
