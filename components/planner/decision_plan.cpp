#include "planner/decision_plan.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/files/atomic_file.hpp"

namespace lapis::planner {
namespace {

using Json = nlohmann::ordered_json;

Json point(const Eigen::Vector2d& p_map) { return {p_map.x(), p_map.y()}; }

template <class Points>
Json points(const Points& p_map) {
  Json list = Json::array();
  for (const auto& p : p_map) list.push_back(point(p));
  return list;
}

/// Rows of characters, the row with the lowest y first, around all known cells: '.' free, '#' occupied, ' ' unknown.
Json floor_plan(const PlanningGrid& grid) {
  const std::vector<Cell> free = grid.cells_in(mapping::kFree), occupied = grid.cells_in(mapping::kOccupied);
  std::vector<Cell> known = free;
  known.insert(known.end(), occupied.begin(), occupied.end());
  if (known.empty()) return {{"lower_left_m", nullptr}, {"rows", Json::array()}};
  Cell low = known.front(), high = known.front();
  for (const Cell& c : known) {
    low = {std::min(low.x, c.x), std::min(low.y, c.y)};
    high = {std::max(high.x, c.x), std::max(high.y, c.y)};
  }
  std::vector<std::string> rows(static_cast<std::size_t>(high.y - low.y + 1),
                                std::string(static_cast<std::size_t>(high.x - low.x + 1), ' '));
  const auto at = [&](Cell c) -> char& {
    return rows[static_cast<std::size_t>(c.y - low.y)][static_cast<std::size_t>(c.x - low.x)];
  };
  for (const Cell& c : free) at(c) = '.';
  for (const Cell& c : occupied) at(c) = '#';
  const double half_m = 0.5 * grid.resolution_m();
  return {{"lower_left_m", point(grid.center_of(low) - Eigen::Vector2d(half_m, half_m))}, {"rows", rows}};
}

Json frontiers_of(const Surroundings& surroundings) {
  Json list = Json::array();
  for (const auto& [id, frontier] : surroundings.frontiers().frontiers()) {
    std::vector<Eigen::Vector2d> centers;
    for (const Cell& c : frontier.cells) centers.push_back(surroundings.grid().center_of(c));
    list.push_back({{"id", id}, {"cells_m", points(centers)}});
  }
  return list;
}

}  // namespace

DecisionPlan::DecisionPlan(std::string path) : path_(std::move(path)) {
  if (const auto problem = files::set_aside(path_)) throw std::runtime_error(*problem);
}

std::optional<std::string> DecisionPlan::write(const Decision& decision, const Surroundings& surroundings,
                                               std::uint64_t id) {
  const auto judged = std::count_if(decision.candidates.begin(), decision.candidates.end(),
                                    [](const Candidate& c) { return c.is_open(); });
  if (!decision.chosen || judged <= most_judged_) return std::nullopt;
  most_judged_ = judged;
  Json paths = Json::array();
  for (const Candidate& candidate : decision.candidates) paths.push_back(points(candidate.points));
  const Json document{{"decision", id},
                      {"robot_m", point(decision.promised.front().robot.p_map)},
                      {"resolution_m", surroundings.grid().resolution_m()},
                      {"plan", floor_plan(surroundings.grid())},
                      {"frontiers", frontiers_of(surroundings)},
                      {"paths_m", paths}};
  const std::string text = document.dump() + "\n";
  return files::replace_file(path_, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace lapis::planner
