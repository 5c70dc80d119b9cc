#include "common/mapping/integration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace lapis::mapping {
namespace {

/// Cells of the frame's box are numbered block by block (512 per block), so that ascending ids are in the order of
/// FrameVotes and a block's passes are 64 consecutive bytes of the bit mask.
using CellId = std::uint32_t;

/// Box of whole blocks, in voxels of the map, that holds everything the frame can reach.
class FrameBox {
 public:
  FrameBox(const Eigen::Vector3d& low_voxels, const Eigen::Vector3d& high_voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto first = static_cast<std::int32_t>(std::floor(low_voxels[axis])) - 1;
      const auto last = static_cast<std::int32_t>(std::floor(high_voxels[axis])) + 1;
      first_block_[axis] = floor_divide(first, kBlockEdge);
      blocks_[axis] = floor_divide(last, kBlockEdge) - first_block_[axis] + 1;
    }
    // id = table[0][x] + table[1][y] + table[2][z]: walking needs no divisions.
    const std::array<int, 3> block_stride = {1, blocks_[0], blocks_[0] * blocks_[1]};
    const std::array<int, 3> cell_stride = {1, kBlockEdge, kBlockEdge * kBlockEdge};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int i = 0; i < blocks_[static_cast<int>(axis)] * kBlockEdge; ++i)
        table_[axis].push_back(static_cast<CellId>(i / kBlockEdge * block_stride[axis] * kBlockVoxels +
                                                   i % kBlockEdge * cell_stride[axis]));
  }

  /// Corner of the box [voxels of the map].
  Eigen::Vector3d origin() const { return (first_block_ * kBlockEdge).cast<double>(); }
  int edge(int axis) const { return blocks_[axis] * kBlockEdge; }
  std::size_t block_count() const { return static_cast<std::size_t>(blocks_.prod()); }
  const CellId* table(std::size_t axis) const { return table_[axis].data(); }
  CellId id(int x, int y, int z) const {
    return table_[0][static_cast<std::size_t>(x)] + table_[1][static_cast<std::size_t>(y)] +
           table_[2][static_cast<std::size_t>(z)];
  }
  BlockIndex block(std::size_t number) const {
    const auto n = static_cast<std::int32_t>(number);
    return {first_block_[0] + n % blocks_[0], first_block_[1] + n / blocks_[0] % blocks_[1],
            first_block_[2] + n / (blocks_[0] * blocks_[1])};
  }

 private:
  Eigen::Vector3i first_block_;
  Eigen::Vector3i blocks_;
  std::array<std::vector<CellId>, 3> table_;
};

constexpr std::uint16_t kBeyondRange = 0xffff;  ///< label of a sample that ends its ray without a hit

/// Neighbouring samples of a row that fall into the same cell with the same label.
struct Run {
  CellId cell;
  std::uint16_t label;
  std::uint16_t count;
  std::uint32_t first_sample;
};

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
  /// From the camera to the point at 1 mm depth [voxels].
  Eigen::Vector3d direction(int column, int row) const { return corner_ + x_step_ * column + y_step_ * row; }
  Eigen::Vector3d direction_of_sample(std::uint32_t sample) const {
    return direction(static_cast<int>(sample) % columns_, static_cast<int>(sample) / columns_);
  }

 private:
  int columns_;
  Eigen::Vector3d x_step_, y_step_, corner_, camera_;
};

FrameBox box_of(const CompactFrame& frame, const geometry::Pose& T_map_camera, double max_range_m,
                double resolution_m) {
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
  return FrameBox(low / resolution_m, high / resolution_m);
}

/// Assigns every usable sample to a cell, in scan order.
std::vector<Run> find_runs(const CompactFrame& frame, const CompactFrame::Samples& samples, const Projector& projector,
                           const FrameBox& box, const IntegrationConfig& config, double resolution_m) {
  std::vector<Run> runs;
  const double max_range = config.max_range_m / resolution_m, min_range = config.min_range_m / resolution_m;
  std::uint32_t sample = 0;
  for (int row = 0; row < frame.rows(); ++row)
    for (int column = 0; column < frame.columns(); ++column, ++sample) {
      const std::uint16_t depth_mm = samples.depth_mm[sample];
      if (depth_mm == 0) continue;
      Eigen::Vector3d ray = projector.direction(column, row) * depth_mm;
      const double squared_range = ray.squaredNorm();
      if (squared_range < min_range * min_range) continue;
      std::uint16_t label = samples.labels.empty() ? std::uint16_t{0} : samples.labels[sample];
      if (squared_range > max_range * max_range) {
        ray *= max_range / std::sqrt(squared_range);
        label = kBeyondRange;
      }
      // Box coordinates are positive, so truncation rounds down.
      const Eigen::Vector3i p = (projector.camera() + ray).cast<int>();
      const CellId cell = box.id(p.x(), p.y(), p.z());
      if (!runs.empty() && runs.back().cell == cell && runs.back().label == label && runs.back().count < 0xffff &&
          runs.back().first_sample + runs.back().count == sample)
        ++runs.back().count;
      else
        runs.push_back({cell, label, 1, sample});
    }
  return runs;
}

