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

/// The evaluator's own map, kept as simple as possible so that it can be trusted: every pixel with depth marks its
/// voxel occupied, nothing is ever carved, a voxel's label is the one most of its pixels have. It shares no code with
/// the mapper it judges.
class PlainFusion {
 public:
  /// Throws std::invalid_argument unless resolution and range are positive.
  explicit PlainFusion(const PlainFusionConfig& config);

  /// Adds a frame seen from T_map_camera (optical frame). `labels` may be empty: then every pixel is unlabelled.
  /// Throws std::invalid_argument when image sizes and camera disagree, or the pose leaves the grid.
  void add(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth, const geometry::LabelImage& labels,
           const geometry::Pose& T_map_camera);

  /// Occupied voxels so far. Ties of labels go to the smaller id, but a class goes before "unlabelled".
  LabelledVoxels voxels() const;
  /// Share of these voxels that `map` holds, too, whatever their labels; none when there are none.
  std::optional<double> share_in(const LabelledVoxels& map) const;

 private:
  /// Pixels per label; a voxel rarely has more than three.
  using LabelCounts = std::vector<std::pair<std::uint16_t, std::uint64_t>>;

  /// Neighbouring pixels of one voxel and label: they cost one look-up together.
  struct Run {
    std::uint64_t key = 0;
    std::uint16_t label = 0;
    std::uint64_t pixels = 0;
  };
  void count(const Run& run);

  PlainFusionConfig config_;
  std::unordered_map<std::uint64_t, LabelCounts> counts_;  // by packed index
};

}  // namespace lapis::evaluator
