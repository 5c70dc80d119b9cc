#include "semantic_mapper/convert_tool.hpp"

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "semantic_mapper/core/export.hpp"
#include "semantic_mapper/tool_input.hpp"

namespace lapis::semantic_mapper {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct ConvertOptions {
  std::string in, out;
};

Bytes encode(const mapping::MapFile& file, const ConvertOptions& options) {
  const std::string extension = extension_of(options.out);
  const mapping::BeliefReader reader(file.sensor_model);
  if (extension == ".ot") return encode_octree(file.map, reader, file.labels).file;
  if (extension == ".bt") return encode_binary_octree(file.map, reader);
  if (extension == ".ply") return encode_ply(occupied_points(file.map, reader, file.labels));
  throw std::runtime_error(options.out + ": cannot be written; expected .ot, .bt or .ply");
}

/// An octree holds no counts, so only its points can be written.
Bytes encode(const OctreeFile& octree, const ConvertOptions& options) {
  if (extension_of(options.out) != ".ply")
    throw std::runtime_error(options.out + ": cannot be made from " + options.in +
                             ", which holds no counts of classes; expected .ply, or a .lapis file to convert");
  std::vector<LabelledPoint> points;
  for (const OctreeLeaf& leaf : octree.leaves) {
    if (!leaf.is_occupied) continue;
    const Eigen::Vector3d corner(leaf.corner.x, leaf.corner.y, leaf.corner.z);
    const Eigen::Vector3d center = (corner.array() + 0.5 * leaf.edge_voxels) * octree.resolution_m;
    points.push_back({center.cast<float>(), leaf.color, 0, static_cast<float>(leaf.probability)});
  }
  return encode_ply(points);
}

void convert(const ConvertOptions& options) {
  const Bytes bytes = std::visit([&](const auto& content) { return encode(content, options); }, read_input(options.in));
  if (const auto problem = files::replace_file(options.out, bytes)) throw std::runtime_error(*problem);
}

}  // namespace

void add_convert_tool(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* tool =
      app.add_subcommand("convert", "convert a map to the format that the extension of the output file names");
  tool->add_option("in", options->in,
                   "map to convert: a .lapis file, or an OctoMap file (.ot, .bt), which converts only to .ply")
      ->required();
  tool->add_option("out", options->out,
                   "file to write. .ot: OctoMap ColorOcTree in class colours; .bt: OctoMap tree of occupied and free\n"
                   "voxels; .ply: centres of occupied voxels (or of an octree's leaves) with label and probability")
      ->required();
  tool->footer("Example:\n  lapis_semantic_mapper convert run/map.lapis map.bt");
  tool->callback([options] { convert(*options); });
}

}  // namespace lapis::semantic_mapper
