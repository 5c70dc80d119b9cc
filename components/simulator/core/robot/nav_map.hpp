#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/grid.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

struct NavMapConfig {
  double resolution_m = 0.025;
  double low_m = 0.05;  ///< above the floor; the robot drives over what is lower
  double high_m = 1.2;  ///< above the floor; the robot passes under what is higher
};

/// Map of where a robot may be: blocked cells, and the distance to them. Points are in the world frame, without z.
class NavMap {
 public:
  /// @param blocked one pixel per cell, not 0 where a robot cannot be; the cells of the border are always blocked.
  NavMap(const Grid& grid, geometry::GrayImage blocked);

  const Grid& grid() const { return grid_; }
  bool is_blocked(Cell c) const { return blocked_(c.column, c.row) != 0; }
  /// Signed distance of a cell's centre [m]; see distance_m.
  double distance_at(Cell c) const { return static_cast<double>(distance_(c.column, c.row)); }
  /// Distance from the edge of the nearest blocked cell [m], which is taken to be half a cell before that cell's
  /// centre; negative in blocked cells. It is bilinear between the centres of cells; a point outside the grid has the
  /// distance of the grid's nearest point.
  double distance_m(const Eigen::Vector2d& p) const;
  /// Derivative of distance_m: it points away from the nearest obstacle, and its length is about 1.
  Eigen::Vector2d gradient(const Eigen::Vector2d& p) const;

  /// 255 where the centre of a disc of this radius may be, else 0.
  geometry::GrayImage free_cells(double radius_m) const;
  /// 255 where the centre of a disc of this radius can move from `start`, else 0; all 0 when it does not fit there.
  geometry::GrayImage reachable(const Eigen::Vector2d& start, double radius_m) const;

 private:
  struct Corners {
    double d00, d10, d01, d11;  ///< distances at the four centres around a point, first index x
    double u, v;                ///< position between them, 0 to 1
  };
  Corners corners(const Eigen::Vector2d& p) const;

  Grid grid_;
  geometry::GrayImage blocked_;
  geometry::Image<float> distance_;
};

/// True for parts (Triangle::part) that are obstacles; other parts still count as floor.
using IsSolid = std::function<bool(std::uint32_t part)>;

/// A cell is blocked when a triangle passes through it between floor + low and floor + high, or when it has no floor:
/// no triangle that is level within 45 degrees between floor - 0.1 m and floor + 0.05 m. So the robot cannot leave the
/// building. The inside of things that are higher than the slab (cupboards, walls) counts as free, although no robot
/// gets there: use reachable(). The map ends two cells beyond the floor. The mesh must be sound (problem_of).
/// @throws std::runtime_error when there is no floor at this height or it is too large for a map (4e7 cells).
NavMap build_nav_map(const Mesh& mesh, double floor_z_m, const NavMapConfig& config, const IsSolid& is_solid);

/// The map of a scene. Instances of `passable_classes` (closed doors, for example) are no obstacles.
NavMap build_nav_map(const Scene& scene, const NavMapConfig& config = {},
                     const std::vector<std::uint16_t>& passable_classes = {});

}  // namespace lapis::simulator
