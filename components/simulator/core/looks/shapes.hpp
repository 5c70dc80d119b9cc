#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A flat piece of surface that is cut into cells, so that it can carry light: points are origin + a * u + b * v [m],
/// with unit vectors u and v; it is visible from the side to which u x v points.
struct Sheet {
  Eigen::Vector3f origin, u, v;
  double texture_period_m = 1.0;                             ///< length that one copy of the texture covers
  Eigen::Vector2f texture_offset = Eigen::Vector2f::Zero();  ///< in periods
};

/// Adds simple shapes to a mesh. Coordinates [m] are in the shape's frame, which T_mesh_shape maps to the mesh. The
/// triangles belong to `part`.
class Shapes {
 public:
  explicit Shapes(Mesh& mesh) : mesh_(mesh) {}

  Eigen::Affine3f T_mesh_shape = Eigen::Affine3f::Identity();
  std::uint32_t part = 0;
  /// Textures of boxes, cylinders and balls repeat after this length. [m]
  float texture_period_m = 0.8F;
  /// Sides of boxes are cut into cells of at most this length, so that they can carry light. [m]
  float cell_m = 0.5F;

  std::uint32_t material(const std::string& name, const geometry::Rgb8& color,
                         std::shared_ptr<const TextureImage> texture = nullptr);
  std::uint32_t emissive_material(const std::string& name, const geometry::Rgb8& color,
                                  std::shared_ptr<const TextureImage> texture = nullptr);
  /// A material that neither colour nor depth shows.
  std::uint32_t glass(const std::string& name);

  void box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint32_t material);
  /// A box with any corners: first those of the bottom (counter-clockwise as seen from above), then those of the top.
  void block(const std::array<Eigen::Vector3f, 8>& corners, std::uint32_t material);
  /// An upright cylinder or frustum with closed ends; radii are along x and y.
  void cylinder(const Eigen::Vector3f& foot, const Eigen::Vector2f& radius, const Eigen::Vector2f& top_radius,
                float height, std::uint32_t material, int sides = 12);
  void ball(const Eigen::Vector3f& center, const Eigen::Vector3f& radius, std::uint32_t material, int sides = 10);
  /// One rectangle that shows the whole texture: from `corner` along `across` and `up`; it is visible from the side to
  /// which across x up points.
  void picture(const Eigen::Vector3f& corner, const Eigen::Vector3f& across, const Eigen::Vector3f& up,
               std::uint32_t material);
  /// The cells between neighbouring lines for which keeps(cell) is true. Neighbouring cells share vertices.
  void sheet(const Sheet& sheet, const std::vector<double>& lines_u, const std::vector<double>& lines_v,
             const std::function<bool(const Eigen::AlignedBox2d&)>& keeps, std::uint32_t material);
  /// A convex piece of a sheet; corners counter-clockwise.
  void sheet_piece(const Sheet& sheet, const std::vector<Eigen::Vector2d>& corners, std::uint32_t material);

 private:
  std::uint32_t vertex(const Eigen::Vector3f& position, const Eigen::Vector2f& texture_coordinate);
  std::uint32_t vertex(const Sheet& sheet, const Eigen::Vector2d& position);
  void face(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, const Eigen::Vector3f& d,
            std::uint32_t material);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);

  Mesh& mesh_;
};

/// `values` [m], sorted, without those that are nearer than 1 mm to another one, and with others between them, so that
/// neighbours are at most `max_step` apart.
std::vector<double> grid_lines(std::vector<double> values, double max_step);

}  // namespace lapis::simulator
