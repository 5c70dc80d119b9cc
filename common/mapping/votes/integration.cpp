#include "common/mapping/votes/integration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/mapping/votes/cell_hits.hpp"
#include "common/mapping/votes/frame_box.hpp"
#include "common/mapping/votes/ray_marks.hpp"
#include "common/mapping/votes/sample_runs.hpp"
#include "common/mapping/votes/sort_by_cell.hpp"

namespace lapis::mapping {
namespace {

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

double depth_sigma_m(double depth_m, const IntegrationConfig& config) {
  return config.depth_noise_per_m * depth_m * depth_m;
}

/// Share of a ray up to its measured point within which cells may get a miss.
double free_share(double range_voxels, double depth_m, const IntegrationConfig& config, double resolution_m) {
  const double margin_voxels = config.end_margin_voxels + 2.0 * depth_sigma_m(depth_m, config) / resolution_m;
  return 1.0 - margin_voxels / range_voxels;
}

/// Drift in units of voxels.
class DriftLimit {
 public:
  DriftLimit(const Drift& drift, double resolution_m)
      : position_(drift.position_m / resolution_m), rotation_(drift.rotation_rad), is_none_(drift.is_none()),
        reach_(drift.range_m(0.5 * resolution_m) / resolution_m) {}

  bool is_none() const { return is_none_; }
  double reach() const { return reach_; }  ///< range up to which there are votes; infinite without drift
  /// Assumed largest distance of a surface at this range from its measured position.
  double margin(double range) const { return kDriftMargin_sigmas * (position_ + rotation_ * range); }
  /// Length within which the ray to a surface at this range may give misses.
  double free_length(double range) const { return std::min(reach_, range - margin(range)); }

