#pragma once

#include "simulator/core/generator/room_furnisher.hpp"

namespace lapis::simulator {

/// Furnishes a room for its use: a pure function of its arguments.
/// @param is_plain few pictures, as in a clinic
RoomContents furnish(const PlannedRoom& room, const std::vector<LocalOpening>& openings, double height_m, bool is_plain,
                     Dice dice);

}  // namespace lapis::simulator
