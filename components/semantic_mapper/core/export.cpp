#include "semantic_mapper/core/export.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>

#include <octomap/ColorOcTree.h>

#include "common/files/byte_stream.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::VoxelCounts;
using mapping::VoxelIndex;

constexpr std::int32_t kOctreeCenterKey = 32768;

bool fits_octree(const VoxelIndex& v) {
  const auto fits = [](std::int32_t i) { return i >= -kOctreeCenterKey && i < kOctreeCenterKey; };
  return fits(v.x) && fits(v.y) && fits(v.z);
}

octomap::OcTreeKey octree_key(const VoxelIndex& v) {
  const auto key = [](std::int32_t i) { return static_cast<octomap::key_type>(i + kOctreeCenterKey); };
  return {key(v.x), key(v.y), key(v.z)};
}

std::vector<std::uint8_t> to_bytes(const std::string& text) { return {text.begin(), text.end()}; }

struct ColumnRange {
  std::int32_t low_x = std::numeric_limits<std::int32_t>::max(), low_y = low_x;
  std::int32_t high_x = std::numeric_limits<std::int32_t>::min(), high_y = high_x;
  void include(const VoxelIndex& v) {
    low_x = std::min(low_x, v.x);
    low_y = std::min(low_y, v.y);
    high_x = std::max(high_x, v.x);
    high_y = std::max(high_y, v.y);
  }
  bool is_empty() const { return low_x > high_x; }
};

}  // namespace

std::vector<LabelledPoint> occupied_points(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                                           const mapping::LabelList& labels) {
  std::vector<LabelledPoint> points;
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts& counts) {
    if (!reader.is_occupied(counts)) return;
    const std::uint16_t label = reader.label(counts);
    points.push_back({map.center_of(voxel).cast<float>(), labels.color(label), label,
                      static_cast<float>(reader.occupied_probability(counts))});
  });
  return points;
}

std::vector<std::uint8_t> encode_ply(std::span<const LabelledPoint> points) {
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
                             "\nproperty float x\nproperty float y\nproperty float z\n"
                             "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                             "property ushort label\nproperty float probability\nend_header\n";
  files::ByteWriter out;
  out.raw(to_bytes(header));
  for (const LabelledPoint& point : points) {
    for (const float coordinate : {point.position.x(), point.position.y(), point.position.z()}) out.f32(coordinate);
    for (const std::uint8_t channel : {point.color.r, point.color.g, point.color.b}) out.u8(channel);
    out.u8(static_cast<std::uint8_t>(point.label & 0xffu));
    out.u8(static_cast<std::uint8_t>(point.label >> 8));
    out.f32(point.probability);
  }
  return out.take();
}

Octree encode_octree(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                     const mapping::LabelList& labels) {
  octomap::ColorOcTree tree(map.resolution_m());
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts& counts) {
    if (!fits_octree(voxel)) return;
    const auto log_odds = static_cast<float>(reader.occupancy_log_odds(counts));
    octomap::ColorOcTreeNode* node = tree.setNodeValue(octree_key(voxel), log_odds, /*lazy_eval=*/true);
    node->setLogOdds(log_odds);  // setNodeValue clamps to OctoMap's own, narrower limits
    if (!reader.is_occupied(counts)) return;
    const geometry::Rgb8 color = labels.color(reader.label(counts));
    node->setColor(color.r, color.g, color.b);
  });
  if (tree.size() > 0) tree.updateInnerOccupancy();  // OctoMap dereferences the root of an empty tree here
  std::ostringstream file, data;
  tree.write(file);
  tree.writeData(data);
  return {to_bytes(file.str()), to_bytes(data.str())};
}

OccupancyGrid project_to_grid(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                              const GridConfig& config) {
  const auto is_in_band = [&](const VoxelIndex& voxel) {
    const double center_m = (voxel.z + 0.5) * map.resolution_m();
    return center_m >= config.min_height_m && center_m < config.max_height_m;
  };
  ColumnRange range;
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts&) {
    if (is_in_band(voxel)) range.include(voxel);
  });
  OccupancyGrid grid;
  grid.resolution_m = map.resolution_m();
  if (range.is_empty()) return grid;
  grid.origin_x_m = range.low_x * map.resolution_m();
  grid.origin_y_m = range.low_y * map.resolution_m();
  grid.width = range.high_x - range.low_x + 1;
  grid.height = range.high_y - range.low_y + 1;
  grid.cells.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height), -1);
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts& counts) {
    if (!is_in_band(voxel)) return;
    const auto row = static_cast<std::size_t>(voxel.y - range.low_y);
    const auto column = static_cast<std::size_t>(voxel.x - range.low_x);
    std::int8_t& cell = grid.cells[row * static_cast<std::size_t>(grid.width) + column];
    cell = std::max(cell, static_cast<std::int8_t>(reader.is_occupied(counts) ? 100 : 0));
  });
  return grid;
}

}  // namespace lapis::semantic_mapper
