#include "simulator/core/validation/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "simulator/core/render/raycaster.hpp"

namespace lapis::simulator {
namespace {

constexpr float kSupportSpacing_m = 0.02F;
constexpr float kPressed_m = 0.01F;  // rays begin this far inside, because items may be pressed into each other

using Points = std::vector<Eigen::Vector3f>;

/// Directions down, up, and to eight sides.
const std::vector<Eigen::Vector3f>& directions() {
  static const std::vector<Eigen::Vector3f> all = [] {
    std::vector<Eigen::Vector3f> list{-Eigen::Vector3f::UnitZ(), Eigen::Vector3f::UnitZ()};
    for (int i = 0; i < 8; ++i) {
      const auto angle = 0.25F * std::numbers::pi_v<float> * static_cast<float>(i);
      list.emplace_back(std::cos(angle), std::sin(angle), 0.0F);
    }
    return list;
  }();
  return all;
}

/// True when something is within reach of one of the points in one of the first `count` directions.
bool touches(const SceneRaycaster& others, const Points& points, std::size_t count) {
  return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3f& p) {
    std::array<Ray, SceneRaycaster::kPacket> rays;
    std::array<float, SceneRaycaster::kPacket> longest{};
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f& direction = directions()[i];
      rays[i] = {p - kPressed_m * direction, direction};
      longest[i] = kPressed_m + kSupportGap_m;
    }
    return others.occluded(std::span(rays).first(count), std::span(longest).first(count)) != 0;
  });
}

/// Points on the surface of an item, the lowest ones first, because most items stand on them.
Points points_of(const Scene& scene, const Item& item) {
  Points points = surface_points(scene.mesh, item.triangles, kSupportSpacing_m);
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
  return points;
}

bool is_near(const Item& a, const Item& b) {
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(kSupportGap_m);
  return Eigen::AlignedBox3f(a.box.min() - reach, a.box.max() + reach).intersects(b.box);
}

/// Triangles of all other items that are held and near.
std::vector<std::uint32_t> held_around(const Inventory& inventory, std::size_t index, const std::vector<bool>& held) {
  std::vector<std::uint32_t> triangles;
  for (std::size_t k = 0; k < inventory.items.size(); ++k) {
    const Item& other = inventory.items[k];
    if (k == index || !held[k] || !is_near(inventory.items[index], other)) continue;
    triangles.insert(triangles.end(), other.triangles.begin(), other.triangles.end());
  }
  return triangles;
}

std::vector<bool> held_by_building(const Scene& scene, const Inventory& inventory, const std::vector<Points>& points) {
  std::vector<bool> held(inventory.items.size(), false);
  if (inventory.structure.empty()) return held;
  const Mesh mesh = part_of(scene.mesh, inventory.structure);
  const SceneRaycaster building(mesh);
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = touches(building, points[i], directions().size());
  return held;
}

}  // namespace

std::vector<std::size_t> find_floating(const Scene& scene, const Inventory& inventory) {
  std::vector<Points> points;
  for (const Item& item : inventory.items) points.push_back(points_of(scene, item));
  std::vector<bool> held = held_by_building(scene, inventory, points);
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (std::size_t i = 0; i < held.size(); ++i) {
      const auto triangles = held[i] ? std::vector<std::uint32_t>() : held_around(inventory, i, held);
      if (triangles.empty()) continue;
      const Mesh mesh = part_of(scene.mesh, triangles);
      held[i] = touches(SceneRaycaster(mesh), points[i], 1);
      is_changed = is_changed || held[i];
    }
  }
  std::vector<std::size_t> floating;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (!held[i]) floating.push_back(i);
  }
  return floating;
}

}  // namespace lapis::simulator
