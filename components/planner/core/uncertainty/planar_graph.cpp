#include "planner/core/uncertainty/planar_graph.hpp"

#include <algorithm>
#include <optional>
#include <string>

namespace lapis::planner {
namespace {

constexpr int kSize = 3;  // number of unknowns of a key-frame

using Unknowns = Eigen::Matrix<double, 6, kSize>;

/// A block of the information matrix, on or below the diagonal.
struct Block {
  int column, row;
  Eigen::Matrix3d value;
};

/// Maps the planar errors of a pose to its own tangent space: a turn about the vertical axis through the camera does
/// not displace the camera.
Unknowns tangent_of(const geometry::Pose& T_map_camera) {
  const Eigen::Matrix3d R_camera_map = T_map_camera.linear().transpose();
  Unknowns tangent = Unknowns::Zero();
  tangent.topLeftCorner<3, 2>() = R_camera_map.leftCols<2>();
  tangent.bottomRightCorner<3, 1>() = R_camera_map.col(2);
  return tangent;
}

/// Adds the blocks of an edge from `a` to `b`. Its error is that of `b` minus that of `a`, carried to `b`.
void add_edge(int a, int b, const geometry::Pose& T_map_a, const geometry::Pose& T_map_b,
              const Information& information, std::vector<Block>& blocks) {
  const Unknowns at_a = -geometry::adjoint(T_map_b.inverse() * T_map_a) * tangent_of(T_map_a);
  const Unknowns at_b = tangent_of(T_map_b);
  blocks.push_back({a, a, at_a.transpose() * information * at_a});
  blocks.push_back({b, b, at_b.transpose() * information * at_b});
  if (a < b) {
    blocks.push_back({a, b, at_b.transpose() * information * at_a});
  } else {
    blocks.push_back({b, a, at_a.transpose() * information * at_b});
  }
}

/// Sums the blocks at the same position, without node 0.
LowerTriangle assemble(int nodes, std::vector<Block> blocks) {
  std::erase_if(blocks, [](const Block& block) { return block.column == 0; });
  std::stable_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) {
    return std::pair(a.column, a.row) < std::pair(b.column, b.row);
  });
  std::vector<Block> sums;
  for (const Block& block : blocks) {
    if (!sums.empty() && sums.back().column == block.column && sums.back().row == block.row) {
      sums.back().value += block.value;
    } else {
      sums.push_back(block);
    }
  }
  LowerTriangle matrix;
  auto first = sums.begin();
  for (int node = 1; node < nodes; ++node) {
    const auto last = std::find_if(first, sums.end(), [node](const Block& block) { return block.column != node; });
    for (int column = 0; column < kSize; ++column) {
      for (auto block = first; block != last; ++block) {
        for (int row = block->row == node ? column : 0; row < kSize; ++row) {
          matrix.rows.push_back(kSize * (block->row - 1) + row);
          matrix.values.push_back(block->value(row, column));
        }
      }
      matrix.begin.push_back(static_cast<int>(matrix.rows.size()));
    }
    first = last;
  }
  return matrix;
}

}  // namespace

std::variant<PlanarGraph, GraphError> PlanarGraph::make(std::span<const Keyframe> keyframes,
                                                        std::span<const KeyframeEdge> edges) {
  if (keyframes.empty()) return GraphError{"fewer than two connected key-frames"};
  const auto part = component_of(keyframes.back().id, edges, Criterion::kD);
  if (const auto* error = std::get_if<GraphError>(&part)) return *error;
  const auto& component = std::get<KeyframeGraph>(part);
  std::vector<Keyframe> selected;
  for (const Keyframe& keyframe : keyframes) {
    if (component.node_of(keyframe.id)) selected.push_back(keyframe);
  }
  if (selected.size() != component.keyframes.size()) return GraphError{"an edge names a key-frame that is not there"};
  if (selected.size() < 2) return GraphError{"fewer than two connected key-frames"};
  std::vector<Block> blocks;
  for (const KeyframeEdge& edge : edges) {
    const auto from = component.node_of(edge.from), to = component.node_of(edge.to);
    if (!from || !to) continue;
    if (edge.information.rows() != 6) return GraphError{"an edge's information is not that of a pose"};
    add_edge(*from, *to, selected[index(*from)].T_map_camera, selected[index(*to)].T_map_camera, edge.information,
             blocks);
  }
  auto factor = SparseCholesky::make(assemble(static_cast<int>(selected.size()), std::move(blocks)));
  if (!factor) return GraphError{"the information of the key-frames is singular"};
  return PlanarGraph(std::move(selected), std::move(*factor));
}

Eigen::MatrixXd PlanarGraph::covariance(std::span<const int> nodes) const {
  std::vector<int> indices;
  for (const int node : nodes) {
    for (int i = 0; i < kSize; ++i) indices.push_back(node == 0 ? -1 : kSize * (node - 1) + i);
  }
  return factor_.inverse(indices);
}

std::vector<Eigen::Matrix3d> PlanarGraph::marginals() const {
  std::vector<Eigen::Matrix3d> all;
  for (int node = 0; node < static_cast<int>(keyframes_.size()); ++node)
    all.emplace_back(covariance(std::span(&node, 1)));
  return all;
}

Eigen::MatrixX3d PlanarGraph::columns(int node) const {
  const Eigen::Index size = kSize * (std::ssize(keyframes_) - 1);
  Eigen::MatrixX3d columns = Eigen::MatrixX3d::Zero(kSize + size, kSize);
  for (int i = 0; i < kSize && node > 0; ++i)
    columns.col(i).tail(size) = factor_.solve(Eigen::VectorXd::Unit(size, kSize * (node - 1) + i));
  return columns;
}

}  // namespace lapis::planner
