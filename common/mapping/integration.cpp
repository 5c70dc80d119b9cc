#include "common/mapping/integration.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>

// Functions that the compiler vectorises come in two versions, of which the processor chooses when the program starts.
// Both give the same bits: neither fuses multiplication and addition. Not under sanitizers: the choice is made before
// they are ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LAPIS_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define LAPIS_VECTORISED
#endif

namespace lapis::mapping {
namespace {

/// Cells of the frame's box are numbered block by block (512 per block), so that ascending ids are in the order of
/// FrameVotes.
using CellId = std::uint32_t;

/// Box of whole blocks, in voxels of the map, that holds everything the frame can reach.
class FrameBox {
 public:
  FrameBox(const Eigen::Vector3d& low_voxels, const Eigen::Vector3d& high_voxels, int margin_voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto first = static_cast<std::int32_t>(std::floor(low_voxels[axis])) - margin_voxels;
      const auto last = static_cast<std::int32_t>(std::floor(high_voxels[axis])) + margin_voxels;
      first_block_[axis] = floor_divide(first, kBlockEdge);
      blocks_[axis] = floor_divide(last, kBlockEdge) - first_block_[axis] + 1;
    }
  }

  /// Corner of the box [voxels of the map].
  Eigen::Vector3d origin() const { return (first_block_ * kBlockEdge).cast<double>(); }
  Eigen::Vector3i blocks() const { return blocks_; }
  std::size_t block_count() const { return static_cast<std::size_t>(blocks_.prod()); }
  /// Of the cell with these coordinates in the box.
  CellId id(unsigned x, unsigned y, unsigned z) const {
    const auto columns = static_cast<unsigned>(blocks_[0]), rows = static_cast<unsigned>(blocks_[1]);
    const unsigned block = ((z >> 3) * rows + (y >> 3)) * columns + (x >> 3);
    return block << 9 | (z & 7u) << 6 | (y & 7u) << 3 | (x & 7u);
  }
  BlockIndex block(const Eigen::Vector3i& b) const {
    return {first_block_[0] + b[0], first_block_[1] + b[1], first_block_[2] + b[2]};
  }

 private:
  Eigen::Vector3i first_block_;
  Eigen::Vector3i blocks_;
};

/// A sample's cell in the box, as x | y << 10 | z << 20 (a box has at most 1024 cells along an axis), and kBeyond if
/// its ray ends there without a hit.
using SampleCell = std::uint32_t;
constexpr SampleCell kBeyond = 1u << 30;
constexpr SampleCell kNoCell = 0xffffffffu;  ///< of a sample that says nothing
static_assert(2 * (kMaxRangeInVoxels + kMaxKernelLength_voxels) + 18 <= 1024);

/// The frame in box coordinates: p_box = offset + depth_mm * (x_step * column + y_step * row + corner).
class Projector {
 public:
  Projector(const CompactFrame& frame, const geometry::Pose& T_map_camera, const FrameBox& box, double resolution_m)
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
  /// From the camera to the point at 1 mm depth [voxels] in row 0.
  Eigen::Vector3d direction(int column) const { return corner_ + x_step_ * column; }
  Eigen::Vector3d direction_of_sample(std::uint32_t sample) const {
    return direction(static_cast<int>(sample) % columns_) + y_step_ * (static_cast<int>(sample) / columns_);
  }

