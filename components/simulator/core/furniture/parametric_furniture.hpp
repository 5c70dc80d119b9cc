#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "simulator/core/looks/textures.hpp"
#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// Usual width, depth, and height of things of a class; half a metre each for classes without a shape of their own.
Eigen::Vector3d default_size_m(const std::string& class_name);

/// Furniture made of simple shapes, in the item frame: z up, origin in the middle of the footprint at the lowest point,
/// x along the width, y along the depth, the front looks along -y. It fills width x depth x height. Classes without a
/// shape of their own give a box. The result is a pure function of class, size and variant (colours, proportions,
/// contents).
Mesh make_furniture(const std::string& class_name, const Eigen::Vector3d& size_m, std::uint64_t variant,
                    TextureLibrary& textures);

}  // namespace lapis::simulator
