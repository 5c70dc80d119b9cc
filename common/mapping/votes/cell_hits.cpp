#include "common/mapping/votes/cell_hits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::mapping {
namespace {

constexpr std::uint64_t kCertain = 255;  ///< confidence of a sample

/// Samples of one cell that have the same label.
struct LabelTally {
  std::uint16_t label;
  std::uint32_t count;   ///< number of samples
  std::uint64_t weight;  ///< sum of their confidence
};

/// Sum of the confidence of a run's samples.
std::uint64_t weight_of(const SampleRun& run, const std::vector<std::uint8_t>& confidence) {
  if (confidence.empty()) return kCertain * run.count;
  const std::uint8_t* first = &confidence[run.first_sample];
  return std::accumulate(first, first + run.count, std::uint64_t{0});
}

void add_to(std::vector<LabelTally>& tally, const LabelTally& votes) {
  const auto same = [&votes](const LabelTally& entry) { return entry.label == votes.label; };
  const auto it = std::find_if(tally.begin(), tally.end(), same);
  if (it == tally.end()) {
    tally.push_back(votes);
  } else {
    it->count += votes.count;
    it->weight += votes.weight;
  }
}

/// The label with the largest weight, the smaller label for ties; label 0 when there is none.
LabelTally winner(const std::vector<LabelTally>& tally) {
  LabelTally best{};
  for (const LabelTally& entry : tally)
    if (entry.weight > best.weight || (entry.weight == best.weight && entry.weight > 0 && entry.label < best.label))
      best = entry;
  return best;
}

/// Weight of a hit [1/256 vote]: the probability that its depth noise is less than half a voxel.
std::uint16_t hit_weight(double sigma_m, double resolution_m) {
  const double half_voxel_sigmas = 0.5 * resolution_m / sigma_m;  // infinite without noise
  const auto weight = std::lround(std::erf(half_voxel_sigmas / std::numbers::sqrt2) * kOneVote);
  return static_cast<std::uint16_t>(std::max(weight, 1l));
}

/// The vote of one cell: the sum of the votes that the hits around it give to it.
CellHit summarise(std::span<const KernelVote> votes, std::vector<LabelTally>& tally) {
  tally.clear();
  std::uint32_t sum = 0, labelled = 0;
  for (const KernelVote& vote : votes) {
    sum += vote.weight;
    labelled += vote.label_weight;
    add_to(tally, {vote.label, 0, vote.label_weight});
  }
  const std::uint32_t weight = std::min(sum, kOneVote);
  return {votes.front().cell, winner(tally).label, static_cast<std::uint16_t>(weight * labelled / sum),
          static_cast<std::uint16_t>(weight)};
}

}  // namespace

CellSummary summarise(std::span<const SampleRun> runs, const std::vector<std::uint8_t>& confidence) {
  thread_local std::vector<LabelTally> tally;  // allocating it anew would cost more time than the rest
  tally.clear();
  std::uint32_t hits = 0, beyond = 0;
  for (const SampleRun& run : runs) {
    (run.is_beyond ? beyond : hits) += run.count;
    if (run.is_beyond || run.label == 0) continue;
    add_to(tally, {run.label, run.count, weight_of(run, confidence)});
  }
  CellSummary summary;
  summary.is_hit = hits > 0;
  if (const LabelTally most = winner(tally); most.label != 0) {
    summary.label = most.label;
    summary.label_weight =
        static_cast<std::uint16_t>((most.weight * kOneVote + kCertain / 2 * most.count) / (kCertain * most.count));
  }
  // The middle one, in scan order, of the samples that decide whether the cell is a hit.
  std::uint32_t skip = (summary.is_hit ? hits : beyond) / 2;
  for (const SampleRun& run : runs) {
    if ((run.is_beyond != 0) == summary.is_hit) continue;
    if (skip < run.count) {
      summary.ray_sample = run.first_sample + skip;
      break;
    }
    skip -= run.count;
  }
  return summary;
}

CellHit hit_of(CellId id, const CellSummary& cell, double sigma_m, double resolution_m) {
  const std::uint16_t weight = hit_weight(sigma_m, resolution_m);
  return {id, cell.label, static_cast<std::uint16_t>(weight * cell.label_weight / kOneVote), weight};
}

double sparse_kernel(double share) {
  if (share >= 1.0) return 0.0;
  const double angle = 2.0 * std::numbers::pi * share;
  return (2.0 + std::cos(angle)) / 3.0 * (1.0 - share) + std::sin(angle) / (2.0 * std::numbers::pi);
}

void spread(const CellHit& hit, const Eigen::Vector3d& point, double length, const FrameBox& box,
            std::vector<KernelVote>& votes) {
  const Eigen::Array3i low = (point.array() - length).floor().cast<int>();
  const Eigen::Array3i high = (point.array() + length).floor().cast<int>();
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const double distance = (Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) - point).norm();
        const auto weight = static_cast<std::uint16_t>(std::lround(sparse_kernel(distance / length) * hit.weight));
        if (weight == 0) continue;
        const auto label_weight = static_cast<std::uint16_t>(weight * hit.label_weight / hit.weight);
        const CellId cell = box.id(static_cast<unsigned>(x), static_cast<unsigned>(y), static_cast<unsigned>(z));
        votes.push_back({cell, hit.label, label_weight, weight});
      }
}

void smooth(const std::vector<KernelVote>& votes, std::vector<CellHit>& hits) {
  std::vector<LabelTally> tally;
  auto first = votes.begin();
  for (CellHit& hit : hits) {
    while (first->cell < hit.cell) ++first;
    auto last = first;
    while (last != votes.end() && last->cell == hit.cell) ++last;
    hit = summarise(std::span(first, last), tally);
    first = last;
  }
}

}  // namespace lapis::mapping
