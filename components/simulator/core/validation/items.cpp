#include "simulator/core/validation/items.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

namespace lapis::simulator {
namespace {

constexpr std::array kStructure{"wall", "floor", "ceiling", "door", "window"};

bool is_structure(const Scene& scene, const Instance& instance) {
  const std::string name = scene.labels.name(instance.class_id);
  return std::any_of(kStructure.begin(), kStructure.end(), [&](const char* other) { return name == other; });
}

using Corners = std::array<Eigen::Vector3f, 3>;

/// Halves the longest side until all sides are short: slivers then give few points.
void add_points(const Corners& c, float spacing_m, std::vector<Eigen::Vector3f>& points) {
  std::size_t longest = 0;
  for (const std::size_t side : {1U, 2U}) {
    if ((c[(side + 1) % 3] - c[side]).squaredNorm() > (c[(longest + 1) % 3] - c[longest]).squaredNorm()) longest = side;
  }
  const Eigen::Vector3f &a = c[longest], &b = c[(longest + 1) % 3], &top = c[(longest + 2) % 3];
  if ((b - a).norm() <= spacing_m) {
    points.emplace_back((a + b + top) / 3.0F);
    return;
  }
  const Eigen::Vector3f middle = 0.5F * (a + b);
  add_points({a, middle, top}, spacing_m, points);
  add_points({middle, b, top}, spacing_m, points);
}

}  // namespace

Inventory take_inventory(const Scene& scene) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  Inventory inventory;
  std::vector<std::size_t> item_of(scene.instances.size(), kNone);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (is_structure(scene, instance)) continue;
    auto& items = inventory.items;
    const std::string suffix = "/" + scene.labels.name(instance.class_id);
    if (items.empty() || instance.name != items.back().name + suffix)
      items.push_back({instance.name, instance.class_id, {}, {}});
    item_of[i] = items.size() - 1;
  }
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    const std::size_t index = item_of[scene.mesh.triangles[t].part];
    if (index == kNone) {
      inventory.structure.push_back(t);
      continue;
    }
    Item& item = inventory.items[index];
    item.triangles.push_back(t);
    for (const std::uint32_t vertex : scene.mesh.triangles[t].vertices) item.box.extend(scene.mesh.positions[vertex]);
  }
  std::erase_if(inventory.items, [](const Item& item) { return item.triangles.empty(); });
  return inventory;
}

Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Mesh part;
  part.materials = mesh.materials;
  part.textures = mesh.textures;
  std::map<std::uint32_t, std::uint32_t> renumbered;
  for (const std::uint32_t t : triangles) {
    Triangle& triangle = part.triangles.emplace_back(mesh.triangles[t]);
    for (std::uint32_t& vertex : triangle.vertices) {
      const auto [it, is_new] = renumbered.emplace(vertex, static_cast<std::uint32_t>(part.positions.size()));
      if (is_new) part.positions.push_back(mesh.positions[vertex]);
      if (is_new && !mesh.texture_coordinates.empty())
        part.texture_coordinates.push_back(mesh.texture_coordinates[vertex]);
      vertex = it->second;
    }
  }
  return part;
}

std::vector<Eigen::Vector3f> surface_points(const Mesh& mesh, const std::vector<std::uint32_t>& triangles,
                                            float spacing_m) {
  std::vector<Eigen::Vector3f> points;
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t].vertices;
    add_points({mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]}, spacing_m, points);
  }
  return points;
}

}  // namespace lapis::simulator
