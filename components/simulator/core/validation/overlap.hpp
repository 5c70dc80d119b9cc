#pragma once

#include <cstddef>
#include <vector>

#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

/// Two items that fill the same space.
struct Overlap {
  std::size_t first = 0, second = 0;  ///< items, first < second
  double share = 0.0;                 ///< of the smaller one's space
  Eigen::Vector3f at{0, 0, 0};        ///< middle of the shared space [m]
};

/// Pairs of items that are partly inside each other.
///
/// Space is cut into voxels of 2 cm. An item fills the voxels through which its surface passes, and those that its
/// surface shuts off from the outside; so a wardrobe is solid, but the space between the boards of a shelf or under a
/// table is free. A voxel that two items fill is mere contact, which is allowed, when along some axis the stretch that
/// both fill there is at most 8 cm long, and the voxels at its two ends differ: for example a cushion at one end and
/// the sofa into which it is pressed at the other, or a book and the air. An item that passes through another one, or
/// is inside it, is no contact. A pair overlaps when voxels that are no contact are over 2 % of the smaller item.
std::vector<Overlap> find_overlaps(const Scene& scene, const Inventory& inventory);

/// An item that leaves the rooms: through a wall, the floor, or the ceiling.
struct Protrusion {
  std::size_t item = 0;
  double share = 0.0;  ///< of its surface that is outside
};

/// Items of which more than 1 % of the surface is outside all rooms by more than 3 cm; none when no rooms are known.
std::vector<Protrusion> find_protrusions(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
