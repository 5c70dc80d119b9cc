#include "common/messages/landmarks.hpp"

#include <string>
#include <utility>

namespace lapis::messages {
using mapping::LandmarkTile;

Converted<LandmarkTile> from_message(const lapis_msgs::msg::LandmarkTile& message) {
  if (message.positions().size() != 3 * message.ids().size())
    return Converted<LandmarkTile>::refused("positions and ids differ in number");
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
  if (std::string fault = mapping::fault_of(tile); !fault.empty())
    return Converted<LandmarkTile>::refused(std::move(fault));
  return tile;
}

mapping::LandmarkState from_message(const lapis_msgs::msg::LandmarkState& message) {
  return {message.session(),  message.epoch(),       message.graph_version(), message.tiles(),
          message.checksum(), message.tile_edge_m(), message.tolerance_m()};
}

lapis_msgs::msg::LandmarkTile to_message(const LandmarkTile& tile, std::int64_t epoch) {
  lapis_msgs::msg::LandmarkTile message;
  message.x(tile.index.x);
  message.y(tile.index.y);
  message.z(tile.index.z);
  message.epoch(epoch);
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
  message.epoch(state.epoch);
  message.graph_version(state.graph_version);
  message.tile_edge_m(state.tile_edge_m);
  message.tolerance_m(state.tolerance_m);
  message.tiles(state.tiles);
  message.checksum(state.checksum);
  return message;
}

}  // namespace lapis::messages
