#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "slam/core/frame/feature_extractor.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// Finds key-frames that show what a frame shows, by votes of their binary descriptors: locality-sensitive hashing by
/// sampled bits (Gionis, Indyk, Motwani, VLDB 1999), each vote weighted with the rarity of its word (inverse document
/// frequency; Sivic, Zisserman, ICCV 2003). It grows on-line, needs no vocabulary, and is the same in every run.
class PlaceIndex {
 public:
  struct Candidate {
    KeyframeId keyframe = 0;
    double score = 0.0;
  };

  PlaceIndex();
  /// Adds a key-frame; ids come in ascending order. Features without depth do not count: they show no landmark.
  void add(KeyframeId id, std::span<const Feature> features);
  /// The most similar of the wanted key-frames, best first, at most `most`. Of key-frames that are neighbours in time,
  /// only the best one.
  std::vector<Candidate> query(std::span<const Feature> features, std::size_t most,
                               const std::function<bool(KeyframeId)>& is_wanted) const;

  std::size_t size() const { return norms_.size(); }

 private:
  static constexpr std::size_t kTables = 6;
  static constexpr std::size_t kBits = 16;
  static std::size_t word_of(const std::array<std::uint8_t, kBits>& bits, const Descriptor& descriptor);

  std::array<std::array<std::uint8_t, kBits>, kTables> bits_{};
  std::vector<std::vector<std::uint32_t>> words_;  // key-frames by table and word, ascending
  std::vector<double> norms_;                      // of each key-frame: root of its number of features with depth
};

}  // namespace lapis::slam