 private:
  int columns_;
  Eigen::Vector3d x_step_, y_step_, corner_, camera_;
};

FrameBox box_of(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                double resolution_m) {
  const double max_range_m = config.max_range_m;
  const geometry::PinholeCamera& camera = frame.camera();
  const Eigen::Vector3d center = T_map_camera.translation();
  Eigen::Vector3d low = center, high = center;
  for (const double u : {0.0, camera.width - 1.0})
    for (const double v : {0.0, camera.height - 1.0}) {
      const Eigen::Vector3d p = T_map_camera * camera.unproject(u, v, max_range_m);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  low = low.cwiseMax(center - Eigen::Vector3d::Constant(max_range_m));
  high = high.cwiseMin(center + Eigen::Vector3d::Constant(max_range_m));
  const int margin_voxels = 1 + static_cast<int>(std::ceil(config.kernel_length_voxels));
  return FrameBox(low / resolution_m, high / resolution_m, margin_voxels);
}

/// Neighbouring samples of a row that fall into the same cell with the same label.
struct Run {
  CellId cell;
  std::uint32_t first_sample;
  std::uint32_t count;
  std::uint16_t label;
  std::uint16_t is_beyond;
};

/// A vote of a hit for a cell near it.
struct KernelVote {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;
  std::uint16_t weight;
};

/// Working memory of compute_votes. Kept by each thread, because fresh memory from the system costs more time than
/// most of what is done with it.
struct Scratch {
  std::array<std::vector<double>, 3> directions;  ///< per column, in row 0
  std::array<std::vector<double>, 3> ray;         ///< per column of the current row: camera to point [voxels]
  std::vector<double> squared_range, cut;
  std::vector<SampleCell> cells;
  std::vector<std::uint8_t> is_start;  ///< 1 where a run begins; whole words, zero after the row
  std::vector<std::uint32_t> starts;   ///< columns where runs begin, then the number of columns
  std::vector<std::uint16_t> no_labels;
  std::vector<Run> runs, sorted_runs;
  std::vector<KernelVote> kernel_votes, sorted_kernel_votes;
  std::vector<std::uint8_t> marks;  ///< one byte per cell of the box, x fastest

  void resize_row(std::size_t columns) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      directions[axis].resize(columns);
      ray[axis].resize(columns);
    }
    squared_range.resize(columns);
    cut.resize(columns);
    cells.resize(columns);
    is_start.assign((columns + 7) / 8 * 8, 0);
    starts.resize(columns + 1);
    no_labels.resize(columns);
  }
};

LAPIS_VECTORISED
void scale_directions(const double* directions, double row_offset, const std::uint16_t* depth_mm, std::size_t count,
                      double* ray) {
  for (std::size_t i = 0; i < count; ++i) ray[i] = (directions[i] + row_offset) * depth_mm[i];
}

LAPIS_VECTORISED
void square_ranges(const double* x, const double* y, const double* z, std::size_t count, double* squared) {
  for (std::size_t i = 0; i < count; ++i) squared[i] = x[i] * x[i] + (y[i] * y[i] + z[i] * z[i]);
}

/// Box coordinates are positive, so truncation rounds down.
LAPIS_VECTORISED
void locate(const double* ray, double camera, unsigned shift, std::size_t count, SampleCell* cells) {
  for (std::size_t i = 0; i < count; ++i)
    cells[i] |= static_cast<SampleCell>(static_cast<std::int32_t>(camera + ray[i])) << shift;
}

/// Begins the cells of a row with kNoCell for samples that say nothing and 0 for all others; returns how many are
/// beyond the range.
LAPIS_VECTORISED
std::int32_t judge_ranges(const double* squared_range, const std::uint16_t* depth_mm, double squared_min,
                          double squared_max, std::size_t count, SampleCell* cells) {
  std::int32_t beyond = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool says_nothing = (squared_range[i] < squared_min) | (depth_mm[i] == 0);
    cells[i] = says_nothing ? kNoCell : 0;
    beyond += squared_range[i] > squared_max ? 1 : 0;
  }
  return beyond;
}

/// Shares of the rays that are within the range.
LAPIS_VECTORISED
void find_cuts(const double* squared_range, double max_range, std::size_t count, double* cut, SampleCell* cells) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_beyond = squared_range[i] > max_range * max_range;
    const double share = max_range / std::sqrt(squared_range[i]);
    cut[i] = is_beyond ? share : 1.0;
    cells[i] |= is_beyond ? kBeyond : 0;
  }
}

LAPIS_VECTORISED
void cut_rays(const double* cut, std::size_t count, double* ray) {
  for (std::size_t i = 0; i < count; ++i) ray[i] *= cut[i];
}

