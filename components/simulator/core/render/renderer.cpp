#include "simulator/core/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "simulator/core/render/mip_map.hpp"

namespace lapis::simulator {
namespace {

constexpr int kTile = 4;  // pixels per side of what is cast at once
static_assert(kTile * kTile == SceneRaycaster::kPacket);
constexpr float kFarthest_m = 200.0F;

/// All that shading needs of a triangle, in one cache line.
struct alignas(64) Facet {
  std::array<Eigen::Vector2f, 3> texture_coordinates;
  Eigen::Vector3f normal;
  float texels_per_m = 0.0F;  // of the finest level
  std::array<geometry::Rgb8, 3> colors;
  std::array<std::uint8_t, 3> light{255, 255, 255};
  std::uint16_t class_id = 0;
  std::uint16_t instance_id = 0;
  std::int16_t texture = -1;
};
static_assert(sizeof(Facet) == 64);

std::uint8_t times(int a, int b) { return static_cast<std::uint8_t>((a * b + 127) / 255); }
geometry::Rgb8 times(geometry::Rgb8 a, geometry::Rgb8 b) { return {times(a.r, b.r), times(a.g, b.g), times(a.b, b.b)}; }

float area(const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return std::abs(a.x() * b.y() - a.y() * b.x()); }

}  // namespace

struct Renderer::Implementation {
  const SceneRaycaster& raycaster;
  RendererConfig config;
  std::vector<MipMap> textures;
  std::vector<Facet> facets;

  Facet facet_of(const Scene& scene, std::size_t index, const std::vector<std::uint8_t>& light) const {
    const Mesh& mesh = scene.mesh;
    const Triangle& triangle = mesh.triangles[index];
    const Material& material = mesh.materials[triangle.material];
    Facet facet;
    const auto& [a, b, c] = triangle.vertices;
    const Eigen::Vector3f cross = (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    facet.normal = cross.normalized();
    facet.texture = static_cast<std::int16_t>(material.texture);
    facet.class_id = scene.instances[triangle.part].class_id;
    facet.instance_id = scene.instances[triangle.part].id;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = triangle.vertices[i];
      facet.colors[i] = mesh.colors.empty() ? material.color : times(material.color, mesh.colors[v]);
      if (!light.empty() && !material.is_emissive) facet.light[i] = light[3 * index + i];
      facet.texture_coordinates[i] =
          mesh.texture_coordinates.empty() ? Eigen::Vector2f::Zero() : mesh.texture_coordinates[v];
    }
    if (material.texture >= 0) {
      const auto& texture = textures[static_cast<std::size_t>(material.texture)];
      const auto& t = facet.texture_coordinates;
      const float texels = area(t[1] - t[0], t[2] - t[0]) * static_cast<float>(texture.width() * texture.height());
      facet.texels_per_m = std::sqrt(texels / std::max(cross.norm(), 1e-12F));
    }
    return facet;
  }

  void store(int column, int row, const Ray& ray, const RayHit& hit, float pixel, RenderedFrame& frame) const;

  geometry::Rgb8 shade(const Facet& facet, const RayHit& hit, float cosine, float pixel_m) const {
    const float w = 1.0F - hit.u - hit.v;
    const auto blend = [&](float a, float b, float c) { return w * a + hit.u * b + hit.v * c; };
    const auto& k = facet.colors;
    geometry::Rgb8 color = k[0];
    if (k[0] != k[1] || k[0] != k[2]) {
      color = {static_cast<std::uint8_t>(blend(k[0].r, k[1].r, k[2].r)),
               static_cast<std::uint8_t>(blend(k[0].g, k[1].g, k[2].g)),
               static_cast<std::uint8_t>(blend(k[0].b, k[1].b, k[2].b))};
    }
    if (facet.texture >= 0) {
      const MipMap& texture = textures[static_cast<std::size_t>(facet.texture)];
      const auto& t = facet.texture_coordinates;
      // Between the footprint's short side (pixel_m) and its long one (pixel_m / cosine).
      const float texels = facet.texels_per_m * pixel_m / std::sqrt(std::max(cosine, 0.05F));
      const int level = texels <= 1.0F ? 0 : std::min(std::ilogb(texels * 1.4142136F), texture.levels() - 1);
      color =
          times(color, texture.sample(level, blend(t[0].x(), t[1].x(), t[2].x()), blend(t[0].y(), t[1].y(), t[2].y())));
    }
    const auto light = static_cast<int>(blend(facet.light[0], facet.light[1], facet.light[2]));
    return {times(color.r, light), times(color.g, light), times(color.b, light)};
  }
};

Renderer::Renderer(const Scene& scene, const SceneRaycaster& raycaster, const std::vector<std::uint8_t>& light,
                   const RendererConfig& config)
    : implementation_(std::make_unique<Implementation>(Implementation{raycaster, config, {}, {}})) {
  for (const auto& texture : scene.mesh.textures) implementation_->textures.emplace_back(texture);
  implementation_->facets.reserve(scene.mesh.triangles.size());
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i) {
    implementation_->facets.push_back(implementation_->facet_of(scene, i, light));
  }
}
Renderer::~Renderer() = default;

