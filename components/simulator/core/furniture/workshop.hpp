#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "simulator/core/looks/dice.hpp"
#include "simulator/core/looks/shapes.hpp"
#include "simulator/core/looks/textures.hpp"

namespace lapis::simulator {

/// Tools of the functions that make furniture (FurnitureClass::make): the size to fill, materials, and boxes.
class Workshop {
 public:
  Workshop(Mesh& mesh, const Eigen::Vector3d& size_m, std::uint64_t variant, TextureLibrary& textures)
      : w(static_cast<float>(size_m.x())), d(static_cast<float>(size_m.y())), h(static_cast<float>(size_m.z())),
        dice(Random(variant, RandomStream::kTexture, 2'000'000)), shapes(mesh), textures_(textures),
        texture_seed_(variant % 4) {}

  std::uint32_t wood();
  std::uint32_t fabric();
  /// A random plain colour.
  std::uint32_t paint() { return shapes.material("paint", to_rgb(dice.color(0.15, 0.7))); }
  std::uint32_t plain(std::uint8_t r, std::uint8_t g, std::uint8_t b) { return shapes.material("plain", {r, g, b}); }
  std::uint32_t white() { return plain(240, 240, 236); }
  std::uint32_t metal() { return plain(150, 152, 156); }
  std::uint32_t dark() { return plain(38, 38, 42); }
  std::uint32_t textured(const std::string& texture, const geometry::Rgb8& color = {255, 255, 255}) {
    return shapes.material(texture, color, textures_.surface(texture, texture_seed_));
  }
  std::uint32_t shining(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    return shapes.emissive_material("lamp", {r, g, b});
  }
  /// A picture with a random motif.
  std::uint32_t painting(double aspect);

  /// Adds a box. Limits are in metres; x and y count from the middle of the footprint, z from the lowest point.
  void box(float x0, float x1, float y0, float y1, float z0, float z1, std::uint32_t material) {
    shapes.box({x0, y0, z0}, {x1, y1, z1}, material);
  }
  void cylinder(float x, float y, float z, float radius, float top_radius, float height, std::uint32_t material,
                int sides = 12) {
    shapes.cylinder({x, y, z}, {radius, radius}, {top_radius, top_radius}, height, material, sides);
  }
  /// Adds legs in the corners of the footprint, `inset` from its border. All lengths are in metres.
  void legs(float thickness, float height, float inset, std::uint32_t material);

  const float w, d, h;  ///< width, depth and height to fill [m]
  Dice dice;
  Shapes shapes;

 private:
  static geometry::Rgb8 to_rgb(const Paint& paint);

  TextureLibrary& textures_;
  std::uint64_t texture_seed_;
};

}  // namespace lapis::simulator
