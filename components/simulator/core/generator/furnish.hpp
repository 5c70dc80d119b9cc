#pragma once

#include "simulator/core/generator/room_furnisher.hpp"

namespace lapis::simulator {

struct FurnishOptions {
  bool is_plain = false;   ///< few pictures, as in a clinic
  bool has_panes = false;  ///< panes of glass and mirrors stand free
};

/// Furnishes a room for its use. The result is a pure function of the arguments.
RoomContents furnish(const PlannedRoom& room, const std::vector<LocalOpening>& openings, double height_m,
                     const FurnishOptions& options, Dice dice);

}  // namespace lapis::simulator
