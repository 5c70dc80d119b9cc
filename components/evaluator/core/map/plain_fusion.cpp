#include "evaluator/core/map/plain_fusion.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace lapis::evaluator {
namespace {

constexpr int kBits = 21;
constexpr std::int64_t kOffset = std::int64_t{1} << (kBits - 1);
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;

std::int32_t floor_to_int(double value) {
  const auto truncated = static_cast<std::int32_t>(value);
  return truncated - (value < static_cast<double>(truncated) ? 1 : 0);
}

/// Packs three indices, which must be within kMaxVoxelIndex, into one key.
std::uint64_t pack(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto part = [](std::int32_t i) { return static_cast<std::uint64_t>(i + kOffset); };
  return (part(x) << (2 * kBits)) | (part(y) << kBits) | part(z);
}

VoxelIndex unpack(std::uint64_t key) {
  const auto part = [key](int shift) {
    return static_cast<int>(static_cast<std::int64_t>((key >> shift) & kMask) - kOffset);
  };
  return {part(2 * kBits), part(kBits), part(0)};
}

std::uint16_t majority(const std::vector<std::pair<std::uint16_t, std::uint64_t>>& counts) {
  const auto is_worse = [](const auto& a, const auto& b) {
    if (a.second != b.second) return a.second < b.second;
    if (a.first == 0 || b.first == 0) return a.first == 0 && b.first != 0;
    return a.first > b.first;
  };
  return std::max_element(counts.begin(), counts.end(), is_worse)->first;
}

void check_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                 const geometry::LabelImage& labels) {
  const bool fits = depth.width == camera.width && depth.height == camera.height &&
                    (labels.empty() || (labels.width == camera.width && labels.height == camera.height));
  if (!fits) throw std::invalid_argument("plain fusion: depth, labels and camera must have one image size");
}

std::vector<double> column_rays(const geometry::PinholeCamera& camera) {
  std::vector<double> rays;
  for (int u = 0; u < camera.width; ++u) rays.push_back((u - camera.cx) / camera.fx);
  return rays;
}

/// Voxel indices along one axis of the points of a row of pixels.
/// @param origin, row_ray, column_ray coordinate along this axis of the camera and of the rays [voxels]
void locate(const float* depth_m, const std::vector<double>& ray_x, double origin, double row_ray, double column_ray,
            std::vector<std::int32_t>& indices) {
  constexpr double kFarAway = 1e9;  // [voxels]; far beyond any range
  for (std::size_t u = 0; u < ray_x.size(); ++u) {
    const double coordinate = origin + static_cast<double>(depth_m[u]) * (row_ray + column_ray * ray_x[u]);
    indices[u] = floor_to_int(std::clamp(coordinate, -kFarAway, kFarAway));
  }
}

}  // namespace

PlainFusion::PlainFusion(const PlainFusionConfig& config) : config_(config) {
  if (!(config.resolution_m > 0.0) || !(config.min_range_m >= 0.0) || !(config.max_range_m > config.min_range_m)) {
    throw std::invalid_argument("plain fusion needs a positive resolution and 0 <= min_range_m < max_range_m");
  }
}

void PlainFusion::add(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                      const geometry::LabelImage& labels, const geometry::Pose& T_map_camera) {
  check_frame(camera, depth, labels);
  const double reach_m = T_map_camera.translation().cwiseAbs().maxCoeff() + config_.max_range_m;
  if (!(reach_m / config_.resolution_m < kMaxVoxelIndex)) {
    throw std::invalid_argument("plain fusion: the camera pose lies outside the grid");
  }
  // In units of voxels: p_map = t + z * (column ray + row ray).
  const Eigen::Matrix3d R = T_map_camera.linear() / config_.resolution_m;
  const Eigen::Vector3d t = T_map_camera.translation() / config_.resolution_m;
  const double min_squared = config_.min_range_m * config_.min_range_m;
  const double max_squared = config_.max_range_m * config_.max_range_m;
  const std::vector<double> ray_x = column_rays(camera);
  std::array<std::vector<std::int32_t>, 3> indices;
  for (auto& of_axis : indices) of_axis.resize(ray_x.size());
  Run run;
  for (int v = 0; v < camera.height; ++v) {
    const double y = (v - camera.cy) / camera.fy;
    const Eigen::Vector3d row_ray = R.col(1) * y + R.col(2);
    const float* depth_m = &depth(0, v);
    for (int axis = 0; axis < 3; ++axis)
      locate(depth_m, ray_x, t[axis], row_ray[axis], R(axis, 0), indices[static_cast<std::size_t>(axis)]);
    for (std::size_t u = 0; u < ray_x.size(); ++u) {
      const double z = depth_m[u], x = ray_x[u];
      const double range_squared = z * z * (1.0 + x * x + y * y);
      if (!(z > 0.0 && range_squared >= min_squared && range_squared <= max_squared)) continue;
      const std::uint64_t key = pack(indices[0][u], indices[1][u], indices[2][u]);
      const std::uint16_t label = labels.empty() ? std::uint16_t{0} : labels(static_cast<int>(u), v);
      if (key != run.key || label != run.label) {
        count(run);
        run = {key, label, 0};
      }
      ++run.pixels;
    }
  }
  count(run);
}

void PlainFusion::count(const Run& run) {
  if (run.pixels == 0) return;
  LabelCounts& counts = counts_[run.key];
  const auto it = std::find_if(counts.begin(), counts.end(), [&run](const auto& c) { return c.first == run.label; });
  if (it != counts.end()) {
    it->second += run.pixels;
  } else {
    counts.emplace_back(run.label, run.pixels);
  }
}

LabelledVoxels PlainFusion::voxels() const {
  std::vector<LabelledVoxel> voxels;
  voxels.reserve(counts_.size());
  for (const auto& [key, counts] : counts_) voxels.push_back({unpack(key), majority(counts)});
  return make_labelled_voxels(config_.resolution_m, std::move(voxels));
}

std::optional<double> PlainFusion::share_in(const LabelledVoxels& map) const {
  const LabelledVoxels own = voxels();
  if (own.voxels.empty()) return std::nullopt;
  std::size_t common = 0;
  auto it = map.voxels.begin();
  for (const auto& voxel : own.voxels) {
    while (it != map.voxels.end() && is_before(it->index, voxel.index)) ++it;
    if (it != map.voxels.end() && it->index == voxel.index) ++common;
  }
  return static_cast<double>(common) / static_cast<double>(own.voxels.size());
}

}  // namespace lapis::evaluator
