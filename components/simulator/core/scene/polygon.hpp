#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace lapis::simulator {

/// Corners in order; the last is joined to the first. [m]
using Polygon = std::vector<Eigen::Vector2d>;

/// Positive when the corners run counter-clockwise. [m2]
double signed_area(const Polygon& polygon);

/// True when no two edges touch, except neighbours at their corner, and no edge is shorter than 1 mm.
bool is_simple(const Polygon& polygon);

/// True for points inside; those on the border may be either.
bool contains(const Polygon& polygon, const Eigen::Vector2d& point);

/// Distance to the nearest edge. [m]
double distance_to_border(const Polygon& polygon, const Eigen::Vector2d& point);

/// True when no corner of `inner` is outside of `outer` by more than 1 mm and no edges cross.
bool contains(const Polygon& outer, const Polygon& inner);

/// True when two convex polygons overlap by more than 1 mm (separating axis theorem).
bool overlap(const Polygon& a, const Polygon& b);

/// Cuts a simple counter-clockwise polygon into triangles (ear clipping): numbers of corners, counter-clockwise.
std::vector<std::array<std::size_t, 3>> triangulate(const Polygon& polygon);

/// The part of a convex polygon inside another, both counter-clockwise [Sutherland, Hodgman 1974]; may be empty.
Polygon clip(Polygon subject, const Polygon& window);

/// A rectangle of the given size around `center`, rotated counter-clockwise.
Polygon rectangle(const Eigen::Vector2d& center, const Eigen::Vector2d& size, double yaw_rad);

}  // namespace lapis::simulator
