#include "simulator/core/building/structure.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kCell_m = 0.2;
constexpr float kFrameWidth_m = 0.07F, kFrameDepth_m = 0.015F;
constexpr float kSkirtingHeight_m = 0.08F, kSkirtingDepth_m = 0.012F;
constexpr geometry::Rgb8 kFrameColor{226, 220, 208};

using Vector = Eigen::Vector3f;

/// The surfaces of one room.
class RoomBuilder {
 public:
  RoomBuilder(Scene& scene, const SceneSpec& spec, std::size_t room, const RoomPlan& plan, TextureLibrary& textures,
              std::vector<std::uint32_t>& opening_parts)
      : scene_(scene), spec_(spec), room_(spec.rooms[room]), plan_(plan), number_(room), textures_(textures),
        opening_parts_(opening_parts), shapes_(scene.mesh) {}

  void build() {
    shapes_.cell_m = static_cast<float>(2 * kCell_m);
    build_floor_and_ceiling();
    const std::uint32_t wall_material = surface(room_.wall), floor_material = surface(room_.floor);
    frame_material_ = shapes_.material("frame", kFrameColor);
    for (std::size_t i = 0; i < plan_.walls.size(); ++i) {
      const Wall& wall = plan_.walls[i];
      shapes_.T_mesh_shape = wall.T_world_wall();
      const std::uint32_t part = add_instance(scene_, "wall", room_.id + "/wall " + std::to_string(i));
      shapes_.part = part;
      build_wall(wall, i, wall_material);
      build_skirting(wall);
      for (const WallOpening& opening : wall.openings) build_opening(opening, part, wall_material, floor_material);
    }
  }

 private:
  std::uint32_t surface(const SurfaceSpec& spec) {
    return shapes_.material(spec.texture, spec.color, textures_.surface(spec.texture, variant_of(spec)));
  }

  std::uint64_t variant_of(const SurfaceSpec& spec) const { return spec.variant.value_or(number_); }

  void build_floor_and_ceiling() {
    const std::uint32_t floor = surface(room_.floor), ceiling = surface(room_.ceiling);
    floor_part_ = add_instance(scene_, "floor", room_.id + "/floor");
    shapes_.part = floor_part_;
    const Sheet ground{Vector::Zero(), Vector::UnitX(), Vector::UnitY(), texture_period_m(room_.floor.texture)};
    build_area(ground, room_.polygon, floor);
    shapes_.part = add_instance(scene_, "ceiling", room_.id + "/ceiling");
    const Vector top(0.0F, 0.0F, static_cast<float>(plan_.height_m));
    const Sheet roof{top, Vector::UnitY(), Vector::UnitX(), texture_period_m(room_.ceiling.texture)};
    Polygon mirrored;
    for (const auto& corner : room_.polygon) mirrored.emplace_back(corner.y(), corner.x());
    std::reverse(mirrored.begin(), mirrored.end());
    build_area(roof, mirrored, ceiling);
  }

  /// Adds a polygon: as cells where it covers them completely, and as pieces along slanting borders.
  void build_area(const Sheet& sheet, const Polygon& polygon, std::uint32_t material) {
    std::vector<double> us, vs;
    for (const auto& corner : polygon) {
      us.push_back(corner.x());
      vs.push_back(corner.y());
    }
    const auto triangles = triangulate(polygon);
    std::vector<Polygon> pieces;
    const auto is_covered = [&](const Eigen::AlignedBox2d& cell) {
      const Polygon window = rectangle(cell.center(), cell.sizes(), 0.0);
      std::vector<Polygon> covered;
      double area = 0.0;
      for (const auto& t : triangles) {
        covered.push_back(clip({polygon[t[0]], polygon[t[1]], polygon[t[2]]}, window));
        area += signed_area(covered.back());
      }
      if (area > (1.0 - 1e-6) * cell.volume()) return true;
      std::copy_if(covered.begin(), covered.end(), std::back_inserter(pieces),
                   [](const Polygon& piece) { return signed_area(piece) > 1e-8; });
      return false;
    };
    shapes_.sheet(sheet, grid_lines(us, kCell_m), grid_lines(vs, kCell_m), is_covered, material);
    for (const Polygon& piece : pieces) shapes_.sheet_piece(sheet, piece, material);
  }

