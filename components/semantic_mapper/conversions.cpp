#include "semantic_mapper/conversions.hpp"

#include <cmath>
#include <cstring>

#include "common/messages/camera.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::semantic_mapper {
namespace {

sensor_msgs::msg::PointField point_field(const std::string& name, std::uint32_t offset, std::uint8_t datatype) {
  sensor_msgs::msg::PointField field;
  field.name(name);
  field.offset(offset);
  field.datatype(datatype);
  field.count(1);
  return field;
}

template <class Value>
void put(std::uint8_t* bytes, std::size_t offset, Value value) {
  std::memcpy(bytes + offset, &value, sizeof value);
}

// RViz reads the field "rgb" as a float whose bits are 0x00rrggbb.
std::uint32_t packed(const geometry::Rgb8& color) {
  return static_cast<std::uint32_t>(color.r) << 16 | static_cast<std::uint32_t>(color.g) << 8 | color.b;
}

/// Converts images of one camera, and takes out the distortion of its lens.
struct RectifiedImages {
  const geometry::LensCamera& camera;
  images::KeptRectifier& rectifier;

  /// Converts an image, if there is one. Returns the problem with it, or an empty text.
  template <class Pixels>
  std::string take(const char* what, const sensor_msgs::msg::Image* message,
                   messages::Converted<Pixels> (*convert)(const sensor_msgs::msg::Image&),
                   std::optional<Pixels>& out) const {
    if (message == nullptr) return "";
    auto image = convert(*message);
    if (!image) return image.reason;
    auto problem = messages::size_problem(what, image->width, image->height, camera.pinhole);
    if (!problem.empty()) return problem;
    rectifier.of(camera).rectify(*image);
    out = std::move(*image);
    return "";
  }
};

}  // namespace

messages::Converted<mapping::CompactFrame> to_core(const geometry::DepthImage& depth, const geometry::LensCamera& color,
                                                   const mapping::CompactFrameConfig& config) {
  std::string problem;
  auto frame = mapping::CompactFrame::make(color.pinhole, depth, nullptr, config, problem);
  if (!frame) return messages::Converted<mapping::CompactFrame>::refused(problem);
  return std::move(*frame);
}

std::string set_labels(mapping::CompactFrame& frame, const LabelMessages& seen, const geometry::LensCamera& color,
                       const mapping::CompactFrameConfig& config, images::KeptRectifier& rectifier) {
  const RectifiedImages images{color, rectifier};
  std::optional<geometry::LabelImage> labels;
  std::optional<geometry::ConfidenceImage> confidence;
  std::string problem = images.take("label", seen.labels, messages::to_labels, labels);
  if (problem.empty()) problem = images.take("confidence", seen.confidence, messages::to_confidence, confidence);
  if (!problem.empty() || !labels) return problem;
  return frame.set_labels(*labels, confidence ? &*confidence : nullptr, config.max_label);
}

messages::Converted<AnchoredFrame> to_core(const lapis_msgs::msg::TrackedFrame& tracked, mapping::CompactFrame frame) {
  using Result = messages::Converted<AnchoredFrame>;
  const auto T_map_keyframe = messages::from_message(tracked.keyframe_pose());
  if (!T_map_keyframe) return Result::refused("keyframe_pose: " + T_map_keyframe.reason);
  const auto T_keyframe_camera = messages::from_message(tracked.pose_in_keyframe());
  if (!T_keyframe_camera) return Result::refused("pose_in_keyframe: " + T_keyframe_camera.reason);
  const mapping::Drift drift{tracked.drift_m(), tracked.drift_rad()};
  const auto is_sigma = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!is_sigma(drift.position_m) || !is_sigma(drift.rotation_rad)) return Result::refused("drift is no sigma");
  const bool is_held = tracked.source() != lapis_msgs::msg::TrackedFrame_Constants::SOURCE_ODOMETRY;
  if (!is_held && drift.is_none()) return Result::refused("a pose by odometry alone does not say its drift");
  return AnchoredFrame{messages::from_message(tracked.header().stamp()),
                       tracked.keyframe_id(),
                       *T_map_keyframe,
                       *T_keyframe_camera,
                       tracked.graph_version(),
                       std::move(frame),
                       drift,
                       tracked.is_keyframe()};
}