/// Cells of the samples of a row.
void locate_row(const Projector& projector, int row, const std::uint16_t* depth_mm, double min_range, double max_range,
                Scratch& s) {
  const std::size_t columns = s.cells.size();
  for (std::size_t axis = 0; axis < 3; ++axis)
    scale_directions(s.directions[axis].data(), projector.y_step()[static_cast<int>(axis)] * row, depth_mm, columns,
                     s.ray[axis].data());
  square_ranges(s.ray[0].data(), s.ray[1].data(), s.ray[2].data(), columns, s.squared_range.data());
  const std::int32_t beyond = judge_ranges(s.squared_range.data(), depth_mm, min_range * min_range,
                                           max_range * max_range, columns, s.cells.data());
  if (beyond > 0) {
    find_cuts(s.squared_range.data(), max_range, columns, s.cut.data(), s.cells.data());
    for (std::vector<double>& ray : s.ray) cut_rays(s.cut.data(), columns, ray.data());
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    locate(s.ray[axis].data(), projector.camera()[static_cast<int>(axis)], static_cast<unsigned>(10 * axis), columns,
           s.cells.data());
}

LAPIS_VECTORISED
void find_starts(const SampleCell* cells, const std::uint16_t* labels, std::size_t count, std::uint8_t* is_start) {
  is_start[0] = 1;
  for (std::size_t i = 1; i < count; ++i) is_start[i] = (cells[i] != cells[i - 1]) | (labels[i] != labels[i - 1]);
}

/// Appends the runs of a row.
void append_runs(const FrameBox& box, const std::uint16_t* labels, std::uint32_t first_sample, Scratch& s) {
  const std::size_t columns = s.cells.size();
  find_starts(s.cells.data(), labels, columns, s.is_start.data());
  std::size_t count = 0;
  for (std::size_t word = 0; word < columns; word += 8) {
    std::uint64_t starts = 0;
    std::memcpy(&starts, &s.is_start[word], sizeof starts);
    for (; starts != 0; starts &= starts - 1)
      s.starts[count++] = static_cast<std::uint32_t>(word) + static_cast<std::uint32_t>(std::countr_zero(starts)) / 8;
  }
  s.starts[count] = static_cast<std::uint32_t>(columns);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t begin = s.starts[k];
    const SampleCell c = s.cells[begin];
    if (c == kNoCell) continue;
    const CellId cell = box.id(c & 0x3ffu, c >> 10 & 0x3ffu, c >> 20 & 0x3ffu);
    s.runs.push_back({cell, first_sample + begin, s.starts[k + 1] - begin, labels[begin], (c & kBeyond) != 0});
  }
}

/// Assigns every usable sample to a cell, in scan order.
void find_runs(const CompactFrame& frame, const Projector& projector, const FrameBox& box,
               const IntegrationConfig& config, double resolution_m, Scratch& s) {
  const auto columns = static_cast<std::size_t>(frame.columns());
  s.resize_row(columns);
  s.runs.clear();
  s.kernel_votes.clear();
  for (int column = 0; column < frame.columns(); ++column)
    for (std::size_t axis = 0; axis < 3; ++axis)
      s.directions[axis][static_cast<std::size_t>(column)] = projector.direction(column)[static_cast<int>(axis)];
  const double max_range = config.max_range_m / resolution_m, min_range = config.min_range_m / resolution_m;
  for (int row = 0; row < frame.rows(); ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    locate_row(projector, row, &frame.depth_mm()[first], min_range, max_range, s);
    append_runs(box, frame.has_labels() ? &frame.labels()[first] : s.no_labels.data(),
                static_cast<std::uint32_t>(first), s);
  }
}

/// Stable sort by cell: least significant digit radix sort, about ten times faster here than std::stable_sort.
template <class Entry>
void sort_by_cell(std::vector<Entry>& entries, std::vector<Entry>& sorted, std::size_t cell_count) {
  constexpr unsigned kDigitBits = 11;
  sorted.resize(entries.size());
  for (unsigned shift = 0; cell_count >> shift != 0; shift += kDigitBits) {
    const auto digit = [shift](const Entry& entry) { return entry.cell >> shift & ((1u << kDigitBits) - 1u); };
    std::array<std::uint32_t, (1u << kDigitBits) + 1> begin{};
    for (const Entry& entry : entries) ++begin[digit(entry) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const Entry& entry : entries) sorted[begin[digit(entry)]++] = entry;
    entries.swap(sorted);
  }
}

constexpr std::uint64_t kCertain = 255;  ///< confidence of a sample

/// How much of the runs' samples in one cell is for a label.
struct LabelTally {
  std::uint16_t label;
  std::uint32_t count;   ///< of samples
  std::uint64_t weight;  ///< sum of their confidence
};

/// All samples of one cell.
struct CellSummary {
  bool is_hit = false;
  std::uint16_t label = 0;         ///< with most weight of the labelled samples
  std::uint16_t label_weight = 0;  ///< its share of the vote [1/256 vote]
  std::uint32_t ray_sample = 0;    ///< the sample whose ray is followed
};

