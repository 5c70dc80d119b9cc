#pragma once

#include "planner/core/replay/situation_file.hpp"
#include "tests/unit/planner/hallucination/small_world.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner::test {

/// A free square of 4 m with something of everything that a situation file holds.
inline RecordedSituation sample_situation() {
  FlatMap map(0.25);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) map.set({x, y}, mapping::kFree);
  }
  map.flush();
  RecordedSituation situation{{map.map(), {}, {}, {{"decision", "7"}, {"method", "joint"}}}, {}, {}, {}, {}};
  situation.marks = {{{8, 8}, {9, 8}}, {{3, 3}}};
  situation.robot = {{2.0, 2.0}, 0.5};
  Memory& memory = situation.memory;
  memory.left_alone = {{{3.5, 0.0}, Rejection::kFailed, Eigen::Vector2d(1.0, 0.0)}};
  memory.old_places = {{{1.0, 1.0}}};
  memory.gap_places = {{{1.5, 1.0}}};
  memory.failed_views = {{{0.0, 2.0}, {1.0, 2.0}}};
  memory.taken_views = {{{1.0, 3.0}, -1.0}};
  memory.looks_at_gaps = true;
  memory.radius_m = 0.5;
  memory.goal = Pose2{{3.0, 3.0}, 1.0};
  memory.turns_to = -1;
  memory.adrift = Adrift{.sigma_m = 0.1, .growth = 0.02, .budget_m = 0.4, .tracked = {{{2.0, 1.0}, 0.0}}};
  Chain chain({camera_at(1.0, 2.0, 0.0), camera_at(1.3, 2.0, 0.0), camera_at(1.6, 2.0, 0.0)});
  chain.edges.push_back({10, 12, information(0.02, 0.02), true});
  situation.graph = RecordedGraph{chain.keyframes, chain.edges, 0.01, tile_of(wall_at(3.0f, 2.0f), {10, 11})};
  return situation;
}

}  // namespace lapis::planner::test
