#include "simulator/core/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "simulator/core/render/avx2.hpp"
#include "simulator/core/render/mip_map.hpp"

namespace lapis::simulator {
namespace {

// Pixels of a packet.
constexpr int kColumns = 4, kRows = 2;
constexpr std::size_t kSize = RayPacket::kSize;
static_assert(kColumns * kRows == RayPacket::kSize);
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

using Floats = std::array<float, kSize>;
using Words = std::array<std::uint32_t, kSize>;

/// The product of two channels over 255, rounded, without a division.
std::uint32_t scaled(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t product = a * b + 128;
  return (product + (product >> 8U)) >> 8U;
}
std::uint8_t times(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(scaled(a, b)); }
geometry::Rgb8 times(geometry::Rgb8 a, geometry::Rgb8 b) { return {times(a.r, b.r), times(a.g, b.g), times(a.b, b.b)}; }

float area(const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return std::abs(a.x() * b.y() - a.y() * b.x()); }

/// What rays meet that leave the scene: black, of no class.
Facet nothing() {
  Facet facet;
  facet.texture_coordinates.fill(Eigen::Vector2f::Zero());
  facet.normal.setZero();
  return facet;
}

using Met = std::array<const Facet*, kSize>;

/// What a packet's colours are made of. Channels are bytes of words.
struct Look {
  Words color;
  Words light;                  // 0 to 255
  std::array<Words, 4> texels;  // to be mixed, row by row
  Words right, down;            // weights of the second column and row, in 1/256
};

}  // namespace

struct Renderer::Implementation {
  const SceneRaycaster& raycaster;
  RendererConfig config;
  std::vector<MipMap> textures;
  std::vector<Facet> facets;  // by triangle, and nothing() at the end

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

  void store(int column, int row, const RayPacket& rays, const HitPacket& hits, float pixel,
             RenderedFrame& frame) const;
  Words shade(const Met& met, const HitPacket& hits, const Floats& cosines, float pixel) const;
  void sample(const Met& met, const HitPacket& hits, const Floats& texels_per_pixel, Look& look) const;
};

Renderer::Renderer(const Scene& scene, const SceneRaycaster& raycaster, const std::vector<std::uint8_t>& light,
                   const RendererConfig& config)
    : implementation_(std::make_unique<Implementation>(Implementation{raycaster, config, {}, {}})) {
  for (const auto& texture : scene.mesh.textures) implementation_->textures.emplace_back(texture);
  implementation_->facets.reserve(scene.mesh.triangles.size() + 1);
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i) {
    implementation_->facets.push_back(implementation_->facet_of(scene, i, light));
  }
  implementation_->facets.push_back(nothing());
}
Renderer::~Renderer() = default;

namespace {

RenderedFrame empty_frame(int width, int height, bool with_color) {
  RenderedFrame frame;
  if (with_color) frame.color = geometry::ColorImage(width, height);
  frame.depth = geometry::DepthImage(width, height);
  frame.labels = geometry::LabelImage(width, height);
  frame.instances = geometry::Image<std::uint16_t>(width, height);
  frame.cosines = geometry::Image<float>(width, height);
  return frame;
}

/// Rays through all pixels. Their directions have z-depth 1, so that distances are z-depths; every one is the sum of a
/// part that depends on the column and one that depends on the row.
class PixelRays {
 public:
  PixelRays(const geometry::PinholeCamera& camera, const geometry::Pose& T_world_camera)
      : origin_(T_world_camera.translation().cast<float>()) {
    const Eigen::Matrix3f rotation = T_world_camera.linear().cast<float>();
    for (int column = 0; column < camera.width + kColumns; ++column) {
      const auto x = static_cast<float>(camera.unproject(column, 0, 1.0).x());
      columns_.emplace_back(x * rotation.col(0));
    }
    for (int row = 0; row < camera.height + kRows; ++row) {
      const auto y = static_cast<float>(camera.unproject(0, row, 1.0).y());
      rows_.emplace_back(y * rotation.col(1) + rotation.col(2));
    }
  }
  /// Those of the pixels at and after a column and a row.
  RayPacket operator()(int column, int row) const {
    RayPacket rays{origin_};
    for (std::size_t i = 0; i < kSize; ++i) {
      const Eigen::Vector3f& across = columns_[static_cast<std::size_t>(column) + i % kColumns];
      const Eigen::Vector3f& down = rows_[static_cast<std::size_t>(row) + i / kColumns];
      rays.x[i] = across.x() + down.x();
      rays.y[i] = across.y() + down.y();
      rays.z[i] = across.z() + down.z();
    }
    return rays;
  }

