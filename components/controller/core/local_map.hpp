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
  double range_m = 4.0;       ///< of depth, and of what is kept around the robot
  double min_height_m = 0.1;  ///< above base_link: what is lower can be driven over
  double max_height_m = 1.2;  ///< what is higher is passed under
  double memory_s = 60.0;     ///< what was seen longer ago is forgotten
  int stride = 4;             ///< every stride-th pixel of every stride-th row is used
  int misses_to_clear = 3;    ///< images that must look through an obstacle before it is gone
};

/// A depth image and where its camera sits on the robot.
struct DepthView {
  geometry::DepthImage depth;
  geometry::PinholeCamera camera;
  geometry::Pose T_base_camera;
};

/// Plan in the map frame. Cell (column, row) covers [origin + column * resolution, + resolution) and so on.
struct Grid {
  double resolution_m = 0.0;
  Eigen::Vector2d origin{0.0, 0.0};
  int width = 0;                   ///< columns, along x
  int height = 0;                  ///< rows, along y
  std::vector<std::int8_t> cells;  ///< row by row: 100 occupied, 0 free, -1 unknown

  static constexpr std::int8_t kOccupiedFrom = 50, kUnknown = -1;
  /// Value at a point; unknown outside.
  std::int8_t at(const Eigen::Vector2d& p_map) const;
};

/// Points in base_link.
struct Surroundings {
  /// An occupied cell of a grid is its centre, unless points show what in it stands where.
  std::vector<Eigen::Vector2d> obstacles;
  /// Where something may stand that no image has shown: around columns of which only the upper part was seen, because
  /// what leans or spreads below an image is wider at the floor.
  std::vector<Eigen::Vector2d> unseen_feet;
};

/// What stands around the robot: points of the camera's own images, finer and newer than any map, remembered for a
/// while because the camera does not see its feet; and beyond them the mapper's grids.
class LocalMap {
 public:
  explicit LocalMap(const LocalMapConfig& config);

  /// @param has_path a robot that stands without one forgets nothing: what is below its image is still there when it is
  /// sent on. With one, what it waits for may have gone unseen.
  void add(const DepthView& view, const PlanarPose& T_map_base, time::Time stamp, bool has_path);
  /// The map's floor plan, and what stood in the way lately, which overrules it where it knows anything.
  void set_plan(Grid grid) { plan_ = std::move(grid); }
  void set_obstacles(Grid grid) { obstacles_ = std::move(grid); }
  /// The map frame has jumped: remembered points are where they were from the robot.
  void move_points(const PlanarPose& T_new_old);

  /// What is within a distance of the robot.
  Surroundings near(const PlanarPose& T_map_base, double distance_m) const;
  /// True when the mapper has seen that nothing is there; what the camera alone has seen is not asked.
  bool is_known_free(const Eigen::Vector2d& p_map) const;

 private:
  struct Look {
    PlanarPose T_map_base;
    time::Time stamp;
  };
  /// Points above one place of the map's plane.
  struct Column {
    Eigen::Vector2d p_map;
    double lowest_m;  ///< above base_link
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
  double time_s_ = 0.0;  // that counts so far
  Grid plan_;
  Grid obstacles_;
};

}  // namespace lapis::controller
