#include "semantic_mapper/core/octree_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "common/files/byte_stream.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::VoxelIndex;

constexpr std::string_view kBinaryTitle = "# Octomap OcTree binary file";
constexpr std::string_view kFullTitle = "# Octomap OcTree file";
constexpr int kDepth = 16;  // of a leaf of one voxel
constexpr std::int32_t kCenterKey = 32768;
constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr geometry::Rgb8 kGrey{127, 127, 127};

struct Header {
  OctreeFile file;
  std::size_t nodes = 0;
  std::size_t bytes = 0;
};

/// Reads the lines of text up to "data"; nothing when the title or "data" is missing.
std::optional<Header> read_header(std::span<const std::uint8_t> bytes) {
  const auto text_size = std::min(bytes.size(), kMaxHeaderBytes);
  std::istringstream text(std::string(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(text_size)));
  Header header;
  std::string line;
  std::getline(text, line);
  header.file.is_binary = line.starts_with(kBinaryTitle);
  if (!header.file.is_binary && !line.starts_with(kFullTitle)) return std::nullopt;
  while (std::getline(text, line) && !line.starts_with("data")) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "id") words >> header.file.kind;
    if (key == "size") words >> header.nodes;
    if (key == "res") words >> header.file.resolution_m;
  }
  if (text.fail() || text.eof()) return std::nullopt;  // no complete line "data"
  header.bytes = static_cast<std::size_t>(text.tellg());
  return header;
}

/// Reads the nodes, depth first; children in the order of their octant (bit 0: upper half in x, bit 1: y, bit 2: z).
class NodeReader {
 public:
  NodeReader(std::span<const std::uint8_t> bytes, OctreeFile& file)
      : in_(bytes), file_(file), has_color_(file.kind == "ColorOcTree") {}

  /// False when the bytes do not hold exactly one tree.
  bool read() {
    const VoxelIndex corner{-kCenterKey, -kCenterKey, -kCenterKey};
    file_.is_binary ? read_states(corner, 0) : read_node(corner, 0);
    return in_.is_good() && in_.remaining() == 0;
  }

 private:
  static VoxelIndex child_corner(const VoxelIndex& corner, int child, int child_depth) {
    const std::int32_t half = 1 << (kDepth - child_depth);
    return {corner.x + (child & 1 ? half : 0), corner.y + (child & 2 ? half : 0), corner.z + (child & 4 ? half : 0)};
  }
  void add_leaf(const VoxelIndex& corner, int depth, bool is_occupied, double probability, geometry::Rgb8 color) {
    file_.leaves.push_back({corner, 1 << (kDepth - depth), is_occupied, probability, color});
  }

  /// .bt: an inner node has two bits per child: 0 unknown, 1 free, 2 occupied, 3 inner.
  void read_states(const VoxelIndex& corner, int depth) {
    ++file_.nodes;
    if (depth == kDepth) return in_.fail();
    const unsigned states = in_.u16();
    for (int child = 0; child < 8 && in_.is_good(); ++child) {
      const unsigned state = states >> (2 * child) & 3u;
      const VoxelIndex at = child_corner(corner, child, depth + 1);
      if (state == 3u) {
        read_states(at, depth + 1);
      } else if (state != 0u) {
        ++file_.nodes;
        add_leaf(at, depth + 1, state == 2u, state == 2u ? 1.0 : 0.0, kGrey);
      }
    }
  }

  /// .ot: log-odds, colour if there is one, and a byte whose bits name the children that follow.
  void read_node(const VoxelIndex& corner, int depth) {
    ++file_.nodes;
    const float log_odds = in_.f32();
    geometry::Rgb8 color = kGrey;
    if (has_color_) {
      color.r = in_.u8();
      color.g = in_.u8();
      color.b = in_.u8();
    }
    const unsigned children = in_.u8();
    if (!std::isfinite(log_odds) || (children != 0 && depth == kDepth)) return in_.fail();
    if (children == 0 && in_.is_good()) {
      return add_leaf(corner, depth, log_odds >= 0.0f, 1.0 / (1.0 + std::exp(-static_cast<double>(log_odds))), color);
    }
    for (int child = 0; child < 8 && in_.is_good(); ++child) {
      if (children >> child & 1u) read_node(child_corner(corner, child, depth + 1), depth + 1);
    }
  }

  files::ByteReader in_;
  OctreeFile& file_;
  bool has_color_;
};

}  // namespace

std::optional<OctreeFile> decode_octree(std::span<const std::uint8_t> bytes, std::string& error) {
  auto header = read_header(bytes);
  if (!header) {
    error = "is not an OctoMap file";
    return std::nullopt;
  }
  OctreeFile& file = header->file;
  if (file.kind != "OcTree" && (file.kind != "ColorOcTree" || file.is_binary)) {
    error = "holds a tree of kind '" + file.kind + "'; OcTree (.bt, .ot) and ColorOcTree (.ot) can be read";
    return std::nullopt;
  }
  if (!(file.resolution_m > 0.0) || !std::isfinite(file.resolution_m)) {
    error = "is damaged: the resolution is not positive";
    return std::nullopt;
  }
  const auto nodes = bytes.subspan(header->bytes);
  const bool is_whole = header->nodes == 0 ? nodes.empty() : NodeReader(nodes, file).read();
  if (!is_whole || file.nodes != header->nodes) {
    error = "is damaged: the header announces " + std::to_string(header->nodes) + " nodes, " +
            std::to_string(file.nodes) + " could be read";
    return std::nullopt;
  }
  return std::move(file);
}

}  // namespace lapis::semantic_mapper