messages::Converted<UnconnectedFrame> to_unconnected(const lapis_msgs::msg::TrackedFrame& tracked,
                                                     mapping::CompactFrame frame) {
  using Result = messages::Converted<UnconnectedFrame>;
  const auto T_keyframe_camera = messages::from_message(tracked.pose_in_keyframe());
  if (!T_keyframe_camera) return Result::refused("pose_in_keyframe: " + T_keyframe_camera.reason);
  return UnconnectedFrame{messages::from_message(tracked.header().stamp()), tracked.keyframe_id(), *T_keyframe_camera,
                          std::move(frame), tracked.is_keyframe()};
}

std::vector<KeyframePose> to_core(const lapis_msgs::msg::PoseGraph& graph) {
  std::vector<KeyframePose> poses;
  for (const auto& node : graph.nodes()) {
    if (const auto T = messages::from_message(node.pose())) poses.push_back({node.id(), *T, node.is_drifting()});
  }
  return poses;
}

lapis_msgs::msg::VoxelTile to_message(const TileUpdate& tile, std::int64_t epoch) {
  lapis_msgs::msg::VoxelTile message;
  message.x(tile.index.x);
  message.y(tile.index.y);
  message.z(tile.index.z);
  message.epoch(epoch);
  message.version(tile.version);
  message.data(tile.bytes);
  return message;
}

octomap_msgs::msg::Octomap to_message(const Octree& octree, double resolution_m, const std_msgs::msg::Header& header) {
  octomap_msgs::msg::Octomap message;
  message.header(header);
  message.binary(false);
  message.id("ColorOcTree");
  message.resolution(resolution_m);
  message.data().resize(octree.tree.size());
  if (!octree.tree.empty()) std::memcpy(message.data().data(), octree.tree.data(), octree.tree.size());
  return message;
}

sensor_msgs::msg::PointCloud2 to_message(std::span<const LabelledPoint> points, const std_msgs::msg::Header& header) {
  constexpr std::uint32_t kStep = 24;
  constexpr std::uint8_t kUint16 = 4;
  constexpr std::uint8_t kFloat32 = 7;
  sensor_msgs::msg::PointCloud2 message;
  message.header(header);
  message.height(1);
  message.width(static_cast<std::uint32_t>(points.size()));
  message.fields({point_field("x", 0, kFloat32), point_field("y", 4, kFloat32), point_field("z", 8, kFloat32),
                  point_field("rgb", 12, kFloat32), point_field("label", 16, kUint16),
                  point_field("probability", 20, kFloat32)});
  message.is_bigendian(false);
  message.point_step(kStep);
  message.row_step(kStep * message.width());
  message.is_dense(true);
  message.data().resize(points.size() * kStep);
  std::uint8_t* bytes = message.data().data();
  for (const auto& point : points) {
    put(bytes, 0, point.position.x());
    put(bytes, 4, point.position.y());
    put(bytes, 8, point.position.z());
    put(bytes, 12, packed(point.color));
    put(bytes, 16, point.label);
    put(bytes, 20, point.probability);
    bytes += kStep;
  }
  return message;
}

nav_msgs::msg::OccupancyGrid to_message(const OccupancyGrid& grid, const std_msgs::msg::Header& header) {
  nav_msgs::msg::OccupancyGrid message;
  message.header(header);
  message.info().map_load_time(header.stamp());
  message.info().resolution(static_cast<float>(grid.resolution_m));
  message.info().width(static_cast<std::uint32_t>(grid.width));
  message.info().height(static_cast<std::uint32_t>(grid.height));
  message.info().origin().position().x(grid.origin_x_m);
  message.info().origin().position().y(grid.origin_y_m);
  message.info().origin().orientation().w(1.0);
  message.data().assign(grid.cells.begin(), grid.cells.end());
  return message;
}

}  // namespace lapis::semantic_mapper
