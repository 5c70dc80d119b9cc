#include "simulator/core/validation/items.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

namespace lapis::simulator {
namespace {

constexpr std::array kStructure{"wall", "floor", "ceiling", "door", "window"};

bool is_structure(const Scene& scene, const Instance& instance) {
  const std::string name = scene.labels.name(instance.class_id);
  return std::any_of(kStructure.begin(), kStructure.end(), [&](const char* other) { return name == other; });
}

using Corners = std::array<Eigen::Vector3f, 3>;

constexpr double kMostPoints = 1e8;  // 1.2 GB
constexpr float kRowSpacing = 0.8F;  // so small that the middle of four points is near enough to them

int pieces(float length, float longest) { return std::max(1, static_cast<int>(std::ceil(length / longest))); }

/// Adds points in rows along the longest side; each row is as long as the strip above it is at its lower edge.
void add_points(const Corners& c, float spacing_m, std::vector<Eigen::Vector3f>& points) {
  std::size_t longest = 0;
  for (const std::size_t side : {1U, 2U}) {
    if ((c[(side + 1) % 3] - c[side]).squaredNorm() > (c[(longest + 1) % 3] - c[longest]).squaredNorm()) longest = side;
  }
  const Eigen::Vector3f &a = c[longest], &b = c[(longest + 1) % 3], &top = c[(longest + 2) % 3];
  const float base = (b - a).norm(), twice_area = (b - a).cross(top - a).norm();
  const float height = base > 0.0F ? twice_area / base : 0.0F;
  const int rows = pieces(height, kRowSpacing * spacing_m);
  for (int row = 0; row < rows; ++row) {
    const float share = static_cast<float>(row) / static_cast<float>(rows);
    const Eigen::Vector3f left = a + share * (top - a), span = (1.0F - share) * (b - a);
    const int count = pieces(span.norm(), spacing_m);
    for (int i = 0; i < count; ++i)
      points.emplace_back(left + (static_cast<float>(i) + 0.5F) / static_cast<float>(count) * span);
  }
}

[[noreturn]] void refuse(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Eigen::AlignedBox3f box;
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t v : mesh.triangles[t].vertices) box.extend(mesh.positions[v]);
  }
  std::ostringstream problem;
  problem << "a thing measures " << box.sizes().transpose()
          << " m, too much to check; correct the units of the scene if they are not metres";
  throw std::runtime_error(problem.str());
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
  const float cell_m2 = kRowSpacing * spacing_m * spacing_m;
  double expected = 0.0;
  std::vector<Eigen::Vector3f> points;
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t].vertices;
    const Corners corners{mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
    const Eigen::Vector3f a = corners[1] - corners[0], b = corners[2] - corners[0];
    expected += static_cast<double>(a.cross(b).norm() / 2 / cell_m2 + (a.norm() + b.norm()) / spacing_m);
    if (expected > kMostPoints) refuse(mesh, triangles);
    add_points(corners, spacing_m, points);
  }
  return points;
}

}  // namespace lapis::simulator