  void build_wall(const Wall& wall, std::size_t index, std::uint32_t material) {
    // A sheet is visible from the side of u x v, here the inside; so u runs from the wall's last corner to its first.
    Sheet sheet{{static_cast<float>(wall.length_m), 0.0F, 0.0F},
                -Vector::UnitX(),
                Vector::UnitZ(),
                texture_period_m(room_.wall.texture)};
    sheet.texture_offset.x() =
        static_cast<float>(Random(variant_of(room_.wall), RandomStream::kTexture, index).uniform(0));
    std::vector<double> us{0.0, wall.length_m}, vs{0.0, plan_.height_m};
    std::vector<Eigen::AlignedBox2d> holes;
    for (const WallOpening& opening : wall.openings) {
      holes.emplace_back(Eigen::Vector2d(wall.length_m - opening.to_m, opening.bottom_m),
                         Eigen::Vector2d(wall.length_m - opening.from_m, opening.top_m));
      us.insert(us.end(), {holes.back().min().x(), holes.back().max().x()});
      vs.insert(vs.end(), {holes.back().min().y(), holes.back().max().y()});
    }
    const auto is_solid = [&](const Eigen::AlignedBox2d& cell) {
      return std::none_of(holes.begin(), holes.end(),
                          [&](const Eigen::AlignedBox2d& hole) { return hole.contains(cell.center().eval()); });
    };
    shapes_.sheet(sheet, grid_lines(us, kCell_m), grid_lines(vs, kCell_m), is_solid, material);
  }

  /// Adds a rectangle of cells with the sides a and b from `corner`; it is visible from the side of a x b.
  void panel(const Vector& corner, const Vector& a, const Vector& b, std::uint32_t material, double period_m = 1.0) {
    const Sheet sheet{corner, a.normalized(), b.normalized(), period_m};
    shapes_.sheet(
        sheet, grid_lines({0.0, a.norm()}, 2 * kCell_m), grid_lines({0.0, b.norm()}, 2 * kCell_m),
        [](const Eigen::AlignedBox2d&) { return true; }, material);
  }

  void build_skirting(const Wall& wall) {
    float from = 0.0F;
    const auto board = [&](float to) {
      if (to - from < 0.01F) return;
      panel({to, kSkirtingDepth_m, 0.0F}, {from - to, 0.0F, 0.0F}, {0.0F, 0.0F, kSkirtingHeight_m}, frame_material_);
      panel({to, kSkirtingDepth_m, kSkirtingHeight_m}, {from - to, 0.0F, 0.0F}, {0.0F, -kSkirtingDepth_m, 0.0F},
            frame_material_);
    };
    for (const WallOpening& opening : wall.openings) {
      if (opening.bottom_m > kSkirtingHeight_m) continue;
      const bool has_frame = spec_.openings[opening.opening].kind != OpeningKind::kPassage;
      const float margin = has_frame ? kFrameWidth_m : 0.0F;
      board(static_cast<float>(opening.from_m) - margin);
      from = static_cast<float>(opening.to_m) + margin;
    }
    board(static_cast<float>(wall.length_m));
  }

  /// The part of a door or window, which the rooms on both sides share.
  std::uint32_t opening_part(std::size_t opening, bool is_window) {
    std::uint32_t& part = opening_parts_[opening];
    if (part == std::numeric_limits<std::uint32_t>::max()) {
      part = add_instance(scene_, is_window ? "window" : "door", numbered(is_window ? "window" : "door", opening));
    }
    return part;
  }

  void build_opening(const WallOpening& opening, std::uint32_t wall_part, std::uint32_t wall_material,
                     std::uint32_t floor_material) {
    const OpeningKind kind = spec_.openings[opening.opening].kind;
    shapes_.part = wall_part;
    if (kind == OpeningKind::kPassage) {
      jambs(opening, wall_material, texture_period_m(room_.wall.texture));
    } else {
      const bool is_window = kind == OpeningKind::kWindow;
      shapes_.part = opening_part(opening.opening, is_window);
      jambs(opening, frame_material_, 1.0);
      frame(opening);
      if (is_window) pane(opening);
      if (kind == OpeningKind::kLeaf) leaf(opening);
    }
    shapes_.part = floor_part_;
    if (opening.bottom_m <= 0.0 && opening.depth_m > 1e-3) {  // threshold
      const Vector corner(static_cast<float>(opening.from_m), -static_cast<float>(opening.depth_m), 0.0F);
      panel(corner, width(opening) * Vector::UnitX(), static_cast<float>(opening.depth_m) * Vector::UnitY(),
            floor_material, texture_period_m(room_.floor.texture));
    }
  }

  static float width(const WallOpening& opening) { return static_cast<float>(opening.to_m - opening.from_m); }
  static float height(const WallOpening& opening) { return static_cast<float>(opening.top_m - opening.bottom_m); }

  /// Adds the sides of a hole through the wall, its top, and its bottom when that is above the floor.
  void jambs(const WallOpening& opening, std::uint32_t material, double period_m) {
    if (opening.depth_m < 1e-3) return;
    const auto x0 = static_cast<float>(opening.from_m), x1 = static_cast<float>(opening.to_m);
    const auto z0 = static_cast<float>(opening.bottom_m), z1 = static_cast<float>(opening.top_m);
    const Vector inward(0.0F, static_cast<float>(opening.depth_m), 0.0F), up(0.0F, 0.0F, z1 - z0), right(x1 - x0, 0, 0);
    panel(Vector(x0, 0, z0) - inward, inward, up, material, period_m);
    panel({x1, 0, z0}, -inward, up, material, period_m);
    panel({x0, 0, z1}, -inward, right, material, period_m);
    if (opening.bottom_m > 0.0) panel(Vector(x0, 0, z0) - inward, right, inward, material, period_m);
  }

