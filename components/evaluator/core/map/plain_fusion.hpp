#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

struct PlainFusionConfig {
  double resolution_m = 0.25;  ///< edge of a voxel; 0.02 to 1
  double min_range_m = 0.2;    ///< pixels nearer than this to the camera centre are ignored; 0 to 5
  double max_range_m = 5.0;    ///< pixels farther than this from the camera centre are ignored; 0.5 to 50
};

/// The evaluator's own map, which is as simple as possible so that it can be trusted: every pixel with depth marks its
/// voxel as occupied, no voxel ever becomes free, and the label of a voxel is that of most of its pixels. It shares no
/// code with the mapper that it judges.
class PlainFusion {
 public:
  /// Throws std::invalid_argument unless the resolution is positive and 0 <= min_range_m < max_range_m.
  explicit PlainFusion(const PlainFusionConfig& config);

  /// Adds a frame seen from T_map_camera (pose of the optical frame). `labels` may be empty; then every pixel is
  /// unlabelled. Throws std::invalid_argument when the sizes of images and camera differ, or when the pose is outside
  /// the grid.
  void add(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth, const geometry::LabelImage& labels,
           const geometry::Pose& T_map_camera);

  /// Occupied voxels so far. Ties of labels go to the smaller id, but any class wins over "unlabelled".
  LabelledVoxels voxels() const;
  /// Share of these voxels that `map` contains, too, whatever their labels; none without any voxel.
  std::optional<double> share_in(const LabelledVoxels& map) const;

 private:
  /// Pixels per label; a voxel rarely has more than three.
  using LabelCounts = std::vector<std::pair<std::uint16_t, std::uint64_t>>;

  /// Neighbouring pixels of one voxel and label, which need only one look-up together.
  struct Run {
    std::uint64_t key = 0;
    std::uint16_t label = 0;
    std::uint64_t pixels = 0;
  };
  void count(const Run& run);

  PlainFusionConfig config_;
  std::unordered_map<std::uint64_t, LabelCounts> counts_;  // keys are packed indices
};

}  // namespace lapis::evaluator
