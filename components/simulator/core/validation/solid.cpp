#include "simulator/core/validation/solid.hpp"

#include <algorithm>
#include <array>

namespace lapis::simulator {
namespace {

constexpr float kSolidSpacing_m = 0.4F * Solid::kVoxel_m;  // so close that a surface has no holes
constexpr std::uint8_t kSurface = 1, kOutside = 2;

Eigen::Vector3i voxel_of(const Eigen::Vector3f& p) { return (p / Solid::kVoxel_m).array().floor().cast<int>(); }

}  // namespace

double Solid::voxels(const Item& item) { return ((item.box.sizes() / kVoxel_m).cast<double>().array() + 2.0).prod(); }

Solid::Solid(const Scene& scene, const Item& item)
    : low_(voxel_of(item.box.min())), size_((voxel_of(item.box.max()) - low_).array() + 1),
      filled_(index(Eigen::Vector3i(0, 0, size_.z())), 0) {
  for (const auto& p : surface_points(scene.mesh, item.triangles, kSolidSpacing_m)) {
    const Eigen::Vector3i v = (voxel_of(p) - low_).cwiseMax(0).cwiseMin((size_.array() - 1).matrix());
    filled_[index(v)] = kSurface;
  }
  fill_inside();
}

/// Floods the outside from the four sides and from above, but not from below, because models often have no bottom.
void Solid::fill_inside() {
  std::vector<Eigen::Vector3i> front;
  const auto flood = [&](const Eigen::Vector3i& v) {
    if (!is_in_box(v) || filled_[index(v)] != 0) return;
    filled_[index(v)] = kOutside;
    front.push_back(v);
  };
  for (int z = 0; z < size_.z(); ++z) {
    for (int y = 0; y < size_.y(); ++y) {
      const bool is_border = z == size_.z() - 1 || y == 0 || y == size_.y() - 1;
      for (int x = 0; x < size_.x(); x += is_border ? 1 : std::max(1, size_.x() - 1)) flood({x, y, z});
    }
  }
  while (!front.empty()) {
    const Eigen::Vector3i v = front.back();
    front.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      flood(v + Eigen::Vector3i::Unit(axis));
      flood(v - Eigen::Vector3i::Unit(axis));
    }
  }
  for (auto& voxel : filled_) voxel = voxel == kOutside ? std::uint8_t{0} : kSurface;
  count_ = static_cast<std::size_t>(std::count(filled_.begin(), filled_.end(), kSurface));
}

}  // namespace lapis::simulator
