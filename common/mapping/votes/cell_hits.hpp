#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/votes/frame_box.hpp"
#include "common/mapping/votes/sample_runs.hpp"

namespace lapis::mapping {

/// All samples of one cell.
struct CellSummary {
  bool is_hit = false;
  std::uint16_t label = 0;         ///< with most weight of the labelled samples
  std::uint16_t label_weight = 0;  ///< its share of the vote [1/256 vote]
  std::uint32_t ray_sample = 0;    ///< the sample whose ray is followed
};

/// Of the runs of one cell. `confidence` is the frame's.
CellSummary summarise(std::span<const SampleRun> runs, const std::vector<std::uint8_t>& confidence);

/// The vote of a cell in which something was measured.
struct CellHit {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;  ///< for the label [1/256 vote]
  std::uint16_t weight;        ///< altogether
};
/// @param sigma_m of the depth: the hit is worth the probability that the noise is less than half a voxel
CellHit hit_of(CellId id, const CellSummary& cell, double sigma_m, double resolution_m);

/// A vote of a hit for a cell near it.
struct KernelVote {
  CellId cell;
  std::uint16_t label;
  std::uint16_t label_weight;
  std::uint16_t weight;
};

/// Compact kernel at a distance of `share` of its length: 1 at 0, 0 from 1 on [Melkumyan & Ramos 2009].
double sparse_kernel(double share);
/// Appends the votes of a hit at `point` [voxels of the box] for the cells whose centres are within the kernel's
/// length.
void spread(const CellHit& hit, const Eigen::Vector3d& point, double length, const FrameBox& box,
            std::vector<KernelVote>& votes);
/// Replaces what hits say by what all around them say. Both are sorted by cell.
void smooth(const std::vector<KernelVote>& votes, std::vector<CellHit>& hits);

}  // namespace lapis::mapping
