#include "slam/core/map/landmark_tiles.hpp"

#include <algorithm>

namespace lapis::slam {
namespace {

using mapping::LandmarkTile;
using mapping::TileIndex;

// Chooses the landmarks that most key-frames see, the oldest first where equal, as many as fit; ascending.
std::vector<LandmarkId> choose(const Map& map, std::vector<LandmarkId> ids, std::size_t max_bytes) {
  const auto observers = [&](LandmarkId id) { return map.landmark(id).observations.size(); };
  std::size_t all = 0;
  for (const LandmarkId id : ids) all += observers(id);
  if (mapping::landmark_tile_bytes(ids.size(), all) <= max_bytes) return ids;
  std::stable_sort(ids.begin(), ids.end(), [&](LandmarkId a, LandmarkId b) { return observers(a) > observers(b); });
  std::size_t kept = 0;
  for (std::size_t sum = 0; kept < ids.size(); ++kept) {
    sum += observers(ids[kept]);
    if (mapping::landmark_tile_bytes(kept + 1, sum) > max_bytes) break;
  }
  ids.resize(kept);
  std::sort(ids.begin(), ids.end());
  return ids;
}

void append_observers(const Landmark& landmark, LandmarkTile& tile) {
  const auto begin = static_cast<std::ptrdiff_t>(tile.observers.size());
  for (const Observation& observation : landmark.observations) {
    tile.observers.push_back(static_cast<std::uint32_t>(observation.keyframe));  // an index: memory is full before 2^32
  }
  std::sort(tile.observers.begin() + begin, tile.observers.end());
  tile.observer_ends.push_back(static_cast<std::uint32_t>(tile.observers.size()));
}

}  // namespace

LandmarkTiles::Sent LandmarkTiles::as_now(const Map& map, const Landmark& landmark) {
  Sent now;
  if (landmark.observations.empty()) return now;
  if (map.keyframe(landmark.observations.front().keyframe).sub_map != kWholeMap) return now;
  const double farthest_m = landmark.p_map.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  now.is_in_tile = farthest_m <= mapping::kMaxLandmarkCoordinate_m;
  if (!now.is_in_tile) return now;
  now.p_map = landmark.p_map.cast<float>();
  for (const Observation& observation : landmark.observations)
    now.observers += mapping::mix_bits(observation.keyframe + 1);
  return now;
}

bool LandmarkTiles::is_same(const Sent& a, const Sent& b) const {
  if (!a.is_in_tile || !b.is_in_tile) return a.is_in_tile == b.is_in_tile;
  return a.observers == b.observers && (a.p_map - b.p_map).cast<double>().norm() <= config_.tolerance_m;
}

/// Takes over what has changed, and returns the tiles concerned with all their landmarks. It looks at every landmark,
/// which takes a few milliseconds (lapis_slam_snapshot_benchmark), so that it cannot miss a change.
LandmarkTiles::Members LandmarkTiles::follow(const Map& map) {
  Members members;
  sent_.resize(map.landmarks().size());
  for (std::size_t id = 0; id < sent_.size(); ++id) {
    Sent& sent = sent_[id];
    Sent now = as_now(map, map.landmarks()[id]);
    if (is_same(sent, now)) continue;
    if (sent.is_in_tile) members[sent.tile];
    if (now.is_in_tile) {
      now.tile = mapping::landmark_tile_of(now.p_map, config_.edge_m);
      members[now.tile];
    }
    sent = now;
  }
  for (std::size_t id = 0; id < sent_.size(); ++id) {
    if (!sent_[id].is_in_tile) continue;
    const auto tile = members.find(sent_[id].tile);
    if (tile != members.end()) tile->second.push_back(static_cast<LandmarkId>(id));
  }
  return members;
}

std::vector<LandmarkTile> LandmarkTiles::update(const Map& map, std::uint64_t graph_version) {
  graph_version_ = graph_version;
  std::vector<LandmarkTile> tiles;
  for (const auto& [index, members] : follow(map)) {
    tiles.push_back(make_tile(map, index, members));
    versions_.set(index, graph_version);
  }
  std::sort(tiles.begin(), tiles.end(), [](const LandmarkTile& a, const LandmarkTile& b) { return a.index < b.index; });
  return tiles;
}

LandmarkTile LandmarkTiles::make_tile(const Map& map, const TileIndex& index,
                                      const std::vector<LandmarkId>& members) const {
  LandmarkTile tile;
  tile.index = index;
  tile.graph_version = graph_version_;
  tile.ids = choose(map, members, config_.max_tile_bytes);
  tile.omitted = static_cast<std::uint32_t>(members.size() - tile.ids.size());
  tile.positions_m.reserve(tile.ids.size());
  tile.observer_ends.reserve(tile.ids.size());
  for (const LandmarkId id : tile.ids) {
    tile.positions_m.push_back(sent_[id].p_map);
    append_observers(map.landmark(id), tile);
  }
  return tile;
}

mapping::LandmarkState LandmarkTiles::state() const {
  return {0,
          0,
          graph_version_,
          static_cast<std::uint32_t>(versions_.size()),
          versions_.checksum(),
          config_.edge_m,
          config_.tolerance_m};
}

}  // namespace lapis::slam
