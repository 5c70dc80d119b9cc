#include "simulator/core/truth/mesh_voxels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lapis::simulator {
namespace {

/// A polygon that is convex and flat, so that a cut adds at most one corner. Rounding may bend it a little; even then,
/// a cut adds at most one corner per run of corners that it removes, and at most half as many runs as corners exist.
/// A triangle that is cut by the six planes of a voxel thus has at most 3 -> 4 -> 6 -> 9 -> 13 -> 19 -> 28 corners.
struct Polygon {
  std::array<Eigen::Vector3d, 28> corners;
  std::size_t size = 0;
};

constexpr std::size_t kMaxPieces = 50'000'000;  // about 2 GB while they are sorted

/// Area of a class in a voxel, from one or more triangles.
struct Piece {
  std::size_t cell = 0;
  std::uint16_t label = 0;
  double area = 0.0;  ///< [faces of a voxel]
};

/// The part with side * p[axis] <= side * limit [Sutherland, Hodgman, CACM 1974].
Polygon cut(const Polygon& polygon, int axis, double limit, double side) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector3d& a = polygon.corners[i];
    const Eigen::Vector3d& b = polygon.corners[i + 1 == polygon.size ? 0 : i + 1];
    const double da = side * (limit - a[axis]), db = side * (limit - b[axis]);
    if (da >= 0.0) out.corners[out.size++] = a;
    if ((da < 0.0) != (db < 0.0)) out.corners[out.size++] = a + da / (da - db) * (b - a);
  }
  return out;
}

/// Calls visit(index, part) for the layers of voxels along an axis that the polygon touches.
template <class Visit>
void for_layers(const Polygon& polygon, int axis, Visit visit) {
  double low = polygon.corners[0][axis], high = low;
  for (std::size_t i = 1; i < polygon.size; ++i) {
    low = std::min(low, polygon.corners[i][axis]);
    high = std::max(high, polygon.corners[i][axis]);
  }
  const int first = static_cast<int>(std::floor(low - kTouch)), last = static_cast<int>(std::floor(high + kTouch));
  if (first == last) return visit(first, polygon);
  for (int layer = first; layer <= last; ++layer) {
    const Polygon part = cut(cut(polygon, axis, layer + 1 + kTouch, 1.0), axis, layer - kTouch, -1.0);
    if (part.size >= 3) visit(layer, part);
  }
}

double area_of(const Polygon& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size; ++i) {
    sum += (polygon.corners[i - 1] - polygon.corners[0]).cross(polygon.corners[i] - polygon.corners[0]);
  }
  return 0.5 * sum.norm();
}

[[noreturn]] void refuse(const VoxelBox& box) {
  std::ostringstream problem;
  problem << "the scene measures " << box.size_m().transpose() << " m and has too much surface for voxels of "
          << box.resolution_m() << " m; take larger voxels, or correct its units if they are not metres";
  throw std::runtime_error(problem.str());
}

void add_pieces(const Polygon& triangle, std::uint16_t label, const VoxelBox& box, std::vector<Piece>& pieces) {
  const auto add = [&](const Eigen::Vector3i& voxel, const Polygon& part) {
    const Piece piece{box.cell(voxel), label, area_of(part)};
    const bool is_same = !pieces.empty() && pieces.back().cell == piece.cell && pieces.back().label == label;
    if (is_same) {
      pieces.back().area += piece.area;  // merged, because small triangles of one thing often follow each other
    } else {
      if (pieces.size() == kMaxPieces) refuse(box);
      pieces.push_back(piece);
    }
  };
  for_layers(triangle, 2, [&](int z, const Polygon& layer) {
    for_layers(layer, 1, [&](int y, const Polygon& column) {
      for_layers(column, 0, [&](int x, const Polygon& part) { add({x, y, z}, part); });
    });
  });
}

/// Adds the voxel of pieces[begin..end), which are of one cell and sorted by label, if its surface is large enough.
void add_voxel(const std::vector<Piece>& pieces, std::size_t begin, std::size_t end, std::vector<SurfaceVoxel>& out) {
  double total = 0.0, best = 0.0, area = 0.0;
  SurfaceVoxel voxel{pieces[begin].cell, 0};
  for (std::size_t i = begin; i < end; ++i) {
    total += pieces[i].area;
    area = i > begin && pieces[i].label == pieces[i - 1].label ? area + pieces[i].area : pieces[i].area;
    if (pieces[i].label == 0 || area <= best) continue;
    best = area;
    voxel.label = pieces[i].label;
  }
  if (total >= kLeastArea) out.push_back(voxel);
}

}  // namespace

VoxelBox voxel_box(const Scene& scene, const geometry::Pose& T_map_world, double resolution_m,
                   const std::vector<Eigen::Vector3d>& eyes) {
  Eigen::AlignedBox3d box;
  for (const auto& p : eyes) box.extend(T_map_world * p);
  for (const auto& p : scene.mesh.positions) box.extend(T_map_world * p.cast<double>());
  return {box, resolution_m};
}

std::vector<SurfaceVoxel> surface_voxels(const Scene& scene, const geometry::Pose& T_map_world, const VoxelBox& box) {
  const Mesh& mesh = scene.mesh;
  std::vector<Eigen::Vector3d> positions;
  for (const auto& p : mesh.positions) positions.push_back(box.to_box(T_map_world * p.cast<double>()));
  std::vector<Piece> pieces;
  for (const auto& triangle : mesh.triangles) {
    Polygon polygon;
    polygon.size = 3;
    for (std::size_t i = 0; i < 3; ++i) polygon.corners[i] = positions[triangle.vertices[i]];
    add_pieces(polygon, scene.instances[triangle.part].class_id, box, pieces);
  }
  // The sort is stable, so that areas are summed in the order of the triangles.
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.label < b.label;
  });
  std::vector<SurfaceVoxel> out;
  for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
    while (end < pieces.size() && pieces[end].cell == pieces[begin].cell) ++end;
    add_voxel(pieces, begin, end, out);
  }
  return out;
}

}  // namespace lapis::simulator
