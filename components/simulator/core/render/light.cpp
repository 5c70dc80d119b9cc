#include "simulator/core/render/light.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <thread>

namespace lapis::simulator {
namespace {

constexpr int kDirections = SceneRaycaster::kPacket;
constexpr float kAmbientRange_m = 1.2F;
constexpr float kAmbient = 0.42F;
constexpr float kFloor = 0.06F;
constexpr float kOffset_m = 0.004F;   // of a ray's origin from its surface
constexpr float kLampRange_m = 7.0F;  // lamps that are farther away do not count
constexpr float kGamma = 1.0F / 2.2F;
constexpr float kCrease = 0.7F;  // least cosine of the angle between faces of a smooth surface

using Directions = std::array<Eigen::Vector3f, kDirections>;

/// Cosine-weighted directions about +z: a Hammersley set.
Directions hammersley() {
  Directions out;
  for (int i = 0; i < kDirections; ++i) {
    unsigned int bits = static_cast<unsigned int>(i);
    float radical = 0.0F;
    for (float digit = 0.5F; bits != 0; bits >>= 1U, digit /= 2.0F) radical += digit * static_cast<float>(bits & 1U);
    const float squared = (static_cast<float>(i) + 0.5F) / static_cast<float>(kDirections);
    const float angle = 2.0F * std::numbers::pi_v<float> * radical;
    out[static_cast<std::size_t>(i)] = {std::sqrt(squared) * std::cos(angle), std::sqrt(squared) * std::sin(angle),
                                        std::sqrt(1.0F - squared)};
  }
  return out;
}

/// Corners of triangles (3 * triangle + corner) by vertex.
struct Corners {
  std::vector<std::uint32_t> first;  // of each vertex, as an index into `corner`; one more at the end
  std::vector<std::uint32_t> corner;
};

Corners corners_by_vertex(const Mesh& mesh) {
  Corners out;
  out.first.assign(mesh.positions.size() + 1, 0);
  for (const auto& triangle : mesh.triangles) {
    for (const auto v : triangle.vertices) ++out.first[v + 1];
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) out.first[v + 1] += out.first[v];
  out.corner.resize(3 * mesh.triangles.size());
  auto next = out.first;
  for (std::uint32_t c = 0; c < out.corner.size(); ++c) {
    out.corner[next[mesh.triangles[c / 3].vertices[c % 3]]++] = c;
  }
  return out;
}

/// Normal of a triangle; its length is twice the area.
Eigen::Vector3f area_normal(const Mesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle.vertices;
  return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
}

/// Corners at one vertex whose faces form a smooth surface.
struct SmoothGroup {
  Eigen::Vector3f normal;  // area-weighted, not of unit length
  std::vector<std::uint32_t> corners;
};

/// An edge that is sharper than kCrease separates the faces on its two sides: the top of a table is lit in another way
/// than its sides.
std::vector<SmoothGroup> smooth_groups(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  std::vector<SmoothGroup> groups;
  for (const std::uint32_t c : corners) {
    const Eigen::Vector3f normal = area_normal(mesh, mesh.triangles[c / 3]);
    auto it = std::find_if(groups.begin(), groups.end(), [&](const SmoothGroup& group) {
      return group.normal.dot(normal) > kCrease * group.normal.norm() * normal.norm();
    });
    if (it == groups.end()) it = groups.insert(it, {Eigen::Vector3f::Zero(), {}});
    it->normal += normal;
    it->corners.push_back(c);
  }
  return groups;
}

class Baker {
 public:
  Baker(const Scene& scene, const SceneRaycaster& raycaster)
      : scene_(scene), raycaster_(raycaster), directions_(hammersley()) {}

  /// Irradiance on the side to which `normal` points.
  float irradiance(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const {
    const Eigen::Vector3f origin = position + kOffset_m * normal;
    return kFloor + kAmbient * openness(origin, normal) + from_lamps(origin, normal);
  }

 private:
  /// Share of directions in which nothing is near.
  float openness(const Eigen::Vector3f& origin, const Eigen::Vector3f& normal) const {
    const Eigen::Vector3f side =
        normal.cross(std::abs(normal.z()) < 0.9F ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX()).normalized();
    Eigen::Matrix3f frame;
    frame << side, normal.cross(side), normal;
    std::array<Ray, kDirections> rays;
    std::array<float, kDirections> lengths;
    lengths.fill(kAmbientRange_m);
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = {origin, frame * directions_[i]};
    const int hidden = std::popcount(raycaster_.occluded(rays, lengths));
    return 1.0F - static_cast<float>(hidden) / static_cast<float>(kDirections);
  }

  float from_lamps(const Eigen::Vector3f& origin, const Eigen::Vector3f& normal) const {
    float sum = 0.0F;
    std::array<Ray, kDirections> rays;
    std::array<float, kDirections> lengths{}, light{};
    std::size_t count = 0;
    const auto flush = [&] {
      const unsigned int hidden = raycaster_.occluded({rays.data(), count}, {lengths.data(), count});
      for (std::size_t i = 0; i < count; ++i) sum += (hidden >> i & 1U) != 0 ? 0.0F : light[i];
      count = 0;
    };
    for (const auto& lamp : scene_.lamps) {
      const Eigen::Vector3f to_lamp = lamp.position - origin;
      const float distance = to_lamp.norm(), cosine = normal.dot(to_lamp) / distance;
      if (distance > kLampRange_m || !(cosine > 0.0F)) continue;
      rays[count] = {origin, to_lamp};
      lengths[count] = 1.0F;
      light[count] = lamp.intensity * cosine / std::max(distance * distance, 0.25F);
      if (++count == rays.size()) flush();
    }
    if (count > 0) flush();
    return sum;
  }

  const Scene& scene_;
  const SceneRaycaster& raycaster_;
  Directions directions_;
};

}  // namespace

std::vector<std::uint8_t> bake_light(const Scene& scene, const SceneRaycaster& raycaster, int threads) {
  if (!scene.is_lit) return {};
  const Mesh& mesh = scene.mesh;
  const Corners corners = corners_by_vertex(mesh);
  const Baker baker(scene, raycaster);
  std::vector<std::uint8_t> light(3 * mesh.triangles.size());
  const auto bake = [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::span around(corners.corner.data() + corners.first[v], corners.first[v + 1] - corners.first[v]);
      for (const auto& group : smooth_groups(mesh, around)) {
        const Eigen::Vector3f normal = group.normal.normalized();
        const float brightest =
            std::max(baker.irradiance(mesh.positions[v], normal), baker.irradiance(mesh.positions[v], -normal));
        const auto level = static_cast<std::uint8_t>(std::lround(255.0F * std::pow(std::min(brightest, 1.0F), kGamma)));
        for (const std::uint32_t c : group.corners) light[c] = level;
      }
    }
  };
  std::vector<std::jthread> workers;
  const auto count = static_cast<std::size_t>(std::max(threads, 1));
  for (std::size_t i = 0; i < count; ++i) {
    workers.emplace_back(bake, mesh.positions.size() * i / count, mesh.positions.size() * (i + 1) / count);
  }
  return workers.clear(), light;
}

}  // namespace lapis::simulator
