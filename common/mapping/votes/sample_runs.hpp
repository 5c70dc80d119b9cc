#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/mapping/votes/compact_frame.hpp"
#include "common/mapping/votes/frame_box.hpp"

namespace lapis::mapping {

/// Maps samples to box coordinates [voxels]: p_box = camera + depth_mm * (x_step * column + y_step * row + corner).
class FrameProjector {
 public:
  FrameProjector(const CompactFrame& frame, const geometry::Pose& T_map_camera, const FrameBox& box,
                 double resolution_m)
      : columns_(frame.columns()) {
    const geometry::PinholeCamera& camera = frame.camera();
    const Eigen::Matrix3d R = T_map_camera.linear();
    const double per_mm = 1e-3 / resolution_m;
    x_step_ = R.col(0) * (frame.stride() / camera.fx * per_mm);
    y_step_ = R.col(1) * (frame.stride() / camera.fy * per_mm);
    corner_ = (R.col(2) - R.col(0) * (camera.cx / camera.fx) - R.col(1) * (camera.cy / camera.fy)) * per_mm;
    camera_ = T_map_camera.translation() / resolution_m - box.origin();
  }
  const Eigen::Vector3d& camera() const { return camera_; }
  const Eigen::Vector3d& y_step() const { return y_step_; }
  /// Vector from the camera to the point at 1 mm depth in row 0 [voxels].
  Eigen::Vector3d direction(int column) const { return corner_ + x_step_ * column; }
  Eigen::Vector3d direction_of_sample(std::uint32_t sample) const {
    return direction(static_cast<int>(sample) % columns_) + y_step_ * (static_cast<int>(sample) / columns_);
  }

 private:
  int columns_;
  Eigen::Vector3d x_step_, y_step_, corner_, camera_;
};

/// Consecutive samples of a row that have the same cell and the same label.
struct SampleRun {
  CellId cell;
  std::uint32_t first_sample;
  std::uint32_t count;
  std::uint16_t label;
  std::uint16_t is_beyond;
};

/// Working memory for the rows of a frame.
struct RowMemory {
  std::array<std::vector<double>, 3> directions;  ///< per column, in row 0
  std::array<std::vector<double>, 3> ray;         ///< per column of the current row: camera to point [voxels]
  std::vector<double> squared_range, cut;
  std::vector<std::uint32_t> cells;
  std::vector<std::uint8_t> is_start;  ///< 1 where a run begins; padded with zeros to whole words
  std::vector<std::uint32_t> starts;   ///< columns where runs begin, then the number of columns
  std::vector<std::uint16_t> no_labels;

  void resize(std::size_t columns);
};

/// Assigns every usable sample of a frame to a cell, in scan order. Samples nearer than `min_range` [voxels] are
/// ignored; rays end at `max_range` [voxels].
void find_runs(const CompactFrame& frame, const FrameProjector& projector, const FrameBox& box, double min_range,
               double max_range, RowMemory& memory, std::vector<SampleRun>& runs);

}  // namespace lapis::mapping
