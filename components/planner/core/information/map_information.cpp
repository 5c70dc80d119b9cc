#include "planner/core/information/map_information.hpp"

namespace lapis::planner {
namespace {

constexpr std::uint32_t kTabled = 256;

}  // namespace

MapInformation::MapInformation(const mapping::SensorModel& model) : reader_(model) {
  for (std::uint32_t n = 0; n < kTabled; ++n) by_misses_.push_back(reader_.entropy({n * mapping::kOneVote, {}}));
}

void MapInformation::update(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed) {
  for (const mapping::BlockIndex& index : changed) {
    double& known = blocks_[index];
    const double now = of(map.find(index));
    nats_ += now - known;
    known = now;
  }
}

double MapInformation::of(const mapping::VoxelBlock* block) const {
  if (block == nullptr) return 0.0;
  mapping::VoxelCounts counts;
  double sum = 0.0;
  for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
    block->read(offset, counts);
    if (counts.is_observed()) sum += by_misses_.front() - entropy(counts);
  }
  return sum;
}

double MapInformation::entropy(const mapping::VoxelCounts& counts) const {
  const std::uint32_t votes = counts.misses / mapping::kOneVote;
  const bool is_in_table = counts.hits.empty() && counts.misses % mapping::kOneVote == 0 && votes < kTabled;
  return is_in_table ? by_misses_[votes] : reader_.entropy(counts);
}

}  // namespace lapis::planner
