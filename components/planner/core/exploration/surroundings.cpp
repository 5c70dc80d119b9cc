#include "planner/core/exploration/surroundings.hpp"

#include <set>
#include <utility>

namespace lapis::planner {
namespace {

int observed_voxels(const mapping::VoxelBlock* block) {
  if (block == nullptr) return 0;
  if (block->is_uniform()) return block->is_empty() ? 0 : mapping::kBlockVoxels;
  int count = 0;
  for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) count += block->is_observed(offset) ? 1 : 0;
  return count;
}

}  // namespace

Surroundings::Surroundings(const SurroundingsConfig& config, const mapping::SensorModel& model, double resolution_m)
    : reader_(model), grid_(config.grid, resolution_m), frontiers_(config.frontiers),
      field_(resolution_m, model, config.measure) {
  for (const double prior : config.compared_priors) {
    mapping::SensorModel other = model;
    other.prior_occupied = prior;
    compared_fields_.emplace_back(resolution_m, other, config.measure);
  }
}

double Surroundings::explored_volume_m3() const {
  const double edge_m = grid_.resolution_m();
  return static_cast<double>(observed_voxels_) * edge_m * edge_m * edge_m;
}

void Surroundings::update_map(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed) {
  field_.update(map, changed);
  for (InformationField& field : compared_fields_) field.update(map, changed);
  frontiers_.update(grid_, grid_.update_map(map, reader_, changed));
  count_observed(map, changed);
}

bool Surroundings::update_obstacles(const ObstacleGrid& grid, time::Time stamp) {
  const auto changed = grid_.update_obstacles(grid, stamp);
  if (!changed) return false;
  frontiers_.update(grid_, *changed);
  return true;
}

void Surroundings::set_blocked(std::span<const Eigen::Vector2d> places_map) {
  std::set<Cell> cells;
  for (const Eigen::Vector2d& place : places_map) cells.insert(grid_.cell_of(place));
  frontiers_.update(grid_, grid_.set_blocked(std::move(cells)));
}

void Surroundings::count_observed(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed) {
  for (const mapping::BlockIndex& index : changed) {
    const int now = observed_voxels(map.find(index));
    const auto known = observed_.find(index);
    if (known != observed_.end()) observed_voxels_ -= static_cast<std::size_t>(known->second);
    observed_voxels_ += static_cast<std::size_t>(now);
    if (now > 0) {
      observed_[index] = now;
    } else if (known != observed_.end()) {
      observed_.erase(known);
    }
  }
}

}  // namespace lapis::planner