/// Stable sort by cell: least significant digit radix sort, about ten times faster here than std::stable_sort.
void sort_by_cell(std::vector<Run>& runs, std::size_t cell_count) {
  constexpr unsigned kDigitBits = 11;
  std::vector<Run> sorted(runs.size());
  for (unsigned shift = 0; cell_count >> shift != 0; shift += kDigitBits) {
    const auto digit = [shift](const Run& run) { return run.cell >> shift & ((1u << kDigitBits) - 1u); };
    std::array<std::uint32_t, (1u << kDigitBits) + 1> begin{};
    for (const Run& run : runs) ++begin[digit(run) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const Run& run : runs) sorted[begin[digit(run)]++] = run;
    runs.swap(sorted);
  }
}

/// All samples of one cell.
struct CellSummary {
  bool is_hit = false;
  std::uint16_t label = 0;       ///< majority of the labelled samples
  std::uint32_t ray_sample = 0;  ///< the sample whose ray is followed
};

/// Votes of the runs [first, last) of one cell.
CellSummary summarise(const Run* first, const Run* last, std::vector<std::pair<std::uint16_t, std::uint32_t>>& tally) {
  tally.clear();
  std::uint32_t hits = 0, beyond = 0;
  for (const Run* run = first; run != last; ++run) {
    (run->label == kBeyondRange ? beyond : hits) += run->count;
    if (run->label == kBeyondRange || run->label == 0) continue;
    const auto same = [run](const auto& entry) { return entry.first == run->label; };
    const auto it = std::find_if(tally.begin(), tally.end(), same);
    if (it == tally.end())
      tally.emplace_back(run->label, run->count);
    else
      it->second += run->count;
  }
  CellSummary summary;
  summary.is_hit = hits > 0;
  std::uint32_t most = 0;
  for (const auto& [label, count] : tally)
    if (count > most || (count == most && label < summary.label)) {
      summary.label = label;
      most = count;
    }
  // The middle sample in scan order, of those that decide what the cell is.
  std::uint32_t skip = (summary.is_hit ? hits : beyond) / 2;
  for (const Run* run = first; run != last; ++run) {
    if ((run->label == kBeyondRange) == summary.is_hit) continue;
    if (skip < run->count) {
      summary.ray_sample = run->first_sample + skip;
      break;
    }
    skip -= run->count;
  }
  return summary;
}

/// One bit per cell of the box.
class CellMask {
 public:
  explicit CellMask(std::size_t block_count) : words_(block_count * (kBlockVoxels / 64)) {}
  void set(CellId cell) { words_[cell >> 6] |= std::uint64_t{1} << (cell & 63u); }
  void clear(CellId cell) { words_[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63u)); }
  const std::uint64_t* block(std::size_t number) const { return &words_[number * (kBlockVoxels / 64)]; }
  std::uint64_t* block(std::size_t number) { return &words_[number * (kBlockVoxels / 64)]; }

 private:
  std::vector<std::uint64_t> words_;
};

/// One axis of a walk through the cells. Distances along the ray are 64-bit fixed point (kRayLength = its whole
/// length): additions are exact, and masks replace the branches that a processor could not predict.
struct AxisWalk {
  static constexpr std::int64_t kRayLength = std::int64_t{1} << 44;

  AxisWalk(double start, double along, const CellId* table) {
    const int cell = static_cast<int>(start);
    const double to_wall = along > 0.0 ? cell + 1 - start : start - cell;
    entry = table + cell;
    step = along > 0.0 ? 1 : -1;
    t_cell = fixed(1.0 / std::abs(along));
    t_exit = along == 0.0 ? kNever : fixed(to_wall / std::abs(along));
  }
  /// Crosses into the next cell if `mask` is -1, stays if it is 0.
  void advance(std::int64_t mask) {
    entry += step & mask;
    t_exit += t_cell & mask;
  }

  const CellId* entry;  ///< the cell's part of the id
  std::ptrdiff_t step;  ///< +1 or -1
  std::int64_t t_exit;  ///< where the ray leaves the cell
  std::int64_t t_cell;  ///< from wall to wall

 private:
  static constexpr std::int64_t kNever = std::int64_t{1} << 62;
  static std::int64_t fixed(double t) {
    return t < 1024.0 ? static_cast<std::int64_t>(t * static_cast<double>(kRayLength)) : kNever;
  }
};

