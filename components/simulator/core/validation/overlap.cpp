#include "simulator/core/validation/overlap.hpp"

#include <algorithm>
#include <optional>

#include "simulator/core/scene/polygon.hpp"
#include "simulator/core/validation/solid.hpp"

namespace lapis::simulator {
namespace {

constexpr int kContact_voxels = 4;  // 8 cm: an item that is pressed in by 6 cm fills no more, wherever the grid is
constexpr double kOverlapShare = 0.02;
constexpr double kOutside_m = 0.03, kOutsideShare = 0.01;
constexpr float kOverlapSpacing_m = 0.03F;
constexpr double kMostVoxels = 6e7;  // 500 m3: larger items are no furniture

/// The voxels of two solids.
class Pair {
 public:
  Pair(const Solid& a, const Solid& b) : a_(a), b_(b) {}

  Overlap compare() const {
    Overlap result;
    std::size_t count = 0;
    Eigen::Vector3f sum(0, 0, 0);
    const Eigen::Vector3i low = a_.low().cwiseMax(b_.low()), high = a_.high().cwiseMin(b_.high());
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const Eigen::Vector3i v(x, y, z);
          if (fill(v) != 3 || is_contact(v)) continue;
          ++count;
          sum += Solid::kVoxel_m * (v.cast<float>() + Eigen::Vector3f::Constant(0.5F));
        }
      }
    }
    if (count == 0) return result;
    result.share = static_cast<double>(count) / static_cast<double>(std::min(a_.count(), b_.count()));
    result.at = sum / static_cast<float>(count);
    return result;
  }

 private:
  /// Solids that fill a voxel: 0: none, 1: the first, 2: the second, 3: both.
  int fill(const Eigen::Vector3i& v) const { return (a_.contains(v) ? 1 : 0) + (b_.contains(v) ? 2 : 0); }

  bool is_contact(const Eigen::Vector3i& v) const {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i step = Eigen::Vector3i::Unit(axis);
      Eigen::Vector3i before = v - step, after = v + step;
      int length = 1;
      for (; length <= kContact_voxels && fill(before) == 3; ++length) before -= step;
      for (; length <= kContact_voxels && fill(after) == 3; ++length) after += step;
      if (length <= kContact_voxels && fill(before) != fill(after)) return true;
    }
    return false;
  }

  const Solid &a_, &b_;
};

/// True when a point is in no room, with some tolerance.
bool is_outside(const std::vector<Room>& rooms, double floor_z_m, const Eigen::Vector3d& p) {
  if (p.z() < floor_z_m - kOutside_m) return true;
  return std::none_of(rooms.begin(), rooms.end(), [&](const Room& room) {
    if (p.z() > floor_z_m + room.height_m + kOutside_m) return false;
    return contains(room.polygon, p.head<2>().eval()) || distance_to_border(room.polygon, p.head<2>()) < kOutside_m;
  });
}

/// Rooms whose bounding box the item meets.
std::vector<Room> rooms_around(const Scene& scene, const Item& item) {
  std::vector<Room> rooms;
  for (const Room& room : scene.rooms) {
    Eigen::AlignedBox2f box;
    for (const auto& corner : room.polygon) box.extend(corner.cast<float>());
    const Eigen::AlignedBox2f footprint(item.box.min().head<2>().eval(), item.box.max().head<2>().eval());
    if (box.squaredExteriorDistance(footprint) <= kOutside_m * kOutside_m) rooms.push_back(room);
  }
  return rooms;
}

}  // namespace

std::vector<Overlap> find_overlaps(const Scene& scene, const Inventory& inventory) {
  const auto& items = inventory.items;
  std::vector<std::optional<Solid>> solids(items.size());
  const auto solid = [&](std::size_t i) -> const Solid& {
    if (!solids[i]) solids[i].emplace(scene, items[i]);
    return *solids[i];
  };
  std::vector<Overlap> found;
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = i + 1; k < items.size(); ++k) {
      if (std::max(Solid::voxels(items[i]), Solid::voxels(items[k])) > kMostVoxels) continue;
      if (!items[i].box.intersects(items[k].box)) continue;
      Overlap overlap = Pair(solid(i), solid(k)).compare();
      overlap.first = i;
      overlap.second = k;
      if (overlap.share > kOverlapShare) found.push_back(overlap);
    }
  }
  return found;
}

std::vector<Protrusion> find_protrusions(const Scene& scene, const Inventory& inventory) {
  std::vector<Protrusion> found;
  for (std::size_t i = 0; i < inventory.items.size() && !scene.rooms.empty(); ++i) {
    const Item& item = inventory.items[i];
    const auto rooms = rooms_around(scene, item);
    const auto points = surface_points(scene.mesh, item.triangles, kOverlapSpacing_m);
    const auto outside = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3f& p) {
      return is_outside(rooms, scene.floor_z_m, p.cast<double>());
    });
    const double share = static_cast<double>(outside) / static_cast<double>(points.size());
    if (share > kOutsideShare) found.push_back({i, share});
  }
  return found;
}

}  // namespace lapis::simulator
