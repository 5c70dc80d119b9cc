#include "tests/benchmark/slam/plain_ceres.hpp"

#include <array>
#include <map>

#include <ceres/ceres.h>
#include <Eigen/Cholesky>

namespace lapis::slam::benchmark {
namespace {

// x y z qx qy qz qw, or x y angle.
using Block = std::array<double, 7>;

struct SpatialError {
  Eigen::Quaterniond q;
  Eigen::Vector3d t;
  geometry::Matrix6d root;  // root' * root = information

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    using Quaternion = Eigen::Quaternion<T>;
    const Eigen::Map<const Vector> t_from(from), t_to(to);
    const Eigen::Map<const Quaternion> q_from(from + 3), q_to(to + 3);
    const Quaternion inverse = q.cast<T>().conjugate();
    Quaternion error = inverse * q_from.conjugate() * q_to;
    if (error.w() < T(0.0)) error.coeffs() = -error.coeffs();
    Eigen::Map<Eigen::Matrix<T, 6, 1>> e(residual);
    e.template head<3>() = inverse * (q_from.conjugate() * (t_to - t_from) - t.cast<T>());
    e.template tail<3>() = T(2.0) * error.vec();
    e = root.cast<T>() * e;
    return true;
  }
};

struct PlanarError {
  double x, y, angle;
  Eigen::Matrix3d root;

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const Eigen::Matrix<T, 2, 1> offset(to[0] - from[0], to[1] - from[1]);
    const T turn = to[2] - from[2] - T(angle);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> e(residual);
    e.template head<2>() = Eigen::Rotation2D<T>(-from[2] - T(angle)) * offset -
                           (Eigen::Rotation2Dd(-angle) * Eigen::Vector2d(x, y)).cast<T>();
    e[2] = turn - T(2.0 * M_PI) * ceres::floor((turn + T(M_PI)) / T(2.0 * M_PI));
    e = root.cast<T>() * e;
    return true;
  }
};

double angle_of(const geometry::Pose& T) { return std::atan2(T(1, 0), T(0, 0)); }

Block to_block(const geometry::Pose& T, bool is_planar) {
  if (is_planar) return {T.translation().x(), T.translation().y(), angle_of(T)};
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  return {T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w()};
}

geometry::Pose to_pose(const Block& block, bool is_planar) {
  if (!is_planar) {
    return geometry::make_pose({block[0], block[1], block[2]}, {block[6], block[3], block[4], block[5]});
  }
  return geometry::make_pose({block[0], block[1], 0.0},
                             Eigen::Quaterniond(Eigen::AngleAxisd(block[2], Eigen::Vector3d::UnitZ())));
}

ceres::CostFunction* make_cost(const PoseGraphEdge& edge, bool is_planar) {
  const Eigen::Vector3d t = edge.T_from_to.translation();
  if (!is_planar) {
    const geometry::Matrix6d root = edge.information.llt().matrixU();
    return new ceres::AutoDiffCostFunction<SpatialError, 6, 7, 7>(
        new SpatialError{geometry::unit_quaternion(edge.T_from_to), t, root});
  }
  const Eigen::Matrix3d root = edge.information({0, 1, 5}, {0, 1, 5}).llt().matrixU();
  return new ceres::AutoDiffCostFunction<PlanarError, 3, 3, 3>(
      new PlanarError{t.x(), t.y(), angle_of(edge.T_from_to), root});
}

}  // namespace

void optimize_with_plain_ceres(PoseGraphSnapshot& graph, int max_iterations) {
  std::map<std::uint64_t, Block> blocks;
  for (const PoseGraphNode& node : graph.nodes) blocks[node.id] = to_block(node.T_map_camera, graph.is_planar);
  ceres::Problem problem;
  for (const PoseGraphNode& node : graph.nodes) {
    if (graph.is_planar) {
      problem.AddParameterBlock(blocks.at(node.id).data(), 3);
    } else {
      problem.AddParameterBlock(
          blocks.at(node.id).data(), 7,
          new ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>());
    }
  }
  for (const PoseGraphEdge& edge : graph.edges) {
    problem.AddResidualBlock(make_cost(edge, graph.is_planar), nullptr, blocks.at(edge.from).data(),
                             blocks.at(edge.to).data());
  }
  problem.SetParameterBlockConstant(blocks.at(graph.nodes.front().id).data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = 1;
  options.max_num_iterations = max_iterations;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (PoseGraphNode& node : graph.nodes) node.T_map_camera = to_pose(blocks.at(node.id), graph.is_planar);
}

}  // namespace lapis::slam::benchmark
