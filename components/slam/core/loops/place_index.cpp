#include "slam/core/loops/place_index.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace lapis::slam {
namespace {

constexpr std::uint32_t kSeed = 20241;   // arbitrary, but fixed: the sampled bits are a property of the method
constexpr std::size_t kCommonWord = 16;  // words with at most this many entries always count
constexpr double kCommonShare = 0.25;    // of the key-frames: a word with more entries is ignored
constexpr KeyframeId kNeighbours = 2;    // distance in time of key-frames of which only the best is returned

bool is_near(KeyframeId a, KeyframeId b) { return (a > b ? a - b : b - a) <= kNeighbours; }

}  // namespace

PlaceIndex::PlaceIndex() : words_(kTables << kBits) {
  std::mt19937 engine(kSeed);  // the C++ standard fixes its numbers
  for (auto& table : bits_) {
    for (auto& bit : table) bit = static_cast<std::uint8_t>(engine() % (8 * sizeof(Descriptor)));
  }
}

std::size_t PlaceIndex::word_of(const std::array<std::uint8_t, kBits>& bits, const Descriptor& descriptor) {
  std::size_t word = 0;
  for (const std::uint8_t bit : bits) word = 2 * word + ((descriptor[bit / 64U] >> (bit % 64U)) & 1U);
  return word;
}

void PlaceIndex::add(KeyframeId id, std::span<const Feature> features) {
  norms_.resize(static_cast<std::size_t>(id), 1.0);
  std::size_t count = 0;
  for (const Feature& feature : features) {
    if (feature.depth_m <= 0.0) continue;
    ++count;
    for (std::size_t table = 0; table < kTables; ++table) {
      words_[(table << kBits) + word_of(bits_[table], feature.descriptor)].push_back(static_cast<std::uint32_t>(id));
    }
  }
  norms_.push_back(std::sqrt(static_cast<double>(std::max<std::size_t>(count, 1))));
}

std::vector<PlaceIndex::Candidate> PlaceIndex::query(std::span<const Feature> features, std::size_t most,
                                                     const std::function<bool(KeyframeId)>& is_wanted) const {
  std::vector<double> scores(norms_.size(), 0.0);
  const auto keyframes = static_cast<double>(norms_.size());
  const auto common = std::max(kCommonWord, static_cast<std::size_t>(kCommonShare * keyframes));
  for (const Feature& feature : features) {
    for (std::size_t table = 0; table < kTables; ++table) {
      const auto& word = words_[(table << kBits) + word_of(bits_[table], feature.descriptor)];
      if (word.empty() || word.size() > common) continue;
      const double weight = std::log(1.0 + keyframes / static_cast<double>(word.size()));
      for (const std::uint32_t id : word) scores[id] += weight;
    }
  }
  std::vector<Candidate> ranked;
  for (KeyframeId id = 0; id < scores.size(); ++id) {
    const double score = scores[static_cast<std::size_t>(id)];
    if (score > 0.0 && is_wanted(id)) ranked.push_back({id, score / norms_[static_cast<std::size_t>(id)]});
  }
  std::sort(ranked.begin(), ranked.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe > b.keyframe;
  });
  std::vector<Candidate> best;
  for (const Candidate& candidate : ranked) {
    if (best.size() == most) break;
    const bool is_new = std::none_of(best.begin(), best.end(), [&](const Candidate& better) {
      return is_near(better.keyframe, candidate.keyframe);
    });
    if (is_new) best.push_back(candidate);
  }
  return best;
}

}  // namespace lapis::slam
