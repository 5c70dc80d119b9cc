#include "simulator/core/looks/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lapis::simulator {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

Eigen::Vector2f on_circle(int step, int steps) {
  const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(step) / static_cast<float>(steps);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

std::uint32_t Shapes::material(const std::string& name, const geometry::Rgb8& color,
                               std::shared_ptr<const TextureImage> texture) {
  Material result;
  result.name = name;
  result.color = color;
  return add_material(mesh_, std::move(result), std::move(texture));
}

std::uint32_t Shapes::emissive_material(const std::string& name, const geometry::Rgb8& color,
                                        std::shared_ptr<const TextureImage> texture) {
  const std::uint32_t index = material(name, color, std::move(texture));
  mesh_.materials[index].is_emissive = true;
  return index;
}

std::uint32_t Shapes::glass(const std::string& name) {
  TextureImage hole(1, 1);
  hole(0, 0).a = 0;
  const std::uint32_t index = material(name, {255, 255, 255}, std::make_shared<const TextureImage>(std::move(hole)));
  mesh_.materials[index].is_cut_out = true;
  return index;
}

std::uint32_t Shapes::vertex(const Eigen::Vector3f& position, const Eigen::Vector2f& texture_coordinate) {
  mesh_.positions.emplace_back(T_mesh_shape * position);
  mesh_.texture_coordinates.push_back(texture_coordinate);
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

std::uint32_t Shapes::vertex(const Sheet& sheet, const Eigen::Vector2d& position) {
  const Eigen::Vector2f p = position.cast<float>();
  const Eigen::Vector2f uv = (position / sheet.texture_period_m).cast<float>() + sheet.texture_offset;
  return vertex(sheet.origin + p.x() * sheet.u + p.y() * sheet.v, uv);
}

void Shapes::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
  mesh_.triangles.push_back({{a, b, c}, material, part});
}

void Shapes::face(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                  const Eigen::Vector3f& d, std::uint32_t material) {
  const float width = (b - a).norm(), height = (d - a).norm();
  const auto cells = [&](float length) { return std::clamp(static_cast<int>(std::ceil(length / cell_m)), 1, 64); };
  const int columns = cells(width), rows = cells(height);
  // The point of the texture where a face begins depends on the face's position, so that faces differ.
  const Eigen::Vector2f start(0.37F * (a.x() + a.y()) + 0.11F * a.z(), 0.53F * a.z() + 0.29F * (a.x() - a.y()));
  std::vector<std::uint32_t> vertices;
  for (int row = 0; row <= rows; ++row) {
    const float t = static_cast<float>(row) / static_cast<float>(rows);
    for (int column = 0; column <= columns; ++column) {
      const float s = static_cast<float>(column) / static_cast<float>(columns);
      const Eigen::Vector3f position = (1.0F - t) * ((1.0F - s) * a + s * b) + t * ((1.0F - s) * d + s * c);
      vertices.push_back(vertex(position, start + Eigen::Vector2f(s * width, t * height) / texture_period_m));
    }
  }
  const auto at = [&](int column, int row) {
    const int index = row * (columns + 1) + column;
    return vertices[static_cast<std::size_t>(index)];
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      triangle(at(column, row), at(column + 1, row), at(column + 1, row + 1), material);
      triangle(at(column, row), at(column + 1, row + 1), at(column, row + 1), material);
    }
  }
}

void Shapes::box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint32_t material) {
  const auto corner = [&](bool x, bool y, bool z) {
    return Eigen::Vector3f(x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z());
  };
  block({corner(false, false, false), corner(true, false, false), corner(true, true, false), corner(false, true, false),
         corner(false, false, true), corner(true, false, true), corner(true, true, true), corner(false, true, true)},
        material);
}

void Shapes::block(const std::array<Eigen::Vector3f, 8>& corners, std::uint32_t material) {
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  for (const auto& f : kFaces) face(corners[f[0]], corners[f[1]], corners[f[2]], corners[f[3]], material);
}

