#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "controller/core/planar.hpp"
#include "controller/core/rolling_columns.hpp"

namespace lapis::controller {

struct LocalMapConfig {
  double range_m = 4.0;       ///< largest depth that is used; points are kept up to 1 m farther
  double min_height_m = 0.1;  ///< above base_link; lower points can be driven over
  double max_height_m = 1.2;  ///< above base_link; the robot passes under higher points
  double memory_s = 60.0;     ///< points that were last seen longer ago are forgotten
  int stride = 4;             ///< every stride-th pixel of every stride-th row is used
  int misses_to_clear = 3;    ///< images that must see through a point before it is removed
};

/// A depth image and the mounting of its camera.
struct DepthView {
  geometry::DepthImage depth;
  geometry::PinholeCamera camera;
  geometry::Pose T_base_camera;
};

/// Occupancy grid in the map frame. Cell (column, row) covers [origin.x + column * resolution, + resolution) in x, and
/// likewise in y.
struct Grid {
  double resolution_m = 0.0;
  Eigen::Vector2d origin{0.0, 0.0};
  int width = 0;                   ///< columns, along x
  int height = 0;                  ///< rows, along y
  std::vector<std::int8_t> cells;  ///< row by row: 100 occupied, 0 free, -1 unknown

  static constexpr std::int8_t kOccupiedFrom = 50, kUnknown = -1;
  /// Value at a point; kUnknown outside the grid.
  std::int8_t at(const Eigen::Vector2d& p_map) const;
};

/// Points in base_link.
struct Surroundings {
  /// Points seen by the camera, and the centres of occupied grid cells that no such point explains.
  std::vector<Eigen::Vector2d> obstacles;
  /// Points where unseen parts of obstacles may be: around columns of which only the upper part was seen, because an
  /// obstacle that leans or spreads below the image is wider at the floor.
  std::vector<Eigen::Vector2d> unseen_feet;
};

/// Obstacles around the robot: points of the camera's own images, which are finer and newer than any map and are
/// remembered for a while because the camera does not see the area at the robot's feet; and, in addition, the mapper's
/// grids.
class LocalMap {
 public:
  explicit LocalMap(const LocalMapConfig& config);

  /// Adds a depth image.
  /// @param has_path a robot that stands without a path forgets nothing, because obstacles below its image are still
  /// there when it gets the next path. With a path, an obstacle that it waits for may have left unseen.
  void add(const DepthView& view, const PlanarPose& T_map_base, time::Time stamp, bool has_path);
  /// Set the mapper's floor plan, and its grid of recent obstacles, which overrules the floor plan in its known cells.
  void set_plan(Grid grid) { plan_ = std::move(grid); }
  void set_obstacles(Grid grid) { obstacles_ = std::move(grid); }
  /// The map frame has jumped: moves the remembered points, which keep their places relative to the robot.
  void move_points(const PlanarPose& T_new_old);

  /// Obstacles within a distance of the robot.
  Surroundings near(const PlanarPose& T_map_base, double distance_m) const;
  /// True when the mapper's grids show this point to be free; the camera's points are not considered.
  bool is_known_free(const Eigen::Vector2d& p_map) const;

 private:
  struct Look {
    PlanarPose T_map_base;
    time::Time stamp;
  };
  /// Points above one cell of the floor plane.
  struct Column {
    Eigen::Vector2d p_map;
    double lowest_m;  ///< above base_link [m]
  };

  void pass_time(const PlanarPose& T_map_base, time::Time stamp, bool has_path);
  void forget(const PlanarPose& T_map_base);
  void look_through(const DepthView& view, const PlanarPose& T_map_base);
  void add_hits(const DepthView& view, const PlanarPose& T_map_base);
  double kept_m() const { return config_.range_m + 1.0; }
  std::vector<Column> columns_near(const Eigen::Vector2d& p_map, double distance_m) const;
  void add_unseen_feet(const Column& column, const std::vector<Column>& columns, const PlanarPose& T_base_map,
                       std::vector<Eigen::Vector2d>& points) const;
  void add_occupied(const Grid& grid, const PlanarPose& T_map_base, double distance_m,
                    const std::vector<Column>& columns, std::vector<Eigen::Vector2d>& points) const;

  LocalMapConfig config_;
  RollingColumns points_;
  std::optional<Look> last_;
  double time_s_ = 0.0;  // time that counts for the memory so far
  Grid plan_;
  Grid obstacles_;
};

}  // namespace lapis::controller
