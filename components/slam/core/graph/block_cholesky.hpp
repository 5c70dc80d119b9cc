#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slam/core/graph/selected_inverse.hpp"

struct cholmod_factor_struct;

namespace lapis::slam {

/// Off-diagonal block of a symmetric block matrix: (row, column), in either order.
using BlockPair = std::pair<int, int>;

/// Order in which to eliminate blocks so that there is little fill-in: approximate minimum degree (Amestoy, Davis and
/// Duff, 1996) of the graph whose edges are `pairs`.
std::vector<int> elimination_order(int blocks, const std::vector<BlockPair>& pairs);

/// Symmetric positive definite system of square blocks of one size, factorised by CHOLMOD. The pattern is analysed
/// once; after that the values can be set, factorised and solved any number of times.
class BlockCholesky {
 public:
  /// `pairs` may contain a block more than once; add_pair takes the index in that list. `order`: see elimination_order.
  BlockCholesky(int block_size, const std::vector<int>& order, const std::vector<BlockPair>& pairs);
  ~BlockCholesky();
  BlockCholesky(const BlockCholesky&) = delete;
  BlockCholesky& operator=(const BlockCholesky&) = delete;

  void set_zero();
  /// Adds to the diagonal block; only the upper triangle of `value` is read.
  template <class Block>
  void add_diagonal(int block, const Block& value) {
    constexpr int kSize = Block::RowsAtCompileTime;
    double* column = values_.data() + diagonals_[static_cast<std::size_t>(block)].offset;
    for (int c = 0; c < kSize; ++c) {
      for (int r = 0; r <= c; ++r) column[r] += value(r, c);
      column += diagonals_[static_cast<std::size_t>(block)].stride + c + 1;
    }
  }
  /// Adds to the block in the row and column of `pairs[pair]`.
  template <class Block>
  void add_pair(std::size_t pair, const Block& value) {
    constexpr int kSize = Block::RowsAtCompileTime;
    const Slot& slot = pairs_[pair];
    double* column = values_.data() + slot.offset;
    for (int c = 0; c < kSize; ++c) {
      for (int r = 0; r < kSize; ++r) column[r] += slot.is_transposed ? value(c, r) : value(r, c);
      column += slot.stride + c + 1;
    }
  }

  /// Factorises the matrix with its diagonal multiplied by 1 + damping (Marquardt, 1963); for the damping, no diagonal
  /// element counts as less than a millionth of their mean. False when the result is not positive definite.
  bool factorize(double damping);
  /// Solves for each column of `right`, whose rows are in the order of the blocks. Only after a successful factorize.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// Diagonal blocks of the inverse, by block. Only after a successful factorize.
  std::vector<Eigen::MatrixXd> inverse_diagonal() const;

 private:
  struct Slot {
    std::ptrdiff_t offset = 0;  // of the block's first element
    std::ptrdiff_t stride = 0;  // entries of a column above the diagonal block; column c has c + 1 more
    bool is_transposed = false;
  };
  struct Cholmod;

  void lay_out(const std::vector<BlockPair>& sorted);
  Slot slot_of(const std::vector<BlockPair>& sorted, BlockPair place) const;
  BlockFactor block_factor(const cholmod_factor_struct& factor) const;

  int block_size_ = 0;
  std::vector<int> position_;  // place in the elimination order, by block
  // The upper triangle by columns, as CHOLMOD reads it.
  std::vector<int> column_begin_, rows_;
  std::vector<double> values_;
  std::vector<Slot> diagonals_, pairs_;
  std::unique_ptr<Cholmod> cholmod_;
};

}  // namespace lapis::slam
