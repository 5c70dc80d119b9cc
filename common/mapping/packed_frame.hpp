#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mapping/compact_frame.hpp"

namespace lapis::mapping {

/// A compact frame as it waits in memory or on disk: differences along the row, compressed with zstd; some 20 to 40 kB
/// for 640x360 at stride 2. Exact.
class PackedFrame {
 public:
  explicit PackedFrame(const CompactFrame& frame);

  CompactFrame unpack() const;
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  geometry::PinholeCamera camera_;
  int stride_ = 1;
  bool has_labels_ = false;
  std::size_t labels_out_of_list_ = 0;
  std::vector<std::uint8_t> bytes_;  ///< zstd: low bytes, high bytes of depth differences; labels likewise if present
};

}  // namespace lapis::mapping
