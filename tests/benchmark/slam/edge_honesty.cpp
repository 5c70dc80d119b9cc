#include "tests/benchmark/slam/edge_honesty.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace lapis::slam::benchmark {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

const char* name_of(EdgeType type) {
  switch (type) {
    case EdgeType::kOdometry: return "vision";
    case EdgeType::kCovisibility: return "covisibility";
    case EdgeType::kLoopClosure: return "loops";
    case EdgeType::kWheelOdometry: return "wheels";
    case EdgeType::kSurface: return "surfaces";
  }
  return "";
}

int freedoms_of(const Matrix6d& information, double floor) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information, Eigen::EigenvaluesOnly);
  return static_cast<int>((solver.eigenvalues().array() > floor).count());
}

}  // namespace

double nees(const Pose& estimate, const Pose& truth, const Matrix6d& information, double floor) {
  const Vector6d error = geometry::se3_log(estimate.inverse() * truth);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  const Vector6d along = solver.eigenvectors().transpose() * error;
  double sum = 0.0;
  int freedoms = 0;
  for (int i = 0; i < 6; ++i) {
    if (solver.eigenvalues()(i) <= floor) continue;
    sum += solver.eigenvalues()(i) * along(i) * along(i);
    ++freedoms;
  }
  return freedoms > 0 ? sum / freedoms : 0.0;
}

// Of x, y and the turn of the base. A robot on a floor has no errors in the other three directions, which make wheels
// look more honest than they are.
double EdgeHonesty::nees_in_plane(const Pose& estimate, const Pose& truth, const Matrix6d& covariance) const {
  const Matrix6d to_base = geometry::adjoint(T_base_camera_);
  const Vector6d error = to_base * geometry::se3_log(estimate.inverse() * truth);
  const Matrix6d of_base = to_base * covariance * to_base.transpose();
  const std::vector<int> plane{0, 1, 5};
  const Eigen::Vector3d e = error(plane);
  const Eigen::Matrix3d P = of_base(plane, plane);
  return e.dot(P.inverse() * e) / 3.0;
}

void EdgeHonesty::add(const PoseGraphSnapshot& graph, const std::map<std::int64_t, Pose>& truth) {
  std::map<std::uint64_t, Pose> by_id;
  for (const auto& node : graph.nodes) by_id[node.id] = truth.at(node.stamp.nanoseconds);
  for (const auto& edge : graph.edges) add(edge, by_id.at(edge.from).inverse() * by_id.at(edge.to));
}

void EdgeHonesty::add(const PoseGraphEdge& edge, const Pose& T_from_to_true) {
  const int freedoms = freedoms_of(edge.information, floor_);
  if (freedoms == 0) return;
  samples_[name_of(edge.type)].push_back(
      {nees(edge.T_from_to, T_from_to_true, edge.information, floor_), static_cast<double>(freedoms)});
  if (edge.type != EdgeType::kWheelOdometry) return;
  samples_["wheels, in the plane"].push_back(
      {nees_in_plane(edge.T_from_to, T_from_to_true, edge.information.inverse()), 3.0});
}

void EdgeHonesty::add_pose(const Pose& T_map_camera, const Pose& truth, const Matrix6d& covariance) {
  samples_["poses"].push_back({nees(T_map_camera, truth, covariance.inverse()), 6.0});
  samples_["poses, in the plane"].push_back({nees_in_plane(T_map_camera, truth, covariance), 3.0});
}

void EdgeHonesty::add(const EdgeHonesty& other) {
  for (const auto& [name, samples] : other.samples_) {
    samples_[name].insert(samples_[name].end(), samples.begin(), samples.end());
  }
}

void EdgeHonesty::print(const std::string& indent) const {
  for (const auto& [name, samples] : samples_) {
    double sum = 0.0, freedoms = 0.0;
    std::vector<double> values;
    for (const Sample& sample : samples) {
      sum += sample.nees;
      freedoms += sample.freedoms;
      values.push_back(sample.nees);
    }
    std::sort(values.begin(), values.end());
    const auto count = static_cast<double>(values.size());
    const auto p95 = static_cast<std::size_t>(std::ceil(0.95 * count)) - 1;
    std::printf(
        "%s%-20s %6zu, %3.1f degrees of freedom; NEES of each: mean %8.2f, median %6.2f, p95 %8.2f, max %8.1f\n",
        indent.c_str(), name.c_str(), values.size(), freedoms / count, sum / count, values[values.size() / 2],
        values[p95], values.back());
  }
}

}  // namespace lapis::slam::benchmark