/// Sum of the confidence of a run's samples.
std::uint64_t weight_of(const Run& run, const std::vector<std::uint8_t>& confidence) {
  if (confidence.empty()) return kCertain * run.count;
  const std::uint8_t* first = &confidence[run.first_sample];
  return std::accumulate(first, first + run.count, std::uint64_t{0});
}

void add_to(std::vector<LabelTally>& tally, const LabelTally& votes) {
  const auto same = [&votes](const LabelTally& entry) { return entry.label == votes.label; };
  const auto it = std::find_if(tally.begin(), tally.end(), same);
  if (it == tally.end()) {
    tally.push_back(votes);
  } else {
    it->count += votes.count;
    it->weight += votes.weight;
  }
}

/// The label with most weight, ties to the smaller one; label 0 when there is none.
LabelTally winner(const std::vector<LabelTally>& tally) {
  LabelTally best{};
  for (const LabelTally& entry : tally)
    if (entry.weight > best.weight || (entry.weight == best.weight && entry.weight > 0 && entry.label < best.label))
      best = entry;
  return best;
}

/// Votes of the runs [first, last) of one cell.
CellSummary summarise(const Run* first, const Run* last, const std::vector<std::uint8_t>& confidence,
                      std::vector<LabelTally>& tally) {
  tally.clear();
  std::uint32_t hits = 0, beyond = 0;
  for (const Run* run = first; run != last; ++run) {
    (run->is_beyond ? beyond : hits) += run->count;
    if (run->is_beyond || run->label == 0) continue;
    add_to(tally, {run->label, run->count, weight_of(*run, confidence)});
  }
  CellSummary summary;
  summary.is_hit = hits > 0;
  if (const LabelTally most = winner(tally); most.label != 0) {
    summary.label = most.label;
    summary.label_weight =
        static_cast<std::uint16_t>((most.weight * kOneVote + kCertain / 2 * most.count) / (kCertain * most.count));
  }
  // The middle sample in scan order, of those that decide what the cell is.
  std::uint32_t skip = (summary.is_hit ? hits : beyond) / 2;
  for (const Run* run = first; run != last; ++run) {
    if ((run->is_beyond != 0) == summary.is_hit) continue;
    if (skip < run->count) {
      summary.ray_sample = run->first_sample + skip;
      break;
    }
    skip -= run->count;
  }
  return summary;
}

/// One axis of a walk through the cells. Distances along the ray are 64-bit fixed point (kRayLength = its whole
/// length), so that additions are exact. The lowest two bits hold the axis: when a ray meets an edge, the lower axis is
/// first.
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

/// A ray on its way through the cells. Axis `d` is the one along which it goes furthest, so that between two walls of d
/// it meets at most one wall of each other axis.
struct Walk {
  AxisWalk d, a, b;
  std::int64_t end;
  std::uint8_t* mark;

  /// Wall by wall until the first wall of d; false when the walk ends before.
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

  /// From a wall of d to the next ones. Masks replace the branches that a processor could not predict.
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

/// One byte per cell of the box, x fastest; not zero where a ray gives a miss.
struct Marks {
  std::uint8_t* cells;
  std::array<std::ptrdiff_t, 3> pitch;
  Eigen::Array3i last;  ///< coordinates of the last cell

  Marks(const FrameBox& box, std::vector<std::uint8_t>& memory) {
    memory.assign(box.block_count() * kBlockVoxels, 0);
    cells = memory.data();
    const Eigen::Vector3i edges = box.blocks() * kBlockEdge;
    pitch = {1, edges[0], static_cast<std::ptrdiff_t>(edges[0]) * edges[1]};
    last = edges.array() - 1;
  }

