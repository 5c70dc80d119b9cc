#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/schema.hpp"
#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::mapping {

struct CompactFrameConfig {
  int stride = 2;         ///< every stride-th pixel of every stride-th row is kept
  int max_label = 65534;  ///< labels above this, and 65535, are kept as unlabelled (0) and counted
};

template <class Field>
void describe(Field& field, CompactFrameConfig& c) {
  field("stride", c.stride, config::in_range(1, 16),
        "sampling step of the frames that the map keeps: every stride-th pixel of every stride-th row is kept");
}

/// The reduced form of a camera frame that the mapper keeps, and the only form that it integrates. The map follows the
/// pose graph: frames are subtracted and added again at their new poses. A frame can only be subtracted exactly if
/// every integration uses the same data; to integrate the raw image first and the compact frame later would leave
/// residues. Depth is kept in millimetres (the unit of the depth topic), sampled on a regular grid of pixels.
/// frame_codec.hpp packs a frame.
class CompactFrame {
 public:
  /// @param camera intrinsics of the full images
  /// @param labels null, or an image of the same size
  /// @param confidence of the labels; null (all labels are certain), or an image of the same size
  /// Returns nothing, with the reason in `error`, when sizes disagree or the camera is not valid. Depth that is not
  /// finite or not positive counts as no measurement.
  static std::optional<CompactFrame> make(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                                          const geometry::LabelImage* labels, const CompactFrameConfig& config,
                                          std::string& error, const geometry::ConfidenceImage* confidence = nullptr);
  /// Gives a frame that was made without labels those that make() would have given it; images of the size of the
  /// camera's. Returns the problem and leaves the frame as it is when sizes differ; otherwise an empty text.
  /// @param max_label see CompactFrameConfig
  std::string set_labels(const geometry::LabelImage& labels, const geometry::ConfidenceImage* confidence,
                         int max_label);

  const geometry::PinholeCamera& camera() const { return camera_; }
  int stride() const { return stride_; }
  int columns() const { return (camera_.width + stride_ - 1) / stride_; }  ///< samples per row
  int rows() const { return (camera_.height + stride_ - 1) / stride_; }
  std::size_t samples() const { return depth_mm_.size(); }
  bool has_labels() const { return !labels_.empty(); }
  /// Samples row by row; 0 = no measurement, 65535 = that far or further.
  const std::vector<std::uint16_t>& depth_mm() const { return depth_mm_; }
  /// Class per sample, 0 = unlabelled; empty when the frame has no labels.
  const std::vector<std::uint16_t>& labels() const { return labels_; }
  /// Confidence per sample, 255 = certain; empty when all labels are certain.
  const std::vector<std::uint8_t>& confidence() const { return confidence_; }
  /// Number of samples whose label was 65535 or above CompactFrameConfig::max_label.
  std::size_t labels_out_of_list() const { return labels_out_of_list_; }
  /// Median of the measured depths [m]; 0 when nothing was measured.
  double median_depth_m() const;

 private:
  friend std::vector<std::uint8_t> pack(const CompactFrame& frame);
  friend std::optional<CompactFrame> unpack_frame(std::span<const std::uint8_t> bytes);
  CompactFrame() = default;

  geometry::PinholeCamera camera_;
  int stride_ = 1;
  std::size_t labels_out_of_list_ = 0;
  std::vector<std::uint16_t> depth_mm_;
  std::vector<std::uint16_t> labels_;
  std::vector<std::uint8_t> confidence_;
};

}  // namespace lapis::mapping
