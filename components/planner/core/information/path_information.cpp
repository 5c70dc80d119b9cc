#include "planner/core/information/path_information.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include <tbb/parallel_for.h>

namespace lapis::planner {
namespace {

using mapping::kBlockEdge;
using mapping::kBlockVoxels;

/// The blocks around the views of a path, and the reach of the cells in the blocks that a ray came to. Each thread
/// keeps its window, because fresh memory from the system costs more time than most of the work that uses it.
template <class Real>
class Window {
 public:
  using Field = BasicInformationField<Real>;
  using Reach = std::array<Real, kBlockVoxels>;

  struct Entry {
    const typename Field::Block* block;
    std::size_t reach;  ///< index in reaches_, or kNone
  };

  /// @param low, high corners of the box [voxels of the map]
  void open(const Field& field, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const auto block_of_point = [](const Eigen::Vector3d& p) {
      return Eigen::Vector3i((p / kBlockEdge).array().floor().cast<int>());
    };
    first_ = block_of_point(low);
    size_ = block_of_point(high) - first_ + Eigen::Vector3i::Ones();
    used_ = 0;
    entries_.clear();
    for (int z = 0; z < size_.z(); ++z)
      for (int y = 0; y < size_.y(); ++y)
        for (int x = 0; x < size_.x(); ++x)
          entries_.push_back({&field.block({first_.x() + x, first_.y() + y, first_.z() + z}), kNone});
  }

  /// Distance between the indices of neighbouring blocks along each axis, for entry().
  Eigen::Vector3i strides() const { return {1, size_.x(), size_.x() * size_.y()}; }
  /// Index of a block for entry().
  int index_of(const Eigen::Vector3i& block) const { return strides().dot(block - first_); }
  const Entry& entry(int index) {
    Entry& entry = entries_[static_cast<std::size_t>(index)];
    if (entry.reach == kNone) {
      if (used_ == reaches_.size()) reaches_.emplace_back();
      reaches_[used_].fill(Real{0});
      entry.reach = used_++;
    }
    return entry;
  }
  Reach& reach(const Entry& entry) { return reaches_[entry.reach]; }

  /// Sum of gain times reach. The order of the sum is always that of the entries.
  double information() const {
    double sum = 0.0;
    for (const Entry& entry : entries_)
      if (entry.reach != kNone) sum += product(entry.block->gain, reaches_[entry.reach]);
    return sum;
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  static double product(const Reach& gain, const Reach& reach) {
    std::array<Real, kBlockEdge> sums{};
    for (std::size_t i = 0; i < kBlockVoxels; i += kBlockEdge)
      for (std::size_t k = 0; k < kBlockEdge; ++k) sums[k] += gain[i + k] * reach[i + k];
    double sum = 0.0;
    for (const Real s : sums) sum += static_cast<double>(s);
    return sum;
  }

  Eigen::Vector3i first_, size_;
  std::vector<Entry> entries_;
  std::vector<Reach> reaches_;
  std::size_t used_ = 0;
};

/// Time along a ray in whole ticks. Sums are exact, so that cells and blocks agree on when the ray leaves them.
using Ticks = std::int64_t;
constexpr Ticks kRange = Ticks{1} << 40;
constexpr Ticks kNever = Ticks{1} << 44;

/// How a ray moves along one axis.
struct Axis {
  Ticks next;        ///< when the ray enters the next cell
  Ticks per_cell;    ///< from one cell to the next
  Ticks block_end;   ///< when the ray enters the next block
  int cell_stride;   ///< signed difference of offset_in_block between neighbours
  int block_stride;  ///< the same for indices of Window::entry

  /// @param start [voxels of the map]
  /// @param travel displacement along the axis until the end of the range [voxels]
  Axis(double start, double travel, int cell_stride_, int block_stride_)
      : cell_stride(travel < 0.0 ? -cell_stride_ : cell_stride_),
        block_stride(travel < 0.0 ? -block_stride_ : block_stride_) {
    const double cell = std::floor(start), to_next = travel < 0.0 ? start - cell : cell + 1.0 - start;
    const int in_block = static_cast<int>(cell) & (kBlockEdge - 1);
    const int cells_left = travel < 0.0 ? in_block : kBlockEdge - 1 - in_block;
    const double ticks = static_cast<double>(kRange) / std::abs(travel);
    per_cell = static_cast<Ticks>(std::min(static_cast<double>(kNever), ticks));
    next = static_cast<Ticks>(std::min(static_cast<double>(kNever), to_next * ticks));
    block_end = next + cells_left * per_cell;
  }

  void step_cell(Ticks now, int& cell) {
    cell += next == now ? cell_stride : 0;
    next += next == now ? per_cell : 0;
  }
  void step_block(Ticks now, int& cell, int& block) {
    if (block_end != now) return;
    cell -= kBlockEdge * cell_stride;
    block += block_stride;
    block_end += kBlockEdge * per_cell;
  }
};

struct Ray {
  Axis x, y, z;
  int cell;   ///< offset_in_block
  int block;  ///< index for Window::entry

  Ray(const Eigen::Vector3d& start, const Eigen::Vector3d& travel, int cell_, int block_,
      const Eigen::Vector3i& block_strides)
      : x(start.x(), travel.x(), 1, block_strides.x()), y(start.y(), travel.y(), kBlockEdge, block_strides.y()),
        z(start.z(), travel.z(), kBlockEdge * kBlockEdge, block_strides.z()), cell(cell_), block(block_) {}

