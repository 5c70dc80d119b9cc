#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/votes/frame_box.hpp"
#include "common/mapping/votes/sample_runs.hpp"

namespace lapis::mapping {

/// Summary of all samples of one cell.
struct CellSummary {
  bool is_hit = false;
  std::uint16_t label = 0;         ///< label with the largest weight among the labelled samples
  std::uint16_t label_weight = 0;  ///< its share of the vote [1/256 vote]
  std::uint32_t ray_sample = 0;    ///< the sample whose ray is traced
};

/// Summarises the runs of one cell. `confidence` is CompactFrame::confidence() of the frame.
CellSummary summarise(std::span<const SampleRun> runs, const std::vector<std::uint8_t>& confidence);

/// The vote of a cell in which something was measured.
struct CellHit {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;  ///< for the label [1/256 vote]
  std::uint16_t weight;        ///< total [1/256 vote]
};
/// @param sigma_m standard deviation of the depth; the weight is the probability that the noise is less than half a
/// voxel
CellHit hit_of(CellId id, const CellSummary& cell, double sigma_m, double resolution_m);

/// A vote of a hit for a nearby cell; weights as in CellHit.
struct KernelVote {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;
  std::uint16_t weight;
};

/// Compact kernel at a distance of `share` times its length: 1 at 0, and 0 from 1 on [Melkumyan & Ramos 2009].
double sparse_kernel(double share);
/// Appends the votes of a hit at `point` [voxels of the box] for the cells whose centres are within `length`, the
/// length of the kernel [voxels].
void spread(const CellHit& hit, const Eigen::Vector3d& point, double length, const FrameBox& box,
            std::vector<KernelVote>& votes);
/// Replaces the vote of each hit by the sum of the votes for its cell. Both lists are sorted by cell.
void smooth(const std::vector<KernelVote>& votes, std::vector<CellHit>& hits);

}  // namespace lapis::mapping
