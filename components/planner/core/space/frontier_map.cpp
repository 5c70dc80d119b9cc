#include "planner/core/space/frontier_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace lapis::planner {
namespace {

// During an update, cells may have one of these values in place of a frontier's id:
constexpr std::uint32_t kNone = 0;
constexpr std::uint32_t kFresh = std::numeric_limits<std::uint32_t>::max();  // a new frontier cell
constexpr std::uint32_t kTaken = kFresh - 1;                                 // a frontier cell that has been collected

bool is_frontier(const PlanningGrid& grid, Cell c) {
  return grid.state(c) == mapping::kFree &&
         std::any_of(kSteps.begin(), kSteps.begin() + kStraightSteps,
                     [&](Cell step) { return grid.state(c + step) == mapping::kUnknown; });
}

struct Box {
  Cell low{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
  Cell high{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};

  void include(Cell c) {
    low = {std::min(low.x, c.x), std::min(low.y, c.y)};
    high = {std::max(high.x, c.x), std::max(high.y, c.y)};
  }
  int width() const { return high.x - low.x + 1; }
  int height() const { return high.y - low.y + 1; }
  double diagonal() const { return std::hypot(width(), height()); }
};

/// The cell nearest to `centroid` [cells], then repeatedly the cell farthest from those chosen; of equal ones, the
/// first.
std::vector<Cell> representatives(const std::vector<Cell>& cells, const Eigen::Vector2d& centroid, int count) {
  const auto to_centroid = [&](Cell c) { return (Eigen::Vector2d(c.x, c.y) - centroid).squaredNorm(); };
  std::vector<Cell> chosen{
      *std::min_element(cells.begin(), cells.end(), [&](Cell a, Cell b) { return to_centroid(a) < to_centroid(b); })};
  std::vector<std::int64_t> gap(cells.size(), std::numeric_limits<std::int64_t>::max());
  while (chosen.size() < std::min(cells.size(), static_cast<std::size_t>(count))) {
    for (std::size_t i = 0; i < cells.size(); ++i) gap[i] = std::min(gap[i], squared_distance(cells[i], chosen.back()));
    chosen.push_back(cells[static_cast<std::size_t>(std::max_element(gap.begin(), gap.end()) - gap.begin())]);
  }
  return chosen;
}

}  // namespace

void FrontierMap::update(const PlanningGrid& grid, std::span<const Cell> changed) {
  const std::vector<Cell> seeds = renew_cells(grid, changed);
  std::vector<Group> pieces;
  for (const Cell& seed : seeds)
    if (const std::uint32_t id = marks_.at(seed).id; id != kNone && id != kTaken)
      split(take_component(seed), config_.max_extent_m / grid.resolution_m(), pieces);
  replace(std::move(pieces), grid.resolution_m());
}

/// Marks new frontier cells, and unmarks cells that are no longer frontier cells, and removes their frontiers. Every
/// component that has changed contains one of the returned cells.
std::vector<Cell> FrontierMap::renew_cells(const PlanningGrid& grid, std::span<const Cell> changed) {
  std::vector<Cell> seeds;
  ++updates_;
  const auto renew = [&](Cell c) {
    Mark& mark = marks_[c];
    if (mark.renewed == updates_) return;
    mark.renewed = updates_;
    const std::uint32_t old_id = mark.id;
    const bool is_now = is_frontier(grid, c);
    if (is_now == (old_id != kNone)) return;
    mark.id = is_now ? kFresh : kNone;
    if (is_now) {
      seeds.push_back(c);
      return;
    }
    for (const Cell& step : kSteps) seeds.push_back(c + step);
    frontiers_.erase(old_id);
  };
  for (const Cell& c : changed) {
    renew(c);
    for (std::size_t i = 0; i < kStraightSteps; ++i) renew(c + kSteps[i]);
  }
  return seeds;
}

/// Collects the frontier cells that are connected to `seed` and have not been collected yet.
FrontierMap::Group FrontierMap::take_component(Cell seed) {
  Group component;
  const auto take = [&](Cell c) {
    const std::uint32_t id = marks_.at(c).id;
    if (id == kNone || id == kTaken) return;
    component.push_back({c, id});
    marks_[c].id = kTaken;
  };
  take(seed);
  for (std::size_t next = 0; next < component.size();) {  // the component grows in the loop
    const Cell c = component[next++].cell;
    for (const Cell& step : kSteps) take(c + step);
  }
  return component;
}

/// Splits a collected component, and appends its pieces.
void FrontierMap::split(Group component, double max_extent_cells, std::vector<Group>& pieces) {
  Box box;
  for (const Member& member : component) box.include(member.cell);
  if (component.size() == 1 || box.diagonal() <= max_extent_cells) {
    std::sort(component.begin(), component.end(), [](const Member& a, const Member& b) { return a.cell < b.cell; });
    pieces.push_back(std::move(component));
    return;
  }
  const bool is_wide = box.width() >= box.height();
  const auto is_low = [&](const Member& m) {
    return is_wide ? m.cell.x - box.low.x < box.width() / 2 : m.cell.y - box.low.y < box.height() / 2;
  };
  const auto middle = std::partition(component.begin(), component.end(), is_low);
  for (const auto& [begin, end] : {std::pair{component.begin(), middle}, std::pair{middle, component.end()}}) {
    for (auto m = begin; m != end; ++m) marks_[m->cell].id = m->old_id;  // put back, to be collected in connected parts
    for (auto m = begin; m != end; ++m)
      if (marks_.at(m->cell).id != kTaken) split(take_component(m->cell), max_extent_cells, pieces);
  }
}

/// Replaces the frontiers that had the cells of the pieces, and decides which piece inherits an id.
void FrontierMap::replace(std::vector<Group> pieces, double resolution_m) {
  const auto by_first_cell = [](const Group& a, const Group& b) { return a.front().cell < b.front().cell; };
  std::sort(pieces.begin(), pieces.end(), by_first_cell);
  std::map<std::pair<std::uint32_t, std::size_t>, int> shared;  // (old id, index of the piece): common cells
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const Member& member : pieces[i])
      if (member.old_id != kFresh) ++shared[{member.old_id, i}];
  std::vector<std::tuple<int, std::uint32_t, std::size_t>> claims;  // largest overlap first
  for (const auto& [claim, cells] : shared) {
    claims.emplace_back(-cells, claim.first, claim.second);
    frontiers_.erase(claim.first);
  }
  std::sort(claims.begin(), claims.end());
  std::vector<std::uint32_t> ids(pieces.size(), kNone);
  for (const auto& [cells, old_id, i] : claims) {
    if (ids[i] != kNone || frontiers_.contains(old_id)) continue;
    ids[i] = old_id;
    add(old_id, pieces[i], resolution_m);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (ids[i] == kNone) add(++last_id_, pieces[i], resolution_m);
}

void FrontierMap::add(std::uint32_t id, const Group& piece, double resolution_m) {
  Frontier& frontier = frontiers_[id];
  frontier.id = id;
  Box box;
  Eigen::Vector2d sum{0, 0};
  for (const Member& member : piece) {
    marks_[member.cell].id = id;
    frontier.cells.push_back(member.cell);
    box.include(member.cell);
    sum += Eigen::Vector2d(member.cell.x, member.cell.y);
  }
  const Eigen::Vector2d centroid = sum / static_cast<double>(piece.size());
  frontier.centroid_map = resolution_m * (centroid + Eigen::Vector2d(0.5, 0.5));
  frontier.length_m = static_cast<double>(piece.size()) * resolution_m;
  frontier.extent_m = box.diagonal() * resolution_m;
  frontier.representatives = representatives(frontier.cells, centroid, config_.representatives);
}

}  // namespace lapis::planner
