#pragma once

#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "planner/core/information/information_field.hpp"
#include "planner/core/information/view.hpp"

namespace lapis::planner {

/// How often a cell counts that several rays can see.
enum class Counting {
  kOnce,      ///< with its largest reach over all rays and poses: no information is counted twice, a lower bound
  kEveryRay,  ///< with the sum of them: as if each ray saw cells of its own
};

/// Camera poses at which views are taken, T_map_camera, in any order.
using ViewPath = std::vector<geometry::Pose>;

/// Expected information of looking from all poses of a path [nats]: sum over cells of gain times reach, the reach
/// of a cell being the product of P(free) over the cells that a ray crosses before it, itself not included
/// [Zhang, Bong & Beltrame 2024, eq. 12-15, summed by cells instead of outcomes; a ray without return is one of them].
/// Rays cross cells exactly [Amanatides & Woo 1987], from that of the camera to that in which their range ends.
/// The same input gives the same bits. Throws std::invalid_argument for a pose that is not valid.
template <class Real>
double path_information(const BasicInformationField<Real>& field, const View& view, const ViewPath& path,
                        Counting counting = Counting::kOnce);

/// Of the path's first view, its first two views, and so on, each cell once.
template <class Real>
std::vector<double> growing_information(const BasicInformationField<Real>& field, const View& view,
                                        const ViewPath& path);

/// Of each path, in parallel; the same bits for any number of threads.
template <class Real>
std::vector<double> path_information(const BasicInformationField<Real>& field, const View& view,
                                     std::span<const ViewPath> paths, Counting counting = Counting::kOnce);

}  // namespace lapis::planner
