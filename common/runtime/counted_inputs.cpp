#include "common/runtime/counted_inputs.hpp"

#include <algorithm>

namespace lapis::runtime {
namespace {

const dds::Source* find_source(const CountedInputs::Sources& sources, const std::string& dds_name) {
  const auto it =
      std::find_if(sources.begin(), sources.end(), [&](const auto& source) { return source->dds_name() == dds_name; });
  return it == sources.end() ? nullptr : it->get();
}

}  // namespace

const lapis_msgs::msg::TopicCount* CountedInputs::missing(const Counts& counts, const Sources& sources) const {
  const auto it = std::find_if(counts.begin(), counts.end(), [&](const auto& count) {
    const dds::Source* source = find_source(sources, count.topic());
    if (source == nullptr) return false;
    const auto forgiven = forgiven_.find(count.writer_gid());
    if (forgiven != forgiven_.end() && count.count() <= forgiven->second) return false;
    return source->received(count.writer_gid()) < count.count() && !source->refuses(count.writer_gid());
  });
  return it == counts.end() ? nullptr : &*it;
}

void CountedInputs::forgive(const Counts& counts, const Sources& sources) {
  for (const auto& count : counts) {
    const dds::Source* source = find_source(sources, count.topic());
    if (source != nullptr && !source->is_latched()) forgiven_[count.writer_gid()] = count.count();
  }
}

}  // namespace lapis::runtime
