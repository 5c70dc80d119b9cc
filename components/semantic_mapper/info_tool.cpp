#include "semantic_mapper/info_tool.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "common/mapping/model/sensor_model.hpp"
#include "common/report/report.hpp"
#include "semantic_mapper/tool_input.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::VoxelIndex;
using nlohmann::ordered_json;

/// Smallest box that holds cubes of voxels.
class Extent {
 public:
  void include(const VoxelIndex& corner, std::int32_t edge_voxels) {
    const Eigen::Vector3d low(corner.x, corner.y, corner.z);
    low_ = low_.cwiseMin(low);
    high_ = high_.cwiseMax(low + Eigen::Vector3d::Constant(edge_voxels));
  }
  void write(double resolution_m, ordered_json& result) const {
    result["extent_min_m"] = to_json(low_ * resolution_m);
    result["extent_max_m"] = to_json(high_ * resolution_m);
  }

 private:
  ordered_json to_json(const Eigen::Vector3d& p) const {
    if (low_.x() > high_.x()) return nullptr;
    return {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}};
  }
  Eigen::Vector3d low_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high_ = -low_;
};

double volume_m3(std::size_t voxels, double resolution_m) {
  return static_cast<double>(voxels) * resolution_m * resolution_m * resolution_m;
}

/// Number of occupied voxels of a class, and the sum of its hits.
struct ClassSum {
  std::size_t occupied = 0;
  double votes = 0.0;
};

struct MapSums {
  std::size_t occupied = 0, free = 0;
  Extent extent;
  std::map<std::uint16_t, ClassSum> classes;
};

MapSums sums_of(const mapping::MapFile& file) {
  const mapping::BeliefReader reader(file.sensor_model);
  MapSums sums;
  file.map.for_each_observed([&](const VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
    sums.extent.include(voxel, 1);
    for (const mapping::ClassCount& hit : counts.hits)
      sums.classes[hit.label].votes += static_cast<double>(hit.count) / mapping::kOneVote;
    const bool is_occupied = reader.is_occupied(counts);
    ++(is_occupied ? sums.occupied : sums.free);
    if (is_occupied) ++sums.classes[reader.label(counts)].occupied;
  });
  return sums;
}

ordered_json describe(const mapping::SensorModel& model) {
  return {{"fusion", model.fusion},
          {"hit_gain", model.hit_gain},
          {"miss_gain", model.miss_gain},
          {"label_accuracy", model.label_accuracy},
          {"prior_occupied", model.prior_occupied},
          {"prior_votes", model.prior_votes},
          {"class_count", model.class_count}};
}

/// Null when the settings are unknown, or when the map was not made from frames.
ordered_json describe(const std::optional<mapping::FrameSettings>& frames) {
  if (!frames) return nullptr;
  const mapping::IntegrationConfig& c = frames->integration;
  return {{"stride", frames->stride},
          {"min_range_m", c.min_range_m},
          {"max_range_m", c.max_range_m},
          {"min_height_m", c.min_height_m},
          {"max_height_m", c.max_height_m},
          {"end_margin_voxels", c.end_margin_voxels},
          {"depth_noise_per_m", c.depth_noise_per_m},
          {"kernel_length_voxels", c.kernel_length_voxels}};
}

ordered_json describe(const mapping::MapFile& file) {
  const MapSums sums = sums_of(file);
  const double r = file.map.resolution_m();
  const std::size_t voxels = file.map.block_count() * mapping::kBlockVoxels;
  ordered_json result = {{"kind", "Lapis map (counts)"},
                         {"resolution_m", r},
                         {"blocks", file.map.block_count()},
                         {"occupied_voxels", sums.occupied},
                         {"free_voxels", sums.free},
                         {"unknown_voxels_in_blocks", voxels - sums.occupied - sums.free},
                         {"occupied_volume_m3", volume_m3(sums.occupied, r)},
                         {"free_volume_m3", volume_m3(sums.free, r)}};
  sums.extent.write(r, result);
  result["provenance"] = file.provenance;
  result["sensor_model"] = describe(file.sensor_model);
  result["frame_settings"] = describe(file.frames);
  result["classes"] = ordered_json::array();
  for (const auto& [id, sum] : sums.classes)
    result["classes"].push_back(
        {{"id", id}, {"class", file.labels.name(id)}, {"occupied_voxels", sum.occupied}, {"votes", sum.votes}});
  return result;
}

ordered_json describe(const OctreeFile& octree) {
  std::size_t leaves[2] = {0, 0}, voxels[2] = {0, 0};  // free, occupied
  Extent extent;
  for (const OctreeLeaf& leaf : octree.leaves) {
    const auto edge = static_cast<std::size_t>(leaf.edge_voxels);
    ++leaves[leaf.is_occupied];
    voxels[leaf.is_occupied] += edge * edge * edge;
    extent.include(leaf.corner, leaf.edge_voxels);
  }
  const double r = octree.resolution_m;
  ordered_json result = {{"kind", "OctoMap " + octree.kind + (octree.is_binary ? " (binary)" : "")},
                         {"resolution_m", r},
                         {"nodes", octree.nodes},
                         {"leaves", octree.leaves.size()},
                         {"occupied_leaves", leaves[1]},
                         {"free_leaves", leaves[0]},
                         {"occupied_volume_m3", volume_m3(voxels[1], r)},
                         {"free_volume_m3", volume_m3(voxels[0], r)}};
  extent.write(r, result);
  return result;
}

}  // namespace

void add_info_tool(CLI::App& app, std::ostream& out) {
  struct InfoOptions {
    std::string file;
    bool as_json = false;
  };
  auto options = std::make_shared<InfoOptions>();
  CLI::App* tool =
      app.add_subcommand("info", "print resolution, voxels, extent, settings, classes and provenance of a map");
  tool->add_option("file", options->file, "map file: .lapis, or OctoMap (.ot, .bt)")->required();
  tool->add_flag("--json", options->as_json, "print JSON with all digits instead of text");
  tool->footer("Example:\n  lapis_semantic_mapper info run/map.lapis --json");
  tool->callback([options, &out] {
    ordered_json result = {{"file", options->file}};
    result.update(std::visit([](const auto& content) { return describe(content); }, read_input(options->file)));
    report::print(out, result, options->as_json);
  });
}

}  // namespace lapis::semantic_mapper
