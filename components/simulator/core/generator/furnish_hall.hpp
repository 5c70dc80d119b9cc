#pragma once

#include "simulator/core/generator/room_furnisher.hpp"

namespace lapis::simulator {

/// Adds rows of racks, a yard with pallets in front of the loading doors, and a counter: no two halls are arranged
/// alike.
void furnish_hall(RoomFurnisher& room);

}  // namespace lapis::simulator
