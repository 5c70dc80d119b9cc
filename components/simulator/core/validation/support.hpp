#pragma once

#include <cstddef>
#include <vector>

#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

/// Greatest distance of an item from what holds it [m].
inline constexpr float kSupportGap_m = 0.03F;

/// Indices of the items that nothing holds. An item is held when a part of the building is within kSupportGap_m under,
/// above, or beside some place of it, or when an item that is itself held is so under some place of it.
std::vector<std::size_t> find_floating(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
