#pragma once

#include <vector>

#include <Eigen/Core>

namespace lapis::slam {

/// Lower triangular factor L of a symmetric positive definite matrix L L' of square blocks, by columns of blocks.
struct BlockFactor {
  int block_size = 0;
  std::vector<int> begin = {0};  ///< begin of each column in `rows`, and the end of the last one
  std::vector<int> rows;         ///< ascending in each column; the first one is that of the diagonal block
  std::vector<double> values;    ///< blocks in the order of `rows`, each column-major
};

/// Diagonal blocks of (L L')^-1 without the rest of it: Takahashi's recursion needs the inverse only where the factor
/// has blocks (Erisman and Tinney, Communications of the ACM, 1975). Its time grows with the sum over the columns of
/// the squared number of blocks. Blocks have 3 or 6 rows; throws std::invalid_argument for others.
std::vector<Eigen::MatrixXd> inverse_diagonal(const BlockFactor& factor);

}  // namespace lapis::slam
