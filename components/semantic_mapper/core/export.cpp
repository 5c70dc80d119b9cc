#include "semantic_mapper/core/export.hpp"

#include <algorithm>
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
constexpr int kOctreeDepth = 16;

bool fits_octree(const VoxelIndex& v) {
  const auto fits = [](std::int32_t i) { return i >= -kOctreeCenterKey && i < kOctreeCenterKey; };
  return fits(v.x) && fits(v.y) && fits(v.z);
}

octomap::OcTreeKey octree_key(const VoxelIndex& v) {
  const auto key = [](std::int32_t i) { return static_cast<octomap::key_type>(i + kOctreeCenterKey); };
  return {key(v.x), key(v.y), key(v.z)};
}

/// A leaf of the binary tree. Each three bits of the path, the highest first, name the octant at one level.
struct OctreeVoxel {
  std::uint64_t path = 0;
  bool is_occupied = false;
};

std::uint64_t octree_path(const VoxelIndex& v) {
  const octomap::OcTreeKey key = octree_key(v);
  std::uint64_t path = 0;
  for (int level = 0; level < kOctreeDepth; ++level)
    for (unsigned axis = 0; axis < 3; ++axis)
      path |= static_cast<std::uint64_t>(key[axis] >> level & 1) << (3 * level + static_cast<int>(axis));
  return path;
}

/// Writes the node that holds these sorted voxels, and all nodes below it: two bits per child (0 unknown, 1 free, 2
/// occupied, 3 inner), then the inner children. Returns the number of nodes. (liboctomap's own writer prints to the
/// terminal.)
std::size_t write_inner_node(std::span<const OctreeVoxel> voxels, int depth, files::ByteWriter& out) {
  const int shift = 3 * (kOctreeDepth - 1 - depth);
  const bool has_leaves = depth == kOctreeDepth - 1;
  unsigned states = 0;
  for (const OctreeVoxel& voxel : voxels) {
    const unsigned state = has_leaves ? (voxel.is_occupied ? 2u : 1u) : 3u;
    states |= state << (2 * (voxel.path >> shift & 7u));
  }
  out.u16(static_cast<std::uint16_t>(states));
  if (has_leaves) return 1 + voxels.size();
  std::size_t nodes = 1;
  for (auto begin = voxels.begin(); begin != voxels.end();) {
    const auto end = std::find_if(begin, voxels.end(),
                                  [&](const OctreeVoxel& v) { return v.path >> shift != begin->path >> shift; });
    nodes += write_inner_node({begin, end}, depth + 1, out);
    begin = end;
  }
  return nodes;
}

std::vector<std::uint8_t> to_bytes(const std::string& text) { return {text.begin(), text.end()}; }

/// Log-odds of a voxel. OctoMap takes 0 for occupied, Lapis for free, so a free voxel always gets less than 0.
float octree_log_odds(const mapping::BeliefReader& reader, const VoxelCounts& counts) {
  constexpr float kLeast = std::numeric_limits<float>::min();
  const auto log_odds = static_cast<float>(reader.occupancy_log_odds(counts));
  return reader.is_occupied(counts) ? std::max(log_odds, kLeast) : std::min(log_odds, -kLeast);
}

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
    const float log_odds = octree_log_odds(reader, counts);
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

std::vector<std::uint8_t> encode_binary_octree(const mapping::VoxelMap& map, const mapping::BeliefReader& reader) {
  std::vector<OctreeVoxel> voxels;
  map.for_each_observed([&](const VoxelIndex& voxel, const VoxelCounts& counts) {
    if (fits_octree(voxel)) voxels.push_back({octree_path(voxel), reader.is_occupied(counts)});
  });
  std::sort(voxels.begin(), voxels.end(), [](const OctreeVoxel& a, const OctreeVoxel& b) { return a.path < b.path; });
  files::ByteWriter nodes;
  const std::size_t count = voxels.empty() ? 0 : write_inner_node(voxels, 0, nodes);
  std::ostringstream header;
  header << "# Octomap OcTree binary file\nid OcTree\nsize " << count << "\nres " << map.resolution_m() << "\ndata\n";
  files::ByteWriter out;
  out.raw(to_bytes(header.str()));
  out.raw(nodes.bytes());
  return out.take();
}

}  // namespace lapis::semantic_mapper
