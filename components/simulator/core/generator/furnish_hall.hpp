#pragma once

#include "simulator/core/generator/room_furnisher.hpp"

namespace lapis::simulator {

/// Racks in rows, a yard with pallets before the loading doors, and a counter: no two halls are arranged alike.
void furnish_hall(RoomFurnisher& room);

}  // namespace lapis::simulator
