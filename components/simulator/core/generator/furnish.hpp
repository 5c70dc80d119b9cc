#pragma once

#include "simulator/core/generator/room_furnisher.hpp"

namespace lapis::simulator {

struct FurnishOptions {
  bool is_plain = false;   ///< few pictures, as in a clinic
  bool has_panes = false;  ///< of glass, and mirrors, that stand free
};

/// Furnishes a room for its use: a pure function of its arguments.
RoomContents furnish(const PlannedRoom& room, const std::vector<LocalOpening>& openings, double height_m,
                     const FurnishOptions& options, Dice dice);

}  // namespace lapis::simulator
