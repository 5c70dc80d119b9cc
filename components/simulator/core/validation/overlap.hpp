#pragma once

#include <cstddef>
#include <vector>

#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

/// Two items that fill the same space.
struct Overlap {
  std::size_t first = 0, second = 0;  ///< items, first < second
  double share = 0.0;                 ///< of the smaller one's space
  Eigen::Vector3f at{0, 0, 0};        ///< middle of what they share [m]
};

/// Pairs of items that stick in one another.
///
/// Space is cut into voxels of 2 cm. An item fills those that its surface passes through, and those that its surface
/// shuts off from the outside; so a wardrobe is solid, while one may reach between the boards of a shelf or under a
/// table. A voxel that two items fill is mere contact, which is allowed, when along some axis the two share no more
/// than 8 cm there, and one leaves that stretch for something else than one enters it from: out of a cushion pressed
/// into a sofa, out of a book into the air. What passes through another thing, or lies in it, is no contact. A pair
/// overlaps when what is no contact is more than 2 % of the smaller item.
std::vector<Overlap> find_overlaps(const Scene& scene, const Inventory& inventory);

/// An item that leaves the rooms: through a wall, the floor, or the ceiling.
struct Protrusion {
  std::size_t item = 0;
  double share = 0.0;  ///< of its surface that is outside
};

/// Items of which more than 1 % of the surface is outside all rooms by more than 3 cm; none when no rooms are known.
std::vector<Protrusion> find_protrusions(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
