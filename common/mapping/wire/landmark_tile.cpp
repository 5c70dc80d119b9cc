#include "common/mapping/wire/landmark_tile.hpp"

#include <algorithm>
#include <functional>

namespace lapis::mapping {
namespace {

template <class Iterator>
bool is_ascending(Iterator begin, Iterator end) {
  return std::adjacent_find(begin, end, std::greater_equal<>()) == end;
}

std::string fault_of_observers(const LandmarkTile& tile) {
  const auto& ends = tile.observer_ends;
  const auto& observers = tile.observers;
  if (ends.size() != tile.ids.size()) return "observer_ends and ids differ in number";
  if ((ends.empty() ? 0 : ends.back()) != observers.size()) return "observer_ends do not end with the observers";
  if (!is_ascending(ends.begin(), ends.end()) || (!ends.empty() && ends.front() == 0)) {
    return "a landmark has no observer";
  }
  std::uint32_t begin = 0;
  for (const std::uint32_t end : ends) {
    if (!is_ascending(observers.begin() + begin, observers.begin() + end)) return "observers are not ascending";
    begin = end;
  }
  return {};
}

}  // namespace

std::string fault_of(const LandmarkTile& tile) {
  if (landmark_tile_bytes(tile.ids.size(), tile.observers.size()) > kMaxLandmarkTileBytes) {
    return "tile is larger than 1 MiB";
  }
  if (tile.positions_m.size() != tile.ids.size()) return "positions and ids differ in number";
  if (!is_ascending(tile.ids.begin(), tile.ids.end())) return "ids are not ascending";
  const bool is_finite = std::all_of(tile.positions_m.begin(), tile.positions_m.end(),
                                     [](const Eigen::Vector3f& p) { return p.allFinite(); });
  return is_finite ? fault_of_observers(tile) : "a position is not finite";
}

}  // namespace lapis::mapping