 private:
  double position_, rotation_;
  bool is_none_;
  double reach_;
};

bool is_within_heights(const BlockIndex& block, int layer, const IntegrationConfig& config, double resolution_m) {
  const double center_m = (block.z * kBlockEdge + layer + 0.5) * resolution_m;
  return center_m >= config.min_height_m && center_m <= config.max_height_m;
}

void append_votes(const CellHit& hit, std::uint16_t offset, std::vector<HitVote>& votes) {
  if (hit.weight > hit.label_weight)
    votes.push_back({offset, 0, static_cast<std::uint32_t>(hit.weight - hit.label_weight)});
  if (hit.label_weight > 0) votes.push_back({offset, hit.label, hit.label_weight});
}

/// Appends the votes of the block with number `number` at position `at` in the box. `hit` is the first hit of the block
/// and advances to that of the next block.
void collect_block(const FrameBox& box, const Eigen::Vector3i& at, CellId number, const RayMarks& marks,
                   const IntegrationConfig& config, double resolution_m, const CellHit*& hit, const CellHit* hits_end,
                   FrameVotes& votes) {
  BlockVotes of_block;
  of_block.block = box.block(at);
  std::uint64_t any = 0;
  for (int layer = 0; layer < kBlockEdge; ++layer) {
    if (!is_within_heights(of_block.block, layer, config, resolution_m)) continue;
    any |= of_block.misses[static_cast<std::size_t>(layer)] = marks.layer_bits(at, layer);
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

FrameVotes collect(const FrameBox& box, const std::vector<CellHit>& hits, const RayMarks& marks,
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

/// Working memory of compute_votes. Each thread keeps its own, because new memory from the system costs more time than
/// most of the work that is done in it.
struct Scratch {
  RowMemory rows;
  std::vector<SampleRun> runs, sorted_runs;
  std::vector<KernelVote> kernel_votes, sorted_kernel_votes;
  std::vector<std::uint8_t> marks;
};

/// Computes the votes of one frame: a ray, and possibly a hit, for each cell that is seen.
class Tracing {
 public:
  Tracing(const CompactFrame& frame, const geometry::Pose& T_map_camera, const IntegrationConfig& config,
          double resolution_m, const DriftLimit& limit, Scratch& scratch)
      : frame_(frame), config_(config), resolution_m_(resolution_m), limit_(limit),
        box_(box_of(frame, T_map_camera, config, resolution_m)), projector_(frame, T_map_camera, box_, resolution_m),
        s_(scratch), marks_(box_, scratch.marks) {}

  void trace_cells() {
    find_runs(frame_, projector_, box_, config_.min_range_m / resolution_m_, config_.max_range_m / resolution_m_,
              s_.rows, s_.runs);
    sort_by_cell(s_.runs, s_.sorted_runs, cell_count());
    s_.kernel_votes.clear();
    for (std::size_t first = 0, last = 0; first < s_.runs.size(); first = last) {
      while (last < s_.runs.size() && s_.runs[last].cell == s_.runs[first].cell) ++last;
      trace(s_.runs[first].cell, summarise(std::span(&s_.runs[first], last - first), frame_.confidence()));
    }
  }

  void keep_off_drifting_surfaces() {
    for (const Eigen::Vector3d& ray : drifting_)
      marks_.clear_around(projector_.camera(), ray, limit_.margin(ray.norm()), limit_.reach());
  }

  void smooth_hits() {
    if (!(config_.kernel_length_voxels > 0.0)) return;
    sort_by_cell(s_.kernel_votes, s_.sorted_kernel_votes, cell_count());
    smooth(s_.kernel_votes, hits_);
  }

  FrameVotes votes() const { return collect(box_, hits_, marks_, config_, resolution_m_); }

 private:
  std::size_t cell_count() const { return box_.block_count() * kBlockVoxels; }

  void trace(CellId id, const CellSummary& cell) {
    const double depth_mm = frame_.depth_mm()[cell.ray_sample], depth_m = depth_mm * 1e-3;
    Eigen::Vector3d ray = projector_.direction_of_sample(cell.ray_sample) * depth_mm;
    const double range = ray.norm();
    double t_end = 1.0;
    if (!cell.is_hit) {
      ray *= config_.max_range_m / resolution_m_ / range;
    } else {
      t_end = free_share(range, depth_m, config_, resolution_m_);
      if (!limit_.is_none()) drifting_.push_back(ray);
      if (range <= limit_.reach()) add_hit(id, cell, depth_m, ray);
    }
    if (!limit_.is_none()) t_end = std::min(t_end, limit_.free_length(range) / ray.norm());
    marks_.add_ray(projector_.camera(), ray, t_end);
  }

  void add_hit(CellId id, const CellSummary& cell, double depth_m, const Eigen::Vector3d& ray) {
    hits_.push_back(hit_of(id, cell, depth_sigma_m(depth_m, config_), resolution_m_));
    if (config_.kernel_length_voxels > 0.0)
      spread(hits_.back(), projector_.camera() + ray, config_.kernel_length_voxels, box_, s_.kernel_votes);
  }

  const CompactFrame& frame_;
  const IntegrationConfig& config_;
  double resolution_m_;
  const DriftLimit& limit_;
  FrameBox box_;
  FrameProjector projector_;
  Scratch& s_;
  RayMarks marks_;
  std::vector<CellHit> hits_;              // ascending cells
  std::vector<Eigen::Vector3d> drifting_;  // rays to surfaces whose position is uncertain because of drift
};

}  // namespace

double Drift::range_m(double limit_m) const {
  if (position_m > limit_m) return 0.0;
  return rotation_rad > 0.0 ? (limit_m - position_m) / rotation_rad : std::numeric_limits<double>::infinity();
}

void validate(const IntegrationConfig& config) {
  config::check("integration", config);
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::runtime_error(std::string("integration: ") + what);
  };
  require(config.max_range_m >= 0.5 && config.max_range_m <= 20.0, "max_range_m must be in [0.5, 20]");
  require(config.min_range_m < config.max_range_m, "min_range_m must be below max_range_m");
  require(config.min_height_m < config.max_height_m, "min_height_m must be below max_height_m");
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
  thread_local Scratch scratch;
  Tracing tracing(frame, T_map_camera, config, resolution_m, limit, scratch);
  tracing.trace_cells();
  tracing.keep_off_drifting_surfaces();
  tracing.smooth_hits();
  return tracing.votes();
}

}  // namespace lapis::mapping