  Ticks next() const { return std::min(std::min(x.next, y.next), z.next); }
  Ticks block_end() const { return std::min(std::min(x.block_end, y.block_end), std::min(z.block_end, kRange)); }
  void step_cell(Ticks now) {
    x.step_cell(now, cell);
    y.step_cell(now, cell);
    z.step_cell(now, cell);
  }
  void step_block(Ticks now) {
    x.step_block(now, cell, block);
    y.step_block(now, cell, block);
    z.step_block(now, cell, block);
  }
};

template <Counting kCounting, class Real>
void trace(Ray ray, Real min_reach, Window<Real>& window) {
  Real reach{1};
  while (true) {
    const auto& entry = window.entry(ray.block);
    const auto& free = entry.block->free;
    auto& reached = window.reach(entry);
    const Ticks block_end = ray.block_end();
    Ticks now = 0;
    do {
      const auto cell = static_cast<std::size_t>(ray.cell);
      reached[cell] = kCounting == Counting::kOnce ? std::max(reached[cell], reach) : reached[cell] + reach;
      reach *= free[cell];
      now = ray.next();
      ray.step_cell(now);
    } while (now < block_end && reach >= min_reach);
    if (now >= kRange || reach < min_reach) return;
    ray.step_block(now);
  }
}

template <Counting kCounting, class Real>
void look(const View& view, const geometry::Pose& T_map_camera, double resolution_m, Window<Real>& window) {
  const Eigen::Vector3d start = T_map_camera.translation() / resolution_m;
  const Eigen::Matrix3d travel = T_map_camera.linear() * (view.config().range_m / resolution_m);
  const auto whole = [](double v) { return static_cast<std::int32_t>(std::floor(v)); };
  const mapping::VoxelIndex voxel{whole(start.x()), whole(start.y()), whole(start.z())};
  const mapping::BlockIndex block = block_of(voxel);
  const int first_block = window.index_of({block.x, block.y, block.z});
  const auto min_reach = static_cast<Real>(view.config().min_reach);
  for (const Eigen::Vector3d& direction : view.directions())
    trace<kCounting>(Ray(start, travel * direction, offset_in_block(voxel), first_block, window.strides()), min_reach,
                     window);
}

/// Box that holds all rays, with a margin of one voxel [voxels of the map].
std::pair<Eigen::Vector3d, Eigen::Vector3d> box_of(const View& view, const ViewPath& path, double resolution_m) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const geometry::Pose& T_map_camera : path) {
    const Eigen::Vector3d center = T_map_camera.translation();
    Eigen::Vector3d view_low = center, view_high = center;
    for (const Eigen::Vector3d& corner : view.corners()) {
      view_low = view_low.cwiseMin(T_map_camera * corner);
      view_high = view_high.cwiseMax(T_map_camera * corner);
    }
    const Eigen::Vector3d range = Eigen::Vector3d::Constant(view.config().range_m);
    low = low.cwiseMin(view_low.cwiseMax(center - range));
    high = high.cwiseMax(view_high.cwiseMin(center + range));
  }
  return {(low / resolution_m).array() - 1.0, (high / resolution_m).array() + 1.0};
}

template <class Real>
Window<Real>& window_around(const BasicInformationField<Real>& field, const View& view, const ViewPath& path) {
  for (const geometry::Pose& T_map_camera : path)
    if (!geometry::is_valid(T_map_camera)) throw std::invalid_argument("path_information: a pose is not valid");
  thread_local Window<Real> window;
  const auto [low, high] = box_of(view, path, field.resolution_m());
  window.open(field, low, high);
  return window;
}

}  // namespace

template <class Real>
double path_information(const BasicInformationField<Real>& field, const View& view, const ViewPath& path,
                        Counting counting) {
  if (path.empty()) return 0.0;
  Window<Real>& window = window_around(field, view, path);
  const auto look_from = counting == Counting::kOnce ? look<Counting::kOnce, Real> : look<Counting::kEveryRay, Real>;
  for (const geometry::Pose& T_map_camera : path) look_from(view, T_map_camera, field.resolution_m(), window);
  return window.information();
}

template <class Real>
std::vector<double> growing_information(const BasicInformationField<Real>& field, const View& view,
                                        const ViewPath& path) {
  std::vector<double> information;
  if (path.empty()) return information;
  Window<Real>& window = window_around(field, view, path);
  for (const geometry::Pose& T_map_camera : path) {
    look<Counting::kOnce, Real>(view, T_map_camera, field.resolution_m(), window);
    information.push_back(window.information());
  }
  return information;
}

template <class Real>
std::vector<double> path_information(const BasicInformationField<Real>& field, const View& view,
                                     std::span<const ViewPath> paths, Counting counting) {
  std::vector<double> information(paths.size());
  tbb::parallel_for(std::size_t{0}, paths.size(),
                    [&](std::size_t i) { information[i] = path_information(field, view, paths[i], counting); });
  return information;
}

template std::vector<double> growing_information(const BasicInformationField<float>&, const View&, const ViewPath&);
template std::vector<double> growing_information(const BasicInformationField<double>&, const View&, const ViewPath&);
template double path_information(const BasicInformationField<float>&, const View&, const ViewPath&, Counting);
template double path_information(const BasicInformationField<double>&, const View&, const ViewPath&, Counting);
template std::vector<double> path_information(const BasicInformationField<float>&, const View&,
                                              std::span<const ViewPath>, Counting);
template std::vector<double> path_information(const BasicInformationField<double>&, const View&,
                                              std::span<const ViewPath>, Counting);

}  // namespace lapis::planner