 private:
  Eigen::Vector3f origin_;
  std::vector<Eigen::Vector3f> columns_, rows_;
};

/// |cos| of the angles between rays and surface normals.
Floats cosines_of(const Met& met, const RayPacket& rays) {
  Floats cosines;
  for (std::size_t i = 0; i < kSize; ++i) {
    const Eigen::Vector3f& normal = met[i]->normal;
    cosines[i] = normal.x() * rays.x[i] + (normal.y() * rays.y[i] + normal.z() * rays.z[i]);
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const float squares = rays.x[i] * rays.x[i] + (rays.y[i] * rays.y[i] + rays.z[i] * rays.z[i]);
    cosines[i] = std::abs(cosines[i]) / std::sqrt(squares);
  }
  return cosines;
}

/// A value between those at a triangle's corners.
float blend(const HitPacket& hits, std::size_t i, float a, float b, float c) {
  return (1.0F - hits.u[i] - hits.v[i]) * a + hits.u[i] * b + hits.v[i] * c;
}

std::uint32_t word(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  static_assert(std::endian::native == std::endian::little);  // as the words of texels
  return r | std::uint32_t{g} << 8U | std::uint32_t{b} << 16U;
}
geometry::Rgb8 pixel_of(std::uint32_t word) {
  return {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8U),
          static_cast<std::uint8_t>(word >> 16U)};
}

/// Colour of a hit, without texture and light.
std::uint32_t plain_color(const Facet& facet, const HitPacket& hits, std::size_t i) {
  const auto& [a, b, c] = facet.colors;
  if (a == b && a == c) return word(a.r, a.g, a.b);
  return word(static_cast<std::uint8_t>(blend(hits, i, a.r, b.r, c.r)),
              static_cast<std::uint8_t>(blend(hits, i, a.g, b.g, c.g)),
              static_cast<std::uint8_t>(blend(hits, i, a.b, b.b, c.b)));
}

/// Texture, times colour, times light; in fixed point, so the same on every machine.
Words mixed(const Look& look) {
  Words out{};
  for (unsigned shift = 0; shift < 24; shift += 8) {
    for (std::size_t i = 0; i < kSize; ++i) {
      const auto channel = [&](const Words& words) { return (words[i] >> shift) & 255U; };
      const std::uint32_t right = look.right[i], down = look.down[i];
      const std::uint32_t upper = channel(look.texels[0]) * (256 - right) + channel(look.texels[1]) * right;
      const std::uint32_t lower = channel(look.texels[2]) * (256 - right) + channel(look.texels[3]) * right;
      const std::uint32_t texture = (upper * (256 - down) + lower * down + (1U << 15U)) >> 16U;
      out[i] |= scaled(scaled(channel(look.color), texture), look.light[i]) << shift;
    }
  }
  return out;
}

}  // namespace

