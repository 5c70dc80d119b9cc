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

/// Everything that shading needs of a triangle, in one cache line.
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
using Levels = std::array<int, kSize>;

/// The product of two channels over 255, rounded, without a division.
std::uint32_t scaled(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t product = a * b + 128;
  return (product + (product >> 8U)) >> 8U;
}
std::uint8_t times(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(scaled(a, b)); }
geometry::Rgb8 times(geometry::Rgb8 a, geometry::Rgb8 b) { return {times(a.r, b.r), times(a.g, b.g), times(a.b, b.b)}; }

float area(const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return std::abs(a.x() * b.y() - a.y() * b.x()); }

/// The facet for rays that leave the scene: black, without a class.
Facet nothing() {
  Facet facet;
  facet.texture_coordinates.fill(Eigen::Vector2f::Zero());
  facet.normal.setZero();
  return facet;
}

/// The facets that the rays of a packet hit. With `kOne`, the most frequent case, all rays hit the same one, so that
/// loops over rays have nothing to gather.
template <bool kOne>
struct Met {
  std::array<const Facet*, kOne ? 1 : kSize> facets;
  const Facet& operator[](std::size_t ray) const { return *facets[kOne ? 0 : ray]; }
};

/// The pixel of a packet's first ray.
struct Corner {
  int column, row;
};

/// The factors of a packet's colours. Channels are bytes of words.
struct Look {
  Words color;
  Words light;  // 0 to 255
  MipMap::Neighbours<kSize> texture;
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
      const auto& t = facet.texture_coordinates;
      const float texels =
          area(t[1] - t[0], t[2] - t[0]) * static_cast<float>(texture(facet).width() * texture(facet).height());
      facet.texels_per_m = std::sqrt(texels / std::max(cross.norm(), 1e-12F));
    }
    return facet;
  }

  const MipMap& texture(const Facet& facet) const { return textures[static_cast<std::size_t>(facet.texture)]; }
  void store(const Corner& corner, const RayPacket& rays, const HitPacket& hits, float pixel,
             RenderedFrame& frame) const;
  template <bool kOne>
  void store(const Met<kOne>& met, const Corner& corner, const RayPacket& rays, const HitPacket& hits, float pixel,
             RenderedFrame& frame) const;
  template <bool kOne>
  Words shade(const Met<kOne>& met, const HitPacket& hits, const Floats& cosines, float pixel) const;
  template <bool kOne>
  MipMap::Neighbours<kSize> sample(const Met<kOne>& met, const HitPacket& hits, const Floats& texels_per_pixel) const;
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

/// Rays through all pixels. Their directions have z-depth 1, so that distances are z-depths; every direction is the sum
/// of a part that depends on the column and one that depends on the row.
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
  /// The rays of the packet whose first pixel has this column and row.
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
template <bool kOne>
Floats cosines_of(const Met<kOne>& met, const RayPacket& rays) {
  Floats cosines;
  for (std::size_t i = 0; i < kSize; ++i) {
    const Eigen::Vector3f& normal = met[i].normal;
    cosines[i] = normal.x() * rays.x[i] + (normal.y() * rays.y[i] + normal.z() * rays.z[i]);
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const float squares = rays.x[i] * rays.x[i] + (rays.y[i] * rays.y[i] + rays.z[i] * rays.z[i]);
    cosines[i] = std::abs(cosines[i]) / std::sqrt(squares);
  }
  return cosines;
}

/// Interpolates between the values at a triangle's corners.
float blend(const HitPacket& hits, std::size_t i, float a, float b, float c) {
  return (1.0F - hits.u[i] - hits.v[i]) * a + hits.u[i] * b + hits.v[i] * c;
}

std::uint32_t word(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  static_assert(std::endian::native == std::endian::little);  // the same order as in the words of texels
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

/// Texture times colour times light, in fixed point, so that it is the same on every machine.
Words mixed(const Look& look) {
  Words out{};
  for (unsigned shift = 0; shift < 24; shift += 8) {
    for (std::size_t i = 0; i < kSize; ++i) {
      const auto channel = [&](const Words& words) { return (words[i] >> shift) & 255U; };
      const auto& texels = look.texture.texels;
      const std::uint32_t right = look.texture.right[i], down = look.texture.down[i];
      const std::uint32_t upper = channel(texels[0]) * (256 - right) + channel(texels[1]) * right;
      const std::uint32_t lower = channel(texels[2]) * (256 - right) + channel(texels[3]) * right;
      const std::uint32_t texture = (upper * (256 - down) + lower * down + (1U << 15U)) >> 16U;
      out[i] |= scaled(scaled(channel(look.color), texture), look.light[i]) << shift;
    }
  }
  return out;
}

/// Colours of hits, without texture and light.
template <bool kOne>
Words plain_colors(const Met<kOne>& met, const HitPacket& hits) {
  Words out;
  if (const auto& [a, b, c] = met[0].colors; kOne && a == b && a == c) {
    out.fill(word(a.r, a.g, a.b));
    return out;
  }
  for (std::size_t i = 0; i < kSize; ++i) out[i] = plain_color(met[i], hits, i);
  return out;
}

/// Levels of the mip maps: the binary logarithm of texels per pixel, rounded.
Levels levels_of(const Floats& texels_per_pixel) {
  Levels levels;
  for (std::size_t i = 0; i < kSize; ++i)
    levels[i] = static_cast<int>(std::bit_cast<std::uint32_t>(texels_per_pixel[i] * 1.4142136F) >> 23U) - 127;
  return levels;
}

bool are_equal(const Levels& levels) {
  unsigned difference = 0;
  for (const int level : levels) difference |= static_cast<unsigned>(level ^ levels[0]);
  return difference == 0;
}

MipMap::Neighbours<kSize> white() {
  MipMap::Neighbours<kSize> out{};
  for (Words& texels : out.texels) texels.fill(0xFFFFFFU);
  return out;
}

}  // namespace