namespace {

using Packet = std::array<Ray, SceneRaycaster::kPacket>;
using Hits = std::array<RayHit, SceneRaycaster::kPacket>;

RenderedFrame empty_frame(int width, int height, bool with_color) {
  RenderedFrame frame;
  if (with_color) frame.color = geometry::ColorImage(width, height);
  frame.depth = geometry::DepthImage(width, height);
  frame.labels = geometry::LabelImage(width, height);
  frame.instances = geometry::Image<std::uint16_t>(width, height);
  frame.cosines = geometry::Image<float>(width, height);
  return frame;
}

/// Sixteen rays through a tile's pixels. Their directions have z-depth 1, so that distances are z-depths.
Packet rays_of(const geometry::PinholeCamera& camera, const Eigen::Vector3f& origin, const Eigen::Matrix3f& rotation,
               int column, int row) {
  Packet rays;
  for (int i = 0; i < SceneRaycaster::kPacket; ++i) {
    const Eigen::Vector3d p = camera.unproject(column + i % kTile, row + i / kTile, 1.0);
    rays[static_cast<std::size_t>(i)] = {origin, rotation * p.cast<float>()};
  }
  return rays;
}

}  // namespace

/// What the hit of a pixel's ray says.
void Renderer::Implementation::store(int column, int row, const Ray& ray, const RayHit& hit, float pixel,
                                     RenderedFrame& frame) const {
  if (hit.triangle == RayHit::kNone || column >= frame.depth.width || row >= frame.depth.height) return;
  const Facet& facet = facets[hit.triangle];
  const float cosine = std::abs(facet.normal.dot(ray.direction)) / ray.direction.norm();
  frame.depth(column, row) = hit.distance;
  frame.labels(column, row) = facet.class_id;
  frame.instances(column, row) = facet.instance_id;
  frame.cosines(column, row) = cosine;
  if (!frame.color.empty()) frame.color(column, row) = shade(facet, hit, cosine, hit.distance * pixel);
}

RenderedFrame Renderer::render(const geometry::PinholeCamera& camera, const geometry::Pose& T_world_camera,
                               bool with_color) const {
  const auto& self = *implementation_;
  RenderedFrame frame = empty_frame(camera.width, camera.height, with_color);
  const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
  const Eigen::Matrix3f rotation = T_world_camera.linear().cast<float>();
  const auto pixel = static_cast<float>(1.0 / std::sqrt(camera.fx * camera.fy));  // side, at 1 m [m]
  std::atomic<int> next_row{0};
  const auto work = [&] {
    Hits hits;
    for (int row = next_row.fetch_add(kTile); row < camera.height; row = next_row.fetch_add(kTile)) {
      for (int column = 0; column < camera.width; column += kTile) {
        const Packet rays = rays_of(camera, origin, rotation, column, row);
        self.raycaster.cast(rays, kFarthest_m, hits);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const int at = static_cast<int>(i);
          self.store(column + at % kTile, row + at / kTile, rays[i], hits[i], pixel, frame);
        }
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < self.config.threads; ++i) helpers.emplace_back(work);
  work();
  helpers.clear();
  return frame;
}

}  // namespace lapis::simulator
