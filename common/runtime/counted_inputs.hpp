#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "common/dds/subscription.hpp"
#include "idl/lapis_msgs.hpp"

namespace lapis::runtime {

/// Whether what others say that they have published has been received (docs/architecture.md).
class CountedInputs {
 public:
  using Counts = std::vector<lapis_msgs::msg::TopicCount>;
  using Sources = std::vector<std::unique_ptr<dds::Source>>;

  /// The first count of a topic among `sources` whose samples were neither taken nor forgiven; null when all is there.
  const lapis_msgs::msg::TopicCount* missing(const Counts& counts, const Sources& sources) const;
  /// Samples of volatile topics up to these counts were published before we matched: they are nobody's and will never
  /// come.
  void forgive(const Counts& counts, const Sources& sources);
  void clear() { forgiven_.clear(); }

 private:
  std::map<dds::Gid, std::uint64_t> forgiven_;  // by writer: samples up to this one are not waited for
};

}  // namespace lapis::runtime