void Shapes::cylinder(const Eigen::Vector3f& foot, const Eigen::Vector2f& radius, const Eigen::Vector2f& top_radius,
                      float height, std::uint32_t material, int sides) {
  const Eigen::Vector3f head = foot + height * Eigen::Vector3f::UnitZ();
  const auto rim = [&](const Eigen::Vector3f& center, const Eigen::Vector2f& r, int step) -> Eigen::Vector3f {
    const Eigen::Vector2f unit = on_circle(step, sides);
    return center + Eigen::Vector3f(r.x() * unit.x(), r.y() * unit.y(), 0.0F);
  };
  const std::uint32_t bottom = vertex(foot, {0.0F, 0.0F}), top = vertex(head, {0.0F, 0.0F});
  const float around = 2.0F * std::numbers::pi_v<float> * radius.maxCoeff() / texture_period_m;
  std::array<std::uint32_t, 2> last{};
  for (int i = 0; i <= sides; ++i) {
    const float u = around * static_cast<float>(i) / static_cast<float>(sides);
    const std::array<std::uint32_t, 2> now{vertex(rim(foot, radius, i), {u, 0.0F}),
                                           vertex(rim(head, top_radius, i), {u, height / texture_period_m})};
    if (i > 0) {
      triangle(last[0], now[0], now[1], material);
      triangle(last[0], now[1], last[1], material);
      triangle(bottom, now[0], last[0], material);
      triangle(top, last[1], now[1], material);
    }
    last = now;
  }
}

void Shapes::ball(const Eigen::Vector3f& center, const Eigen::Vector3f& radius, std::uint32_t material, int sides) {
  const int rings = sides / 2;
  std::vector<std::uint32_t> vertices;
  for (int ring = 0; ring <= rings; ++ring) {
    const Eigen::Vector2f height = on_circle(2 * ring - rings, 4 * rings);  // cosine and sine of the latitude
    for (int i = 0; i <= sides; ++i) {
      const Eigen::Vector2f unit = on_circle(i, sides) * height.x();
      const Eigen::Vector3f p = center + radius.cwiseProduct(Eigen::Vector3f(unit.x(), unit.y(), height.y()));
      vertices.push_back(vertex(p, {static_cast<float>(i) / static_cast<float>(sides),
                                    static_cast<float>(ring) / static_cast<float>(rings)}));
    }
  }
  const auto at = [&](int ring, int i) {
    const int index = ring * (sides + 1) + i;
    return vertices[static_cast<std::size_t>(index)];
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < sides; ++i) {
      if (ring > 0) triangle(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), material);
      if (ring + 1 < rings) triangle(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i), material);
    }
  }
}

void Shapes::picture(const Eigen::Vector3f& corner, const Eigen::Vector3f& across, const Eigen::Vector3f& up,
                     std::uint32_t material) {
  const std::uint32_t a = vertex(corner, {0.0F, 0.0F}), b = vertex(corner + across, {1.0F, 0.0F});
  const std::uint32_t c = vertex(corner + across + up, {1.0F, 1.0F}), d = vertex(corner + up, {0.0F, 1.0F});
  triangle(a, b, c, material);
  triangle(a, c, d, material);
}

void Shapes::sheet(const Sheet& sheet, const std::vector<double>& lines_u, const std::vector<double>& lines_v,
                   const std::function<bool(const Eigen::AlignedBox2d&)>& keeps, std::uint32_t material) {
  std::vector<std::uint32_t> vertices(lines_u.size() * lines_v.size(), kNone);
  const auto at = [&](std::size_t i, std::size_t j) {
    std::uint32_t& index = vertices[j * lines_u.size() + i];
    if (index == kNone) index = vertex(sheet, {lines_u[i], lines_v[j]});
    return index;
  };
  for (std::size_t j = 0; j + 1 < lines_v.size(); ++j) {
    for (std::size_t i = 0; i + 1 < lines_u.size(); ++i) {
      const Eigen::Vector2d low(lines_u[i], lines_v[j]), high(lines_u[i + 1], lines_v[j + 1]);
      if (!keeps({low, high})) continue;
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      triangle(a, b, c, material);
      triangle(a, c, d, material);
    }
  }
}

void Shapes::sheet_piece(const Sheet& sheet, const std::vector<Eigen::Vector2d>& corners, std::uint32_t material) {
  std::vector<std::uint32_t> vertices;
  for (const auto& corner : corners) vertices.push_back(vertex(sheet, corner));
  for (std::size_t i = 2; i < vertices.size(); ++i) triangle(vertices[0], vertices[i - 1], vertices[i], material);
}

std::vector<double> grid_lines(std::vector<double> values, double max_step) {
  constexpr double kSame_m = 1e-3;
  std::sort(values.begin(), values.end());
  const auto is_same = [](double a, double b) { return b - a < kSame_m; };
  values.erase(std::unique(values.begin(), values.end(), is_same), values.end());
  std::vector<double> lines;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    const int steps = std::max(1, static_cast<int>(std::ceil((values[i + 1] - values[i]) / max_step - 1e-9)));
    for (int k = 0; k < steps; ++k) lines.push_back(values[i] + (values[i + 1] - values[i]) * k / steps);
  }
  if (!values.empty()) lines.push_back(values.back());
  return lines;
}

}  // namespace lapis::simulator
