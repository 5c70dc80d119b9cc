#include "planner/core/exploration/surroundings.hpp"

#include <cmath>
#include <utility>

namespace lapis::planner {
namespace {

constexpr double kSameEdge_m = 1e-6;

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
      field_(resolution_m, model, config.ray), information_(model) {
  for (const double prior : config.compared_priors) {
    mapping::SensorModel other = model;
    other.prior_occupied = prior;
    compared_fields_.emplace_back(resolution_m, other, config.ray);
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
  information_.update(map, changed);
  count_observed(map, changed);
}

bool Surroundings::update_obstacles(const ObstacleGrid& grid, time::Time stamp) {
  const auto changed = grid_.update_obstacles(grid, stamp);
  if (!changed) return false;
  frontiers_.update(grid_, *changed);
  return true;
}

bool Surroundings::set_provisional_area(const ObstacleGrid& area) {
  const bool is_same_grid = std::abs(area.resolution_m - grid_.resolution_m()) <= kSameEdge_m;
  if (!area.cells.empty() && !is_same_grid) return false;
  provisional_.clear();
  for (int row = 0; row < area.height; ++row) {
    for (int column = 0; column < area.width; ++column) {
      const Eigen::Vector2d center = area.origin + grid_.resolution_m() * Eigen::Vector2d(column + 0.5, row + 0.5);
      if (area.at(column, row) == mapping::kFree) provisional_.insert(grid_.cell_of(center));
    }
  }
  return true;
}

bool Surroundings::is_awaited(const Frontier& frontier) const {
  if (provisional_.empty()) return false;
  int unknown = 0, seen = 0;
  for (const Cell& c : frontier.cells) {
    for (std::size_t i = 0; i < kStraightSteps; ++i) {
      if (grid_.state(c + kSteps[i]) != mapping::kUnknown) continue;
      ++unknown;
      seen += provisional_.contains(c + kSteps[i]) ? 1 : 0;
    }
  }
  return 2 * seen > unknown;
}

std::vector<Eigen::Vector2d> Surroundings::awaited_targets() const {
  std::vector<Eigen::Vector2d> targets;
  for (const auto& [id, frontier] : frontiers_.frontiers()) {
    if (!is_awaited(frontier)) continue;
    for (const Cell& c : frontier.representatives) targets.push_back(grid_.center_of(c));
  }
  return targets;
}

int Surroundings::known_cells(const Eigen::Vector2d& place_map, double radius_m) const {
  const Cell middle = grid_.cell_of(place_map);
  const int reach = static_cast<int>(radius_m / grid_.resolution_m());
  int known = 0;
  for (Cell step{0, -reach}; step.y <= reach; ++step.y) {
    for (step.x = -reach; step.x <= reach; ++step.x)
      known += grid_.mapped_state(middle + step) != mapping::kUnknown ? 1 : 0;
  }
  return known;
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
