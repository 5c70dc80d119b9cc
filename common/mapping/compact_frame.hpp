#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::mapping {

struct CompactFrameConfig {
  int stride = 2;         ///< every stride-th pixel of every stride-th row is kept, in [1, 16]
  int max_label = 65534;  ///< labels above are kept as unlabelled (0) and counted; 65535 always is
};

/// What the mapper keeps of a camera frame, and the only thing it ever integrates. Because the map is moved with the
/// pose graph by taking frames out and putting them back, what is put in must be exactly what can be put in again;
/// integrating the raw image once and the compact frame later would leave traces. Depth is kept in millimetres (the
/// unit of the depth topic; 0 = no measurement, 65535 = that far or further), sampled on a regular grid of pixels,
/// coded as differences along the row and compressed with zstd level 1: some 20 to 40 kB for 640x360 at stride 2.
class CompactFrame {
 public:
  /// The samples of a frame, row by row. `labels` is empty when the frame has none.
  struct Samples {
    std::vector<std::uint16_t> depth_mm;
    std::vector<std::uint16_t> labels;
  };

  /// @param camera intrinsics of the full images
  /// @param labels null, or an image of the same size
  /// Returns nothing, with the reason in `error`, when sizes disagree or the camera is not valid. Depth that is not
  /// finite or not positive is taken as no measurement.
  static std::optional<CompactFrame> make(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                                          const geometry::LabelImage* labels, const CompactFrameConfig& config,
                                          std::string& error);

  const geometry::PinholeCamera& camera() const { return camera_; }
  int stride() const { return stride_; }
  int columns() const { return columns_; }  ///< samples per row
  int rows() const { return rows_; }
  bool has_labels() const { return has_labels_; }
  /// Median of the measured depths [m]; 0 when nothing was measured.
  double median_depth_m() const { return median_depth_m_; }
  /// Samples whose label was above CompactFrameConfig::max_label.
  std::size_t labels_out_of_list() const { return labels_out_of_list_; }
  /// Memory of this frame [bytes].
  std::size_t bytes() const { return sizeof(CompactFrame) + data_.capacity(); }

  Samples unpack() const;

 private:
  CompactFrame() = default;

  geometry::PinholeCamera camera_;
  int stride_ = 1;
  int columns_ = 0;
  int rows_ = 0;
  bool has_labels_ = false;
  double median_depth_m_ = 0.0;
  std::size_t labels_out_of_list_ = 0;
  std::vector<std::uint8_t> data_;  ///< zstd: low bytes, high bytes of depth differences; labels likewise if present
};

}  // namespace lapis::mapping
