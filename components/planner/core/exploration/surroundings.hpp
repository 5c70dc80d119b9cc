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
  std::vector<double> compared_priors;  ///< P(occupied) of voxels never observed, instead of the sensor model's
};

/// What the planner knows of the building: floor plan with obstacles, frontiers and the information of every voxel, all
/// kept up to date by the blocks of the map that changed.
class Surroundings {
 public:
  Surroundings(const SurroundingsConfig& config, const mapping::SensorModel& model, double resolution_m);

  const PlanningGrid& grid() const { return grid_; }
  const FrontierMap& frontiers() const { return frontiers_; }
  const InformationField& field() const { return field_; }
  /// The same with each of the compared priors.
  std::span<const InformationField> compared_fields() const { return compared_fields_; }
  /// What the map has learnt so far [nats].
  double information_nats() const { return information_.nats(); }
  /// Of all observed voxels [m^3].
  double explored_volume_m3() const;

  /// @param changed all blocks whose content is not what it was at the last call, those that are gone included
  void update_map(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);
  /// False when the grid is malformed.
  bool update_obstacles(const ObstacleGrid& grid, time::Time stamp);
  /// Where frames have looked that wait for a correction to enter the map: the cells that are free in `area`. False,
  /// and no change, when its cells are not those of the map.
  bool set_provisional_area(const ObstacleGrid& area);
  /// The frontier will move when these frames have entered the map: they have seen most of the unknown cells beside it.
  bool is_awaited(const Frontier& frontier) const;
  /// What stands for such frontiers [m, map].
  std::vector<Eigen::Vector2d> awaited_targets() const;
  /// How many cells of the square around a place that a circle of this radius touches the map knows.
  int known_cells(const Eigen::Vector2d& place_map, double radius_m) const;
  /// The robot is there [m, map]: it can pass.
  void mark_driven(const Eigen::Vector2d& robot_map) { grid_.mark_driven(robot_map); }
  /// As grid().marks() of other surroundings with the same map.
  void set_marks(const GridMarks& marks) { frontiers_.update(grid_, grid_.set_marks(marks)); }
  /// Places that the robot found it cannot pass, whatever the map says [m, map]; all others are as the map says.
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
  std::unordered_map<mapping::BlockIndex, int, mapping::GridIndexHash> observed_;  ///< voxels by block, none with 0
  std::size_t observed_voxels_ = 0;
};

}  // namespace lapis::planner
