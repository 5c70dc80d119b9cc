#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "common/mapping/model/voxel_index.hpp"
#include "common/mapping/wire/tile_codec.hpp"

namespace lapis::mapping {

/// The version of each tile and the checksum over all, which does not depend on the order of arrival: two sides with
/// the same number of tiles and the same checksum have the same versions.
class TileVersions {
 public:
  /// Returns false, and changes nothing, when the tile has this version already or a newer one.
  bool set(const TileIndex& tile, std::uint64_t version) {
    const auto [known, is_new] = versions_.try_emplace(tile, version);
    if (!is_new) {
      if (known->second >= version) return false;
      checksum_ -= tile_hash(tile, known->second);
      known->second = version;
    }
    checksum_ += tile_hash(tile, version);
    return true;
  }
  void clear() { *this = {}; }

  std::size_t size() const { return versions_.size(); }
  /// Sum of tile_hash(tile, version), modulo 2^64.
  std::uint64_t checksum() const { return checksum_; }

 private:
  std::unordered_map<TileIndex, std::uint64_t, GridIndexHash> versions_;
  std::uint64_t checksum_ = 0;
};

}  // namespace lapis::mapping