  /// Marks every cell that the segment from `start` along `ray` [voxels] leaves before the share `t_end` of its length.
  void add_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double t_end) {
    std::array<AxisWalk, 3> axes;
    std::uint8_t* mark = cells;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<int>(axis);
      axes[axis] = AxisWalk(start[i], ray[i], i, pitch[axis]);
      mark += static_cast<int>(start[i]) * pitch[axis];
    }
    int d = 0;
    ray.cwiseAbs().maxCoeff(&d);
    const auto dominant = static_cast<std::size_t>(d);
    Walk walk{axes[dominant], axes[(dominant + 1) % 3], axes[(dominant + 2) % 3], AxisWalk::end(t_end), mark};
    if (!walk.to_wall_of_d()) return;
    walk.along_d();
    walk.to_wall_of_d();  // the walls of the other axes in the last cells
  }

  /// Takes the marks off the cells within `margin` of the one in which the segment from `start` along `ray` ends; only
  /// those matter that are within `reach` of the start.
  void clear_around(const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double margin, double reach) {
    const Eigen::Array3i center = (start + ray).array().floor().cast<int>();
    const auto most = static_cast<int>(margin) + 1;  // cells that touch are at distance 0
    const Eigen::Array3i low = (center - most).max((start.array() - reach).max(0.0).cast<int>());
    const Eigen::Array3i high = (center + most).min((start.array() + reach).min(last.cast<double>()).cast<int>());
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          const Eigen::Array3i between = ((Eigen::Array3i(x, y, z) - center).abs() - 1).max(0);
          if (between.square().sum() <= margin * margin) cells[x + y * pitch[1] + z * pitch[2]] = 0;
        }
  }

  /// The 64 cells of a layer of a block, from the cell at `first`, as bits.
  std::uint64_t layer_bits(std::ptrdiff_t first) const {
    static_assert(std::endian::native == std::endian::little);
    std::uint64_t bits = 0;
    for (int y = 0; y < kBlockEdge; ++y) {
      std::uint64_t row = 0;
      std::memcpy(&row, cells + first + y * pitch[1], sizeof row);
      bits |= (row * 0x0102040810204080ull >> 56) << (8 * y);  // byte i of zeros and ones becomes bit i
    }
    return bits;
  }
};

double depth_sigma_m(double depth_m, const IntegrationConfig& config) {
  return config.depth_noise_per_m * depth_m * depth_m;
}

/// Share of a ray up to its measured point within which cells may get a miss.
double free_share(double range_voxels, double depth_m, const IntegrationConfig& config, double resolution_m) {
  const double margin_voxels = config.end_margin_voxels + 2.0 * depth_sigma_m(depth_m, config) / resolution_m;
  return 1.0 - margin_voxels / range_voxels;
}

/// Drift in voxels.
class DriftLimit {
 public:
  DriftLimit(const Drift& drift, double resolution_m)
      : position_(drift.position_m / resolution_m), rotation_(drift.rotation_rad), is_none_(drift.is_none()),
        reach_(drift.range_m(0.5 * resolution_m) / resolution_m) {}

  bool is_none() const { return is_none_; }
  double reach() const { return reach_; }  ///< up to which anything is said; infinite without drift
  /// How far the surface at this distance may be from where it was measured.
  double margin(double range) const { return kDriftMargin_sigmas * (position_ + rotation_ * range); }
  /// Length of the ray to a surface at this distance within which cells may get a miss.
  double free_length(double range) const { return std::min(reach_, range - margin(range)); }

 private:
  double position_, rotation_;
  bool is_none_;
  double reach_;
};

/// What a hit is worth [1/256 vote]: the probability that the noise of its depth is less than half a voxel.
std::uint16_t hit_weight(double depth_m, const IntegrationConfig& config, double resolution_m) {
  const double half_voxel_sigmas = 0.5 * resolution_m / depth_sigma_m(depth_m, config);  // infinite without noise
  const auto weight = std::lround(std::erf(half_voxel_sigmas / std::numbers::sqrt2) * kOneVote);
  return static_cast<std::uint16_t>(std::max(weight, 1l));
}

struct CellHit {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;  ///< for the label [1/256 vote]
  std::uint16_t weight;        ///< altogether
};

CellHit hit_of(CellId id, const CellSummary& cell, double depth_m, const IntegrationConfig& config,
               double resolution_m) {
  const std::uint16_t weight = hit_weight(depth_m, config, resolution_m);
  return {id, cell.label, static_cast<std::uint16_t>(weight * cell.label_weight / kOneVote), weight};
}

bool is_within_heights(const BlockIndex& block, int layer, const IntegrationConfig& config, double resolution_m) {
  const double center_m = (block.z * kBlockEdge + layer + 0.5) * resolution_m;
  return center_m >= config.min_height_m && center_m <= config.max_height_m;
}

void append_votes(const CellHit& hit, std::uint16_t offset, std::vector<HitVote>& votes) {
  if (hit.weight > hit.label_weight)
    votes.push_back({offset, 0, static_cast<std::uint32_t>(hit.weight - hit.label_weight)});
  if (hit.label_weight > 0) votes.push_back({offset, hit.label, hit.label_weight});
}

