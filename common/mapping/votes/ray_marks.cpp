#include "common/mapping/votes/ray_marks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace lapis::mapping {
namespace {

/// One axis of the traversal of the cells. Distances along the ray are 64-bit fixed point (kRayLength = its whole
/// length), so that additions are exact. The lowest two bits hold the axis: when a ray meets an edge, the lower axis
/// comes first.
struct AxisWalk {
  static constexpr std::int64_t kRayLength = std::int64_t{1} << 44;

  AxisWalk() = default;
  AxisWalk(double start, double along, std::int64_t axis, std::ptrdiff_t pitch) {
    const int cell = static_cast<int>(start);
    const double to_wall = along > 0.0 ? cell + 1 - start : start - cell;
    step = along > 0.0 ? pitch : -pitch;
    t_cell = fixed(1.0 / std::abs(along));
    t_exit = (along == 0.0 ? kNever : fixed(to_wall / std::abs(along))) + axis;
  }
  static std::int64_t end(double share) {
    return 4 * static_cast<std::int64_t>(share * static_cast<double>(kRayLength)) + 3;
  }

  std::int64_t t_exit;  ///< where the ray leaves the cell
  std::int64_t t_cell;  ///< from wall to wall
  std::ptrdiff_t step;  ///< to the next cell's mark

 private:
  static constexpr std::int64_t kNever = std::int64_t{1} << 60;
  static std::int64_t fixed(double t) {
    return t < 1024.0 ? 4 * static_cast<std::int64_t>(t * static_cast<double>(kRayLength)) : kNever;
  }
};

/// Traversal of the cells along a ray. Axis `d` is the one along which the ray is longest, so that between two walls of
/// d it meets at most one wall of each other axis.
struct Walk {
  AxisWalk d, a, b;
  std::int64_t end;
  std::uint8_t* mark;

  /// Goes wall by wall to the first wall of d; returns false when the ray ends before it.
  bool to_wall_of_d() {
    while (true) {
      AxisWalk& next = d.t_exit < std::min(a.t_exit, b.t_exit) ? d : a.t_exit < b.t_exit ? a : b;
      if (next.t_exit > end) return false;
      *mark = 1;
      next.t_exit += next.t_cell;
      mark += next.step;
      if (&next == &d) return true;
    }
  }

  /// Goes from one wall of d to the next until the ray ends. Masks replace branches that a processor could not predict.
  void along_d() {
    for (; d.t_exit <= end; d.t_exit += d.t_cell) {
      const std::int64_t meets_a = (a.t_exit - d.t_exit) >> 63, meets_b = (b.t_exit - d.t_exit) >> 63;
      const std::int64_t a_first = (a.t_exit - b.t_exit) >> 63;
      const std::ptrdiff_t step_a = a.step & meets_a, step_b = b.step & meets_b;
      a.t_exit += a.t_cell & meets_a;
      b.t_exit += b.t_cell & meets_b;
      *mark = 1;
      mark[(step_a & a_first) | (step_b & ~a_first)] = 1;
      mark += step_a + step_b;
      *mark = 1;
      mark += d.step;
    }
  }
};

}  // namespace

RayMarks::RayMarks(const FrameBox& box, std::vector<std::uint8_t>& memory) {
  memory.assign(box.block_count() * kBlockVoxels, 0);
  cells_ = memory.data();
  const Eigen::Vector3i edges = box.blocks() * kBlockEdge;
  pitch_ = {1, edges[0], static_cast<std::ptrdiff_t>(edges[0]) * edges[1]};
  last_ = edges.array() - 1;
}

void RayMarks::add_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double t_end) {
  std::array<AxisWalk, 3> axes;
  std::uint8_t* mark = cells_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    axes[axis] = AxisWalk(start[i], ray[i], i, pitch_[axis]);
    mark += static_cast<int>(start[i]) * pitch_[axis];
  }
  int d = 0;
  ray.cwiseAbs().maxCoeff(&d);
  const auto dominant = static_cast<std::size_t>(d);
  Walk walk{axes[dominant], axes[(dominant + 1) % 3], axes[(dominant + 2) % 3], AxisWalk::end(t_end), mark};
  if (!walk.to_wall_of_d()) return;
  walk.along_d();
  walk.to_wall_of_d();  // the walls of the other axes after the last wall of d
}

void RayMarks::clear_around(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double margin, double reach) {
  const Eigen::Array3i center = (start + ray).array().floor().cast<int>();
  const auto most = static_cast<int>(margin) + 1;  // adjacent cells have distance 0
  const Eigen::Array3i low = (center - most).max((start.array() - reach).max(0.0).cast<int>());
  const Eigen::Array3i high = (center + most).min((start.array() + reach).min(last_.cast<double>()).cast<int>());
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const Eigen::Array3i between = ((Eigen::Array3i(x, y, z) - center).abs() - 1).max(0);
        if (between.square().sum() <= margin * margin) cells_[x + y * pitch_[1] + z * pitch_[2]] = 0;
      }
}

std::uint64_t RayMarks::layer_bits(const Eigen::Vector3i& block, int layer) const {
  static_assert(std::endian::native == std::endian::little);
  const std::ptrdiff_t first =
      kBlockEdge * (block[0] + block[1] * pitch_[1]) + (kBlockEdge * block[2] + layer) * pitch_[2];
  std::uint64_t bits = 0;
  for (int y = 0; y < kBlockEdge; ++y) {
    std::uint64_t row = 0;
    std::memcpy(&row, cells_ + first + y * pitch_[1], sizeof row);
    bits |= (row * 0x0102040810204080ull >> 56) << (8 * y);  // byte i of zeros and ones becomes bit i
  }
  return bits;
}

}  // namespace lapis::mapping
