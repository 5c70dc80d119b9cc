#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/mapping/file/map_file.hpp"
#include "common/mapping/wire/landmark_tile.hpp"
#include "planner/core/candidates/situation.hpp"
#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner {

/// The pose graph and the landmarks that a decision was made with.
struct RecordedGraph {
  std::vector<Keyframe> keyframes;  ///< by id
  std::vector<KeyframeEdge> edges;
  double position_variance_m2 = 0.0;  ///< of each axis, as slam says; 0: it does not
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
};

/// What a decision was made from, but for the configuration. lapis_planner --replay makes it again.
struct RecordedSituation {
  mapping::MapFile map;  ///< its provenance names the decision, its stamp, and the method
  GridMarks marks;
  Pose2 robot;
  Memory memory;
  std::optional<RecordedGraph> graph;
};

/// Bytes of a situation file: "LAPISSIT", format version (u32), CRC-32 of everything after it (u32), marks, robot,
/// memory, graph, and a map file (map_file.hpp) to the end. Equal content gives equal bytes.
std::vector<std::uint8_t> encode_situation(const RecordedSituation& situation);
/// Nothing, with the reason in `error`, for anything that is not a whole and undamaged file.
std::optional<RecordedSituation> decode_situation(std::span<const std::uint8_t> bytes, std::string& error);

}  // namespace lapis::planner