/// Votes of the block number `number` at `at` of the box; `hit` is the first hit of the block and becomes that of the
/// next.
void collect_block(const FrameBox& box, const Eigen::Vector3i& at, CellId number, const Marks& marks,
                   const IntegrationConfig& config, double resolution_m, const CellHit*& hit, const CellHit* hits_end,
                   FrameVotes& votes) {
  BlockVotes of_block;
  of_block.block = box.block(at);
  std::uint64_t any = 0;
  for (int layer = 0; layer < kBlockEdge; ++layer) {
    if (!is_within_heights(of_block.block, layer, config, resolution_m)) continue;
    const std::ptrdiff_t first =
        kBlockEdge * (at[0] + at[1] * marks.pitch[1]) + (kBlockEdge * at[2] + layer) * marks.pitch[2];
    any |= of_block.misses[static_cast<std::size_t>(layer)] = marks.layer_bits(first);
  }
  of_block.hits_begin = static_cast<std::uint32_t>(votes.hits.size());
  for (; hit != hits_end && hit->cell / kBlockVoxels == number; ++hit) {
    const auto offset = static_cast<std::uint16_t>(hit->cell % kBlockVoxels);
    of_block.misses[offset / 64u] &= ~(std::uint64_t{1} << offset % 64u);
    if (is_within_heights(of_block.block, offset >> 6, config, resolution_m)) append_votes(*hit, offset, votes.hits);
  }
  of_block.hits_end = static_cast<std::uint32_t>(votes.hits.size());
  const auto& misses = of_block.misses;
  const bool has_misses = any != 0 && std::any_of(misses.begin(), misses.end(), [](std::uint64_t w) { return w != 0; });
  if (has_misses || of_block.hits_end > of_block.hits_begin) votes.blocks.push_back(of_block);
}

/// Votes of a hit at `point` [voxels of the box] for the cells whose centres are within the kernel's length.
void spread(const CellHit& hit, const Eigen::Vector3d& point, double length, const FrameBox& box,
            std::vector<KernelVote>& votes) {
  const Eigen::Array3i low = (point.array() - length).floor().cast<int>();
  const Eigen::Array3i high = (point.array() + length).floor().cast<int>();
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const double distance = (Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) - point).norm();
        const auto weight = static_cast<std::uint16_t>(std::lround(sparse_kernel(distance / length) * hit.weight));
        if (weight == 0) continue;
        const auto label_weight = static_cast<std::uint16_t>(weight * hit.label_weight / hit.weight);
        const CellId cell = box.id(static_cast<unsigned>(x), static_cast<unsigned>(y), static_cast<unsigned>(z));
        votes.push_back({cell, hit.label, label_weight, weight});
      }
}

/// The vote of one cell, of all that the hits around it say.
CellHit summarise(std::span<const KernelVote> votes, std::vector<LabelTally>& tally) {
  tally.clear();
  std::uint32_t sum = 0, labelled = 0;
  for (const KernelVote& vote : votes) {
    sum += vote.weight;
    labelled += vote.label_weight;
    add_to(tally, {vote.label, 0, vote.label_weight});
  }
  const std::uint32_t weight = std::min(sum, kOneVote);
  return {votes.front().cell, winner(tally).label, static_cast<std::uint16_t>(weight * labelled / sum),
          static_cast<std::uint16_t>(weight)};
}

/// Replaces what hits say by what all around them say. Both are sorted by cell.
void smooth(const std::vector<KernelVote>& votes, std::vector<CellHit>& hits) {
  std::vector<LabelTally> tally;
  auto first = votes.begin();
  for (CellHit& hit : hits) {
    while (first->cell < hit.cell) ++first;
    auto last = first;
    while (last != votes.end() && last->cell == hit.cell) ++last;
    hit = summarise(std::span(first, last), tally);
    first = last;
  }
}

FrameVotes collect(const FrameBox& box, const std::vector<CellHit>& hits, const Marks& marks,
                   const IntegrationConfig& config, double resolution_m) {
  FrameVotes votes;
  votes.hits.reserve(hits.size());
  const CellHit* hit = hits.data();
  const Eigen::Vector3i blocks = box.blocks();
  CellId number = 0;
  for (int z = 0; z < blocks[2]; ++z)
    for (int y = 0; y < blocks[1]; ++y)
      for (int x = 0; x < blocks[0]; ++x, ++number)
        collect_block(box, {x, y, z}, number, marks, config, resolution_m, hit, hits.data() + hits.size(), votes);
  return votes;
}

}  // namespace

