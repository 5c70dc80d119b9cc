#pragma once

#include <cstddef>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "planner/core/information/information_field.hpp"
#include "planner/core/information/map_information.hpp"
#include "planner/core/space/frontier_map.hpp"

namespace lapis::planner {

struct SurroundingsConfig {
  GridConfig grid;
  FrontierConfig frontiers;
  RayModel ray{.votes = 15, .unknown_occupied = 0.04, .surface_occupied = 0.6};
  /// P(occupied) of voxels never observed, in place of the sensor model's prior; each prior gives one further
  /// information field.
  std::vector<double> compared_priors;
};

/// What the planner knows about the building: floor plan with obstacles, frontiers, and the information of every voxel.
/// All are updated from the changed blocks of the map.
class Surroundings {
 public:
  Surroundings(const SurroundingsConfig& config, const mapping::SensorModel& model, double resolution_m);

  const PlanningGrid& grid() const { return grid_; }
  const FrontierMap& frontiers() const { return frontiers_; }
  const InformationField& field() const { return field_; }
  /// The field with each of the compared priors.
  std::span<const InformationField> compared_fields() const { return compared_fields_; }
  /// Information of the map so far [nats].
  double information_nats() const { return information_.nats(); }
  /// Volume of all observed voxels [m^3].
  double explored_volume_m3() const;

  /// @param changed all blocks whose content has changed since the last call, including removed ones
  void update_map(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);
  /// Returns false when the grid is malformed.
  bool update_obstacles(const ObstacleGrid& grid, time::Time stamp);
  /// Sets the area seen by frames that are not yet in the map because they wait for a correction: the free cells of
  /// `area`. Returns false, and changes nothing, when the cells of `area` are not of the map's size.
  bool set_provisional_area(const ObstacleGrid& area);
  /// True when these frames have seen most of the unknown cells beside the frontier: the frontier will move when they
  /// enter the map.
  bool is_awaited(const Frontier& frontier) const;
  /// The representatives of all such frontiers [m, map].
  std::vector<Eigen::Vector2d> awaited_targets() const;
  /// Number of cells that the map knows in the square of half edge `radius_m` around a place; obstacle grids do not
  /// count.
  int known_cells(const Eigen::Vector2d& place_map, double radius_m) const;
  /// The robot is at this position [m, map], so it can pass there.
  void mark_driven(const Eigen::Vector2d& robot_map) { grid_.mark_driven(robot_map); }
  /// Applies the marks of grid() of other surroundings with the same map.
  void set_marks(const GridMarks& marks) { frontiers_.update(grid_, grid_.set_marks(marks)); }
  /// Sets all places that the robot cannot pass, whatever the map says [m, map].
  void set_blocked(std::span<const Eigen::Vector2d> places_map);

 private:
  void count_observed(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);

  mapping::BeliefReader reader_;
  PlanningGrid grid_;
  FrontierMap frontiers_;
  std::set<Cell> provisional_;
  InformationField field_;
  MapInformation information_;
  std::vector<InformationField> compared_fields_;
  /// Number of observed voxels by block; blocks without observed voxels are absent.
  std::unordered_map<mapping::BlockIndex, int, mapping::GridIndexHash> observed_;
  std::size_t observed_voxels_ = 0;
};

}  // namespace lapis::planner