/// Looks up the texels; without a texture they are white.
template <bool kOne>
MipMap::Neighbours<kSize> Renderer::Implementation::sample(const Met<kOne>& met, const HitPacket& hits,
                                                           const Floats& texels_per_pixel) const {
  if (kOne && met[0].texture < 0) return white();
  const Levels levels = levels_of(texels_per_pixel);
  Floats x, y;
  for (std::size_t i = 0; i < kSize; ++i) {
    const auto& [a, b, c] = met[i].texture_coordinates;
    x[i] = blend(hits, i, a.x(), b.x(), c.x());
    y[i] = blend(hits, i, a.y(), b.y(), c.y());
  }
  const auto level = [&](const MipMap& map, std::size_t i) { return std::clamp(levels[i], 0, map.levels() - 1); };
  if (kOne && are_equal(levels)) return texture(met[0]).neighbours(level(texture(met[0]), 0), x, y);
  MipMap::Neighbours<kSize> out = white();
  for (std::size_t i = 0; i < kSize; ++i) {
    if (met[i].texture < 0) continue;
    const MipMap& map = texture(met[i]);
    const auto one = map.neighbours<1>(level(map, i), {x[i]}, {y[i]});
    for (std::size_t k = 0; k < 4; ++k) out.texels[k][i] = one.texels[k][0];
    out.right[i] = one.right[0];
    out.down[i] = one.down[0];
  }
  return out;
}

template <bool kOne>
Words Renderer::Implementation::shade(const Met<kOne>& met, const HitPacket& hits, const Floats& cosines,
                                      float pixel) const {
  Look look;
  Floats texels_per_pixel;
  for (std::size_t i = 0; i < kSize; ++i) {
    // Geometric mean of the footprint's short side and its long one, which is 1 / cosine times as long.
    texels_per_pixel[i] = met[i].texels_per_m * (hits.distance[i] * pixel) / std::sqrt(std::max(cosines[i], 0.05F));
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const auto& [a, b, c] = met[i].light;
    look.light[i] = static_cast<std::uint32_t>(static_cast<int>(blend(hits, i, a, b, c)));
  }
  look.color = plain_colors(met, hits);
  look.texture = sample(met, hits, texels_per_pixel);
  return mixed(look);
}

/// Stores the hits of a packet, for those of its pixels that are in the image.
void Renderer::Implementation::store(const Corner& corner, const RayPacket& rays, const HitPacket& hits, float pixel,
                                     RenderedFrame& frame) const {
  std::uint32_t difference = 0;
  for (const std::uint32_t triangle : hits.triangle) difference |= triangle ^ hits.triangle[0];
  const auto facet = [&](std::size_t i) { return &facets[std::min<std::size_t>(hits.triangle[i], facets.size() - 1)]; };
  if (difference == 0) return store(Met<true>{{facet(0)}}, corner, rays, hits, pixel, frame);
  Met<false> met;
  for (std::size_t i = 0; i < kSize; ++i) met.facets[i] = facet(i);
  store(met, corner, rays, hits, pixel, frame);
}

template <bool kOne>
void Renderer::Implementation::store(const Met<kOne>& met, const Corner& corner, const RayPacket& rays,
                                     const HitPacket& hits, float pixel, RenderedFrame& frame) const {
  const Floats cosines = cosines_of(met, rays);
  const bool has_color = !frame.color.empty();
  const Words colors = has_color ? shade(met, hits, cosines, pixel) : Words{};
  const int columns = std::min(kColumns, frame.depth.width - corner.column);
  const int rows = std::min(kRows, frame.depth.height - corner.row);
  for (int row = 0; row < rows; ++row) {
    const auto first = static_cast<std::size_t>(corner.row + row) * static_cast<std::size_t>(frame.depth.width) +
                       static_cast<std::size_t>(corner.column);
    for (int column = 0; column < columns; ++column) {
      const std::size_t pixel_index = first + static_cast<std::size_t>(column);
      const auto i = static_cast<std::size_t>(row * kColumns + column);
      frame.depth.pixels[pixel_index] = hits.distance[i];
      frame.labels.pixels[pixel_index] = met[i].class_id;
      frame.instances.pixels[pixel_index] = met[i].instance_id;
      frame.cosines.pixels[pixel_index] = cosines[i];
      if (has_color) frame.color.pixels[pixel_index] = pixel_of(colors[i]);
    }
  }
}

RenderedFrame Renderer::render(const geometry::PinholeCamera& camera, const geometry::Pose& T_world_camera,
                               bool with_color) const {
  const auto& self = *implementation_;
  RenderedFrame frame = empty_frame(camera.width, camera.height, with_color);
  const PixelRays rays_of(camera, T_world_camera);
  const auto pixel = static_cast<float>(1.0 / std::sqrt(camera.fx * camera.fy));  // side of a pixel at 1 m [m]
  std::atomic<int> next_row{0};
  const auto work = [&] {
    HitPacket hits;
    for (int row = next_row.fetch_add(kRows); row < camera.height; row = next_row.fetch_add(kRows)) {
      for (int column = 0; column < camera.width; column += kColumns) {
        const RayPacket rays = rays_of(column, row);
        self.raycaster.cast(rays, kFarthest_m, hits);
        self.store({column, row}, rays, hits, pixel, frame);
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
