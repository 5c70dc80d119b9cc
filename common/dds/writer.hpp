#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>

#include "common/dds/participant.hpp"
#include "common/dds/qos.hpp"

namespace lapis::dds {

/// The untyped half of a publisher: the DDS writer, its matched readers and the number of samples written.
class Writer : private compat::fdds::DataWriterListener {
 public:
  Writer(Participant& participant, const std::string& dds_name, const std::string& type_name,
         compat::fdds::TypeSupport type, const std::string& type_hash, const Qos& qos);
  ~Writer() override;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Writes one sample; a refusal by DDS is counted and returned.
  bool write(const void* sample, compat::rtps::WriteParams& params);
  bool write(const void* sample);
  /// Counts a sample that is not written, because a slow network would carry it too late (Pace).
  void leave_out() { ++left_out_; }
  /// Unregisters a key, so that no sample of it remains. Keys are never disposed, because late joiners would receive
  /// the disposed keys, too.
  bool unregister(const void* sample);

  /// Waits until every matched reader has acknowledged all samples; returns false after `timeout_s` seconds. Only for
  /// the end of a process: in a loop it would cost whole heartbeat periods.
  bool wait_until_acknowledged(double timeout_s);

  /// RTPS sequence number of the last sample: the number of samples written since the start.
  std::uint64_t written() const { return written_; }
  std::uint64_t failed() const { return failed_; }
  std::uint64_t left_out() const { return left_out_; }
  const std::string& dds_name() const { return dds_name_; }
  Gid gid() const { return gid_; }
  /// Number of matched readers that are not of another run.
  std::size_t matched() const;
  bool is_matched(const Gid& reader) const;
  /// Number of matches since the start, but for readers of another run; an increase means that a new reader has
  /// matched.
  std::uint64_t total_matches() const { return total_matches_; }
  /// Number of readers that were refused because of an incompatible QoS.
  std::uint64_t incompatible() const { return incompatible_; }

 private:
  void add_to_pace(const void* sample);
  void on_publication_matched(compat::fdds::DataWriter* writer,
                              const compat::fdds::PublicationMatchedStatus& status) override;
  void on_offered_incompatible_qos(compat::fdds::DataWriter* writer,
                                   const compat::fdds::OfferedIncompatibleQosStatus& status) override;

  Participant& participant_;
  std::string dds_name_;
  Qos qos_;
  compat::fdds::DataWriter* writer_ = nullptr;
  Gid gid_{};
  std::uint64_t written_ = 0;
  std::uint64_t failed_ = 0;
  std::uint64_t left_out_ = 0;
  std::atomic<std::uint64_t> total_matches_{0};
  std::atomic<std::uint64_t> incompatible_{0};
  mutable std::mutex mutex_;  // guards readers_, which DDS threads change
  std::set<Gid> readers_;
};

}  // namespace lapis::dds
