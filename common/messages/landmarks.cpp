#include "common/messages/landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace lapis::messages {
namespace {

using mapping::LandmarkTile;

template <class Iterator>
bool is_ascending(Iterator begin, Iterator end) {
  return std::adjacent_find(begin, end, std::greater_equal<>()) == end;
}

// Why the observers cannot be read, or nothing.
std::string fault_of_observers(const lapis_msgs::msg::LandmarkTile& message) {
  const auto& ends = message.observer_ends();
  const auto& observers = message.observers();
  if (ends.size() != message.ids().size()) return "observer_ends and ids differ in number";
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

std::string fault_of(const lapis_msgs::msg::LandmarkTile& message) {
  const auto& ids = message.ids();
  const auto& positions = message.positions();
  if (mapping::landmark_tile_bytes(ids.size(), message.observers().size()) > mapping::kMaxLandmarkTileBytes) {
    return "tile is larger than 1 MiB";
  }
  if (positions.size() != 3 * ids.size()) return "positions and ids differ in number";
  if (!is_ascending(ids.begin(), ids.end())) return "ids are not ascending";
  if (!std::all_of(positions.begin(), positions.end(), [](float x) { return std::isfinite(x); })) {
    return "a position is not finite";
  }
  return fault_of_observers(message);
}

}  // namespace

Converted<LandmarkTile> from_message(const lapis_msgs::msg::LandmarkTile& message) {
  const std::string fault = fault_of(message);
  if (!fault.empty()) return Converted<LandmarkTile>::refused(fault);
  LandmarkTile tile;
  tile.index = {message.x(), message.y(), message.z()};
  tile.graph_version = message.graph_version();
  tile.omitted = message.omitted();
  tile.ids = message.ids();
  tile.positions_m.reserve(message.ids().size());
  for (std::size_t at = 0; at < message.positions().size(); at += 3) {
    tile.positions_m.emplace_back(&message.positions()[at]);
  }
  tile.observer_ends = message.observer_ends();
  tile.observers = message.observers();
  return tile;
}

mapping::LandmarkState from_message(const lapis_msgs::msg::LandmarkState& message) {
  return {message.session(),  message.graph_version(), message.tiles(),
          message.checksum(), message.tile_edge_m(),   message.tolerance_m()};
}

lapis_msgs::msg::LandmarkTile to_message(const LandmarkTile& tile, std::int64_t session) {
  lapis_msgs::msg::LandmarkTile message;
  message.x(tile.index.x);
  message.y(tile.index.y);
  message.z(tile.index.z);
  message.session(session);
  message.graph_version(tile.graph_version);
  message.omitted(tile.omitted);
  message.ids(tile.ids);
  message.positions().reserve(3 * tile.positions_m.size());
  for (const Eigen::Vector3f& p : tile.positions_m) {
    message.positions().insert(message.positions().end(), p.begin(), p.end());
  }
  message.observer_ends(tile.observer_ends);
  message.observers(tile.observers);
  return message;
}

lapis_msgs::msg::LandmarkState to_message(const mapping::LandmarkState& state) {
  lapis_msgs::msg::LandmarkState message;
  message.session(state.session);
  message.graph_version(state.graph_version);
  message.tile_edge_m(state.tile_edge_m);
  message.tolerance_m(state.tolerance_m);
  message.tiles(state.tiles);
  message.checksum(state.checksum);
  return message;
}

}  // namespace lapis::messages
