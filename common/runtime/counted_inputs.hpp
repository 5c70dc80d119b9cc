#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "common/dds/subscription.hpp"
#include "idl/lapis_msgs.hpp"

namespace lapis::runtime {

/// Checks whether the samples that other processes have counted as published have been received (docs/architecture.md).
class CountedInputs {
 public:
  using Counts = std::vector<lapis_msgs::msg::TopicCount>;
  using Sources = std::vector<std::unique_ptr<dds::Source>>;

  /// The first count, on a topic of `sources`, whose samples have been neither taken nor forgiven; null when there is
  /// none. Samples of a writer that is refused, because the topic has another one, never come and do not count.
  const lapis_msgs::msg::TopicCount* missing(const Counts& counts, const Sources& sources) const;
  /// Stops waiting for the samples of volatile topics up to these counts: they were published before the endpoints
  /// matched and never arrive.
  void forgive(const Counts& counts, const Sources& sources);
  void clear() { forgiven_.clear(); }

 private:
  std::map<dds::Gid, std::uint64_t> forgiven_;  // by writer: samples up to this number are not waited for
};

}  // namespace lapis::runtime
