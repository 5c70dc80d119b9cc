#pragma once

#include <span>
#include <string>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/images/rectifier.hpp"
#include "common/mapping/model/label_list.hpp"
#include "common/mapping/wire/map_mirror.hpp"
#include "common/messages/converted.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/octomap_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/vision_msgs.hpp"
#include "semantic_mapper/core/export.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "semantic_mapper/core/unconnected_frames.hpp"

namespace lapis::semantic_mapper {

/// Labels of one instant in the view of the colour camera, as its lens shows it.
struct LabelMessages {
  const sensor_msgs::msg::Image* labels = nullptr;      ///< null: none
  const sensor_msgs::msg::Image* confidence = nullptr;  ///< of the labels; null: none
};
/// Compact frame without labels; refused with a reason when the depth [m], which is rectified, does not fit the camera.
messages::Converted<mapping::CompactFrame> to_core(const geometry::DepthImage& depth, const geometry::LensCamera& color,
                                                   const mapping::CompactFrameConfig& config);
/// Gives the frame what these messages say, rectified. Returns the problem when they do not fit the camera, or an empty
/// text. The rectifier is kept for the next frame.
std::string set_labels(mapping::CompactFrame& frame, const LabelMessages& seen, const geometry::LensCamera& color,
                       const mapping::CompactFrameConfig& config, images::KeptRectifier& rectifier);
/// Adds the pose of a tracked frame to its compact frame; refused when the poses are not valid, or when odometry alone
/// gave them and the message states no drift.
messages::Converted<AnchoredFrame> to_core(const lapis_msgs::msg::TrackedFrame& tracked, mapping::CompactFrame frame);
/// The same for a frame in a sub-map of slam, which has no pose in the map yet.
messages::Converted<UnconnectedFrame> to_unconnected(const lapis_msgs::msg::TrackedFrame& tracked,
                                                     mapping::CompactFrame frame);
/// Valid key-frame poses of a graph.
std::vector<KeyframePose> to_core(const lapis_msgs::msg::PoseGraph& graph);

lapis_msgs::msg::VoxelTile to_message(const TileUpdate& tile, std::int64_t epoch);
octomap_msgs::msg::Octomap to_message(const Octree& octree, double resolution_m, const std_msgs::msg::Header& header);
sensor_msgs::msg::PointCloud2 to_message(std::span<const LabelledPoint> points, const std_msgs::msg::Header& header);
nav_msgs::msg::OccupancyGrid to_message(const OccupancyGrid& grid, const std_msgs::msg::Header& header);

}  // namespace lapis::semantic_mapper
