#include "common/mapping/model/frame_votes.hpp"

#include <algorithm>

namespace lapis::mapping {
namespace {

/// Builds votes block by block.
class VotesBuilder {
 public:
  void begin(const BlockVotes& block, const BlockMask& without) {
    current_ = block;
    for (std::size_t i = 0; i < without.size(); ++i) current_.misses[i] &= ~without[i];
    current_.hits_begin = static_cast<std::uint32_t>(votes_.hits.size());
  }
  void hit(const HitVote& vote) { votes_.hits.push_back(vote); }
  void end() {
    current_.hits_end = static_cast<std::uint32_t>(votes_.hits.size());
    const auto is_zero = [](std::uint64_t word) { return word == 0; };
    const bool has_misses = !std::all_of(current_.misses.begin(), current_.misses.end(), is_zero);
    if (has_misses || current_.hits_end > current_.hits_begin) votes_.blocks.push_back(current_);
  }
  void whole(const BlockVotes& block, std::span<const HitVote> hits) {
    begin(block, {});
    votes_.hits.insert(votes_.hits.end(), hits.begin(), hits.end());
    end();
  }
  FrameVotes take() { return std::move(votes_); }

 private:
  FrameVotes votes_;
  BlockVotes current_;
};

bool is_before(const HitVote& a, const HitVote& b) {
  return a.offset != b.offset ? a.offset < b.offset : a.label < b.label;
}

void split_hits(std::span<const HitVote> a, std::span<const HitVote> b, VotesBuilder& only_a, VotesBuilder& only_b) {
  while (!a.empty() || !b.empty()) {
    if (!a.empty() && !b.empty() && a.front() == b.front()) {
      a = a.subspan(1);
      b = b.subspan(1);
    } else if (b.empty() || (!a.empty() && is_before(a.front(), b.front()))) {
      only_a.hit(a.front());
      a = a.subspan(1);
    } else {
      only_b.hit(b.front());
      b = b.subspan(1);
    }
  }
}

}  // namespace

void drop_common(FrameVotes& a, FrameVotes& b) {
  VotesBuilder only_a, only_b;
  auto of_a = a.blocks.begin(), of_b = b.blocks.begin();
  while (of_a != a.blocks.end() || of_b != b.blocks.end()) {
    if (of_b == b.blocks.end() || (of_a != a.blocks.end() && of_a->block < of_b->block)) {
      only_a.whole(*of_a, a.hits_of(*of_a));
      ++of_a;
    } else if (of_a == a.blocks.end() || of_b->block < of_a->block) {
      only_b.whole(*of_b, b.hits_of(*of_b));
      ++of_b;
    } else {
      BlockMask common;
      for (std::size_t i = 0; i < common.size(); ++i) common[i] = of_a->misses[i] & of_b->misses[i];
      only_a.begin(*of_a, common);
      only_b.begin(*of_b, common);
      split_hits(a.hits_of(*of_a), b.hits_of(*of_b), only_a, only_b);
      only_a.end();
      only_b.end();
      ++of_a;
      ++of_b;
    }
  }
  a = only_a.take();
  b = only_b.take();
}

}  // namespace lapis::mapping
