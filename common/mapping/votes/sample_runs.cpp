#include "common/mapping/votes/sample_runs.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include "common/mapping/votes/integration.hpp"

// The vectorised functions are compiled in two versions, one of which is chosen for the processor when the program
// starts. Both give the same bits, because neither fuses multiplication and addition. Sanitizer builds have one version
// only, because the choice is made before the sanitizers are ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LAPIS_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define LAPIS_VECTORISED
#endif

namespace lapis::mapping {
namespace {

/// A sample's cell in the box, as x | y << 10 | z << 20 (a box has at most 1024 cells along an axis), plus kBeyond if
/// its ray ends there without a hit.
using SampleCell = std::uint32_t;
constexpr SampleCell kBeyond = 1u << 30;
constexpr SampleCell kNoCell = 0xffffffffu;  ///< of a sample without a vote
static_assert(2 * (kMaxRangeInVoxels + kMaxKernelLength_voxels) + 18 <= 1024);

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

/// Initialises the cells of a row: kNoCell for samples without depth or nearer than the minimum range, 0 for all
/// others. Returns the number of samples beyond the maximum range.
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

/// Finds the share of each ray that is within the range, and marks cells of rays that are longer with kBeyond.
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

/// Finds the cells of the samples of a row.
void locate_row(const FrameProjector& projector, int row, const std::uint16_t* depth_mm, double min_range,
                double max_range, RowMemory& s) {
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
void append_runs(const FrameBox& box, const std::uint16_t* labels, std::uint32_t first_sample, RowMemory& s,
                 std::vector<SampleRun>& runs) {
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
    runs.push_back({cell, first_sample + begin, s.starts[k + 1] - begin, labels[begin], (c & kBeyond) != 0});
  }
}

}  // namespace

void RowMemory::resize(std::size_t columns) {
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

void find_runs(const CompactFrame& frame, const FrameProjector& projector, const FrameBox& box, double min_range,
               double max_range, RowMemory& memory, std::vector<SampleRun>& runs) {
  const auto columns = static_cast<std::size_t>(frame.columns());
  memory.resize(columns);
  runs.clear();
  for (int column = 0; column < frame.columns(); ++column)
    for (std::size_t axis = 0; axis < 3; ++axis)
      memory.directions[axis][static_cast<std::size_t>(column)] = projector.direction(column)[static_cast<int>(axis)];
  for (int row = 0; row < frame.rows(); ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    locate_row(projector, row, &frame.depth_mm()[first], min_range, max_range, memory);
    append_runs(box, frame.has_labels() ? &frame.labels()[first] : memory.no_labels.data(),
                static_cast<std::uint32_t>(first), memory, runs);
  }
}

}  // namespace lapis::mapping