/// Looks up the texels; without a texture they are white.
void Renderer::Implementation::sample(const Met& met, const HitPacket& hits, const Floats& texels_per_pixel,
                                      Look& look) const {
  for (std::size_t i = 0; i < kSize; ++i) {
    constexpr std::uint32_t kWhite = 0xFFFFFFU;
    MipMap::Neighbours around{{kWhite, kWhite, kWhite, kWhite}, 0, 0};
    if (met[i]->texture >= 0) {
      const MipMap& texture = textures[static_cast<std::size_t>(met[i]->texture)];
      // The level is the binary logarithm, rounded.
      const int exponent =
          static_cast<int>(std::bit_cast<std::uint32_t>(texels_per_pixel[i] * 1.4142136F) >> 23U) - 127;
      const auto& [a, b, c] = met[i]->texture_coordinates;
      around = texture.neighbours(std::clamp(exponent, 0, texture.levels() - 1), blend(hits, i, a.x(), b.x(), c.x()),
                                  blend(hits, i, a.y(), b.y(), c.y()));
    }
    for (std::size_t k = 0; k < 4; ++k) look.texels[k][i] = around.texels[k];
    look.right[i] = around.right;
    look.down[i] = around.down;
  }
}

Words Renderer::Implementation::shade(const Met& met, const HitPacket& hits, const Floats& cosines, float pixel) const {
  Look look;
  Floats texels_per_pixel;
  for (std::size_t i = 0; i < kSize; ++i) {
    // Between the footprint's short side and its long one, which is 1 / cosine times as long.
    texels_per_pixel[i] = met[i]->texels_per_m * (hits.distance[i] * pixel) / std::sqrt(std::max(cosines[i], 0.05F));
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const auto& [a, b, c] = met[i]->light;
    look.light[i] = static_cast<std::uint32_t>(blend(hits, i, a, b, c));
    look.color[i] = plain_color(*met[i], hits, i);
  }
  sample(met, hits, texels_per_pixel, look);
  return mixed(look);
}

/// What the hits of a packet say, as far as its pixels lie in the image.
void Renderer::Implementation::store(int column, int row, const RayPacket& rays, const HitPacket& hits, float pixel,
                                     RenderedFrame& frame) const {
  Met met;
  for (std::size_t i = 0; i < kSize; ++i) met[i] = &facets[std::min<std::size_t>(hits.triangle[i], facets.size() - 1)];
  const Floats cosines = cosines_of(met, rays);
  Words colors{};
  if (!frame.color.empty()) colors = shade(met, hits, cosines, pixel);
  for (std::size_t i = 0; i < kSize; ++i) {
    const int x = column + static_cast<int>(i % kColumns), y = row + static_cast<int>(i / kColumns);
    if (x >= frame.depth.width || y >= frame.depth.height) continue;
    frame.depth(x, y) = hits.distance[i];
    frame.labels(x, y) = met[i]->class_id;
    frame.instances(x, y) = met[i]->instance_id;
    frame.cosines(x, y) = cosines[i];
    if (!frame.color.empty()) frame.color(x, y) = pixel_of(colors[i]);
  }
}

RenderedFrame Renderer::render(const geometry::PinholeCamera& camera, const geometry::Pose& T_world_camera,
                               bool with_color) const {
  const auto& self = *implementation_;
  RenderedFrame frame = empty_frame(camera.width, camera.height, with_color);
  const PixelRays rays_of(camera, T_world_camera);
  const auto pixel = static_cast<float>(1.0 / std::sqrt(camera.fx * camera.fy));  // side, at 1 m [m]
  std::atomic<int> next_row{0};
  const auto work = [&] {
    HitPacket hits;
    for (int row = next_row.fetch_add(kRows); row < camera.height; row = next_row.fetch_add(kRows)) {
      for (int column = 0; column < camera.width; column += kColumns) {
        const RayPacket rays = rays_of(column, row);
        self.raycaster.cast(rays, kFarthest_m, hits);
        self.store(column, row, rays, hits, pixel, frame);
      }
    }
  };
  const auto work_wide = [&] { run_wide(work); };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < self.config.threads; ++i) helpers.emplace_back(work_wide);
  work_wide();
  helpers.clear();
  return frame;
}

}  // namespace lapis::simulator
