#pragma once

#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "planner/core/information/information_field.hpp"
#include "planner/core/information/view.hpp"

namespace lapis::planner {

/// How a cell counts that several rays may see.
enum class Counting {
  kOnce,      ///< with its largest reach over all rays and poses: a lower bound that counts no information twice
  kEveryRay,  ///< with the sum of its reaches, as if each ray saw cells of its own
};

/// Camera poses at which views are taken, T_map_camera, in any order.
using ViewPath = std::vector<geometry::Pose>;

/// Expected information of the views from all poses of a path [nats]: the sum over cells of gain times reach. The reach
/// of a cell is the product of P(free) over the cells that a ray crosses before it, the cell itself not included
/// [Zhang, Bong & Beltrame 2024, eq. 12-15, summed by cells instead of outcomes; a ray without return is one of the
/// outcomes]. Rays cross cells exactly [Amanatides & Woo 1987], from the cell of the camera to the cell in which their
/// range ends. The same input gives the same bits. Throws std::invalid_argument for a pose that is not valid.
template <class Real>
double path_information(const BasicInformationField<Real>& field, const View& view, const ViewPath& path,
                        Counting counting = Counting::kOnce);

/// Information of the path's first view, of its first two views, and so on, each cell once [nats].
template <class Real>
std::vector<double> growing_information(const BasicInformationField<Real>& field, const View& view,
                                        const ViewPath& path);

/// Information of each path [nats], computed in parallel; the same bits for any number of threads.
template <class Real>
std::vector<double> path_information(const BasicInformationField<Real>& field, const View& view,
                                     std::span<const ViewPath> paths, Counting counting = Counting::kOnce);

}  // namespace lapis::planner