  /// Adds boards around the opening on the room's side, and a sill below a window.
  void frame(const WallOpening& opening) {
    const auto x0 = static_cast<float>(opening.from_m), x1 = static_cast<float>(opening.to_m);
    const auto z0 = static_cast<float>(opening.bottom_m), z1 = static_cast<float>(opening.top_m);
    const float t = kFrameWidth_m, y = kFrameDepth_m;
    const float top = std::min(z1 + t, static_cast<float>(plan_.height_m));
    shapes_.box({x0 - t, 0, z0}, {x0, y, top}, frame_material_);
    shapes_.box({x1, 0, z0}, {x1 + t, y, top}, frame_material_);
    shapes_.box({x0, 0, z1}, {x1, y, top}, frame_material_);
    if (z0 > 0.0F) shapes_.box({x0 - t, 0, z0 - 0.03F}, {x1 + t, 0.06F, z0}, frame_material_);
  }

  /// Adds a bright view with bars in front of it, near the far end of the hole.
  void pane(const WallOpening& opening) {
    const auto x0 = static_cast<float>(opening.from_m), x1 = static_cast<float>(opening.to_m);
    const auto z0 = static_cast<float>(opening.bottom_m), z1 = static_cast<float>(opening.top_m);
    const float y = -0.8F * static_cast<float>(opening.depth_m), bar = 0.04F;
    const auto view = textures_.surface("outdoor", opening.opening);
    shapes_.picture({x1, y, z0}, {x0 - x1, 0, 0}, {0, 0, z1 - z0},
                    shapes_.emissive_material("pane", {255, 255, 255}, view));
    const int bars = std::max(1, static_cast<int>(width(opening) / 0.7F));
    for (int i = 0; i <= bars; ++i) {
      const float x = x0 + (width(opening) - bar) * static_cast<float>(i) / static_cast<float>(bars);
      shapes_.box({x, y, z0}, {x + bar, y + bar, z1}, frame_material_);
    }
    for (const float z : {z0, z1 - bar}) shapes_.box({x0, y, z}, {x1, y + bar, z + bar}, frame_material_);
  }

  /// Adds a closed door with two panels and a handle.
  void leaf(const WallOpening& opening) {
    const auto x0 = static_cast<float>(opening.from_m), x1 = static_cast<float>(opening.to_m);
    const auto z0 = static_cast<float>(opening.bottom_m), z1 = static_cast<float>(opening.top_m);
    const float y = -std::min(0.05F, 0.5F * static_cast<float>(opening.depth_m)), h = height(opening);
    const auto wood = shapes_.material("leaf", {206, 172, 134}, textures_.surface("wood", opening.opening % 4));
    panel({x1, y, z0}, {x0 - x1, 0, 0}, {0, 0, z1 - z0}, wood);
    const float inset = 0.15F * width(opening);
    shapes_.box({x0 + inset, y, z0 + 0.08F * h}, {x1 - inset, y + 0.012F, z0 + 0.42F * h}, wood);
    shapes_.box({x0 + inset, y, z0 + 0.54F * h}, {x1 - inset, y + 0.012F, z0 + 0.93F * h}, wood);
    const auto steel = shapes_.material("handle", {150, 152, 156});
    shapes_.box({x0 + 0.05F, y, z0 + 0.49F * h}, {x0 + 0.17F, y + 0.05F, z0 + 0.505F * h}, steel);
  }

  Scene& scene_;
  const SceneSpec& spec_;
  const RoomSpec& room_;
  const RoomPlan& plan_;
  std::uint64_t number_;
  TextureLibrary& textures_;
  std::vector<std::uint32_t>& opening_parts_;
  Shapes shapes_;
  std::uint32_t floor_part_ = 0, frame_material_ = 0;
};

}  // namespace

std::uint32_t add_instance(Scene& scene, const std::string& class_name, const std::string& name) {
  const std::size_t index = scene.instances.size();
  if (index >= std::numeric_limits<std::uint16_t>::max())
    throw std::runtime_error("scene " + scene.name + ": has more than 65535 walls and things; make it smaller");
  if (scene.mesh.triangles.size() > kMaxTriangles)
    throw std::runtime_error("scene " + scene.name + ": has more than 20 million triangles; make it smaller");
  scene.instances.push_back({static_cast<std::uint16_t>(index + 1), scene.labels.id_of(class_name).value_or(0), name});
  return static_cast<std::uint32_t>(index);
}

void add_structure(Scene& scene, const SceneSpec& spec, const std::vector<RoomPlan>& plan, TextureLibrary& textures) {
  std::vector<std::uint32_t> opening_parts(spec.openings.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t room = 0; room < plan.size(); ++room)
    RoomBuilder(scene, spec, room, plan[room], textures, opening_parts).build();
}

}  // namespace lapis::simulator
