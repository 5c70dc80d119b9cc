#pragma once

#include <cstddef>
#include <vector>

#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

/// How far an item may be from what holds it, and how deep it may be pressed into it [m].
inline constexpr float kSupportGap_m = 0.03F;

/// Items that nothing holds, by their index. An item is held when a part of the building lies within kSupportGap_m
/// under, above, or beside some place of it, or when an item that is held itself lies under some place of it.
std::vector<std::size_t> find_floating(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