double Drift::range_m(double limit_m) const {
  if (position_m > limit_m) return 0.0;
  return rotation_rad > 0.0 ? (limit_m - position_m) / rotation_rad : std::numeric_limits<double>::infinity();
}

double sparse_kernel(double share) {
  if (share >= 1.0) return 0.0;
  const double angle = 2.0 * std::numbers::pi * share;
  return (2.0 + std::cos(angle)) / 3.0 * (1.0 - share) + std::sin(angle) / (2.0 * std::numbers::pi);
}

void validate(const IntegrationConfig& config) {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::runtime_error(std::string("integration: ") + what);
  };
  require(config.max_range_m >= 0.5 && config.max_range_m <= 20.0, "max_range_m must be in [0.5, 20]");
  require(config.min_range_m >= 0.0 && config.min_range_m <= 5.0, "min_range_m must be in [0, 5]");
  require(config.min_range_m < config.max_range_m, "min_range_m must be below max_range_m");
  require(config.min_height_m < config.max_height_m, "min_height_m must be below max_height_m");
  require(config.end_margin_voxels >= 0.0 && config.end_margin_voxels <= 3.0, "end_margin_voxels must be in [0, 3]");
  require(config.depth_noise_per_m >= 0.0 && config.depth_noise_per_m <= 0.05,
          "depth_noise_per_m must be in [0, 0.05]");
  require(config.kernel_length_voxels == 0.0 || (config.kernel_length_voxels >= kMinKernelLength_voxels &&
                                                 config.kernel_length_voxels <= kMaxKernelLength_voxels),
          "kernel_length_voxels must be 0 or in [1.5, 3]");
}

FrameVotes compute_votes(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                         double resolution_m, const Drift& drift) {
  if (config.max_range_m / resolution_m > kMaxRangeInVoxels)
    throw std::runtime_error("integration: max_range_m exceeds 500 voxels; lower it or raise the map resolution");
  const DriftLimit limit(drift, resolution_m);
  if (limit.reach() * resolution_m <= config.min_range_m) return {};
  thread_local Scratch s;
  const FrameBox box = box_of(frame, T_map_camera, config, resolution_m);
  const Projector projector(frame, T_map_camera, box, resolution_m);
  find_runs(frame, projector, box, config, resolution_m, s);
  sort_by_cell(s.runs, s.sorted_runs, box.block_count() * kBlockVoxels);

  Marks marks(box, s.marks);
  std::vector<CellHit> hits;
  std::vector<LabelTally> tally;
  std::vector<Eigen::Vector3d> drifting;  // rays to surfaces that may be elsewhere
  for (std::size_t first = 0, last = 0; first < s.runs.size(); first = last) {
    while (last < s.runs.size() && s.runs[last].cell == s.runs[first].cell) ++last;
    const CellSummary cell = summarise(&s.runs[first], &s.runs[first] + (last - first), frame.confidence(), tally);
    const double depth_mm = frame.depth_mm()[cell.ray_sample], depth_m = depth_mm * 1e-3;
    Eigen::Vector3d ray = projector.direction_of_sample(cell.ray_sample) * depth_mm;
    const double range = ray.norm();
    double t_end = 1.0;
    if (!cell.is_hit) {
      ray *= config.max_range_m / resolution_m / range;
    } else {
      t_end = free_share(range, depth_m, config, resolution_m);
      if (!limit.is_none()) drifting.push_back(ray);
      if (range <= limit.reach()) hits.push_back(hit_of(s.runs[first].cell, cell, depth_m, config, resolution_m));
      if (range <= limit.reach() && config.kernel_length_voxels > 0.0)
        spread(hits.back(), projector.camera() + ray, config.kernel_length_voxels, box, s.kernel_votes);
    }
    if (!limit.is_none()) t_end = std::min(t_end, limit.free_length(range) / ray.norm());
    marks.add_ray(projector.camera(), ray, t_end);
  }
  for (const Eigen::Vector3d& ray : drifting)
    marks.clear_around(projector.camera(), ray, limit.margin(ray.norm()), limit.reach());
  if (config.kernel_length_voxels > 0.0) {
    sort_by_cell(s.kernel_votes, s.sorted_kernel_votes, box.block_count() * kBlockVoxels);
    smooth(s.kernel_votes, hits);
  }
  return collect(box, hits, marks, config, resolution_m);
}

}  // namespace lapis::mapping