/// Marks every cell that the segment from `start` along `ray` [voxels] leaves before the share `t_end` of its length.
void mark_passes(const FrameBox& box, const Eigen::Vector3d& start, const Eigen::Vector3d& ray, double t_end,
                 CellMask& mask) {
  AxisWalk x(start.x(), ray.x(), box.table(0)), y(start.y(), ray.y(), box.table(1)),
      z(start.z(), ray.z(), box.table(2));
  const auto end = static_cast<std::int64_t>(t_end * static_cast<double>(AxisWalk::kRayLength));
  while (true) {
    const std::int64_t t = std::min(x.t_exit, std::min(y.t_exit, z.t_exit));
    if (t > end) return;
    mask.set(*x.entry + *y.entry + *z.entry);
    const std::int64_t along_x = -static_cast<std::int64_t>(x.t_exit == t);
    const std::int64_t along_y = ~along_x & -static_cast<std::int64_t>(y.t_exit == t);
    x.advance(along_x);
    y.advance(along_y);
    z.advance(~(along_x | along_y));
  }
}

/// Share of the way to a measured point within which cells may be passed.
double free_share(double range_voxels, double depth_m, const IntegrationConfig& config, double resolution_m) {
  const double noise_m = config.depth_noise_per_m * depth_m * depth_m;
  const double margin_voxels = config.end_margin_voxels + 2.0 * noise_m / resolution_m;
  return 1.0 - margin_voxels / range_voxels;
}

/// Removes passes outside the height limits from a block.
void cut_heights(const BlockIndex& block, const IntegrationConfig& config, double resolution_m, std::uint64_t* passes) {
  for (int layer = 0; layer < kBlockEdge; ++layer) {
    const double center_m = (block.z * kBlockEdge + layer + 0.5) * resolution_m;
    if (center_m < config.min_height_m || center_m > config.max_height_m) passes[layer] = 0;
  }
}

struct CellHit {
  CellId cell;
  std::uint16_t label;
};

FrameVotes collect(const FrameBox& box, const std::vector<CellHit>& hits, CellMask& passes,
                   const IntegrationConfig& config, double resolution_m) {
  FrameVotes votes;
  votes.hits.reserve(hits.size());
  auto hit = hits.begin();
  for (std::size_t number = 0; number < box.block_count(); ++number) {
    BlockVotes of_block;
    of_block.block = box.block(number);
    std::uint64_t* words = passes.block(number);
    cut_heights(of_block.block, config, resolution_m, words);
    of_block.hits_begin = static_cast<std::uint32_t>(votes.hits.size());
    for (; hit != hits.end() && hit->cell / kBlockVoxels == number; ++hit) {
      const auto offset = static_cast<std::uint16_t>(hit->cell % kBlockVoxels);
      const double center_m = (of_block.block.z * kBlockEdge + (offset >> 6) + 0.5) * resolution_m;
      if (center_m >= config.min_height_m && center_m <= config.max_height_m)
        votes.hits.push_back({offset, hit->label, kOneVote});
    }
    of_block.hits_end = static_cast<std::uint32_t>(votes.hits.size());
    std::copy_n(words, of_block.passes.size(), of_block.passes.begin());
    const bool has_passes = std::any_of(words, words + of_block.passes.size(), [](std::uint64_t w) { return w != 0; });
    if (has_passes || of_block.hits_end > of_block.hits_begin) votes.blocks.push_back(of_block);
  }
  return votes;
}

}  // namespace

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
}

FrameVotes compute_votes(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
                         double resolution_m) {
  if (config.max_range_m / resolution_m > kMaxRangeInVoxels)
    throw std::runtime_error("integration: max_range_m exceeds 500 voxels; lower it or raise the map resolution");
  const FrameBox box = box_of(frame, T_map_camera, config.max_range_m, resolution_m);
  const Projector projector(frame, T_map_camera, box, resolution_m);
  const CompactFrame::Samples samples = frame.unpack();
  std::vector<Run> runs = find_runs(frame, samples, projector, box, config, resolution_m);
  sort_by_cell(runs, box.block_count() * kBlockVoxels);

  CellMask passes(box.block_count());
  std::vector<CellHit> hits;
  std::vector<std::pair<std::uint16_t, std::uint32_t>> tally;
  for (std::size_t first = 0, last = 0; first < runs.size(); first = last) {
    while (last < runs.size() && runs[last].cell == runs[first].cell) ++last;
    const CellSummary cell = summarise(&runs[first], &runs[first] + (last - first), tally);
    const double depth_mm = samples.depth_mm[cell.ray_sample];
    Eigen::Vector3d ray = projector.direction_of_sample(cell.ray_sample) * depth_mm;
    const double range = ray.norm();
    double t_end = 1.0;
    if (cell.is_hit) {
      hits.push_back({runs[first].cell, cell.label});
      t_end = free_share(range, depth_mm * 1e-3, config, resolution_m);
    } else {
      ray *= config.max_range_m / resolution_m / range;
    }
    mark_passes(box, projector.camera(), ray, t_end, passes);
  }
  for (const CellHit& hit : hits) passes.clear(hit.cell);
  return collect(box, hits, passes, config, resolution_m);
}

}  // namespace lapis::mapping
