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

/// The pose graph and the landmarks from which a decision was made.
struct RecordedGraph {
  std::vector<Keyframe> keyframes;  ///< sorted by id
  std::vector<KeyframeEdge> edges;
  double position_variance_m2 = 0.0;  ///< per axis, as slam publishes it; 0 when slam does not publish it
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
};

/// The input of a decision, except the configuration. lapis_planner --replay makes the decision again.
struct RecordedSituation {
  mapping::MapFile map;  ///< its provenance names the decision, the time stamp and the method
  GridMarks marks;
  Pose2 robot;
  Memory memory;
  std::optional<RecordedGraph> graph;
};

/// Bytes of a situation file: "LAPISSIT", format version (u32), CRC-32 of everything after it (u32), marks, robot,
/// memory, graph, and a map file (map_file.hpp) to the end. Equal content gives equal bytes.
std::vector<std::uint8_t> encode_situation(const RecordedSituation& situation);
/// Returns nothing, and sets `error` to the reason, unless the bytes are a complete and undamaged file.
std::optional<RecordedSituation> decode_situation(std::span<const std::uint8_t> bytes, std::string& error);

}  // namespace lapis::planner
