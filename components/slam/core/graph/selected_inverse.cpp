#include "slam/core/graph/selected_inverse.hpp"

#include <cstddef>
#include <stdexcept>

namespace lapis::slam {
namespace {

template <int kSize>
class Recursion {
 public:
  using Block = Eigen::Matrix<double, kSize, kSize>;

  explicit Recursion(const BlockFactor& factor) : factor_(factor), inverse_(factor.rows.size()) {}

  std::vector<Eigen::MatrixXd> diagonal() {
    const std::size_t columns = factor_.begin.size() - 1;
    for (std::size_t column = columns; column-- > 0;) solve(column);
    std::vector<Eigen::MatrixXd> result;
    for (std::size_t column = 0; column < columns; ++column) result.emplace_back(inverse_[begin(column)]);
    return result;
  }

 private:
  // With l_r = L_rj L_jj^-1 for the rows r below the diagonal of column j: Z_rj = - sum_m Z_rm l_m over these rows m,
  // and Z_jj = (L_jj L_jj')^-1 - sum_m l_m' Z_mj.
  void solve(std::size_t column) {
    const std::size_t first = begin(column), end = begin(column + 1);
    const Block inverse_L = value(first).template triangularView<Eigen::Lower>().solve(Block::Identity());
    below_.clear();
    for (std::size_t k = first + 1; k < end; ++k) {
      below_.emplace_back(value(k) * inverse_L);
      inverse_[k].setZero();
    }
    for (std::size_t k = first + 1; k < end; ++k) add_column_of(k, first, end);
    inverse_[first] = inverse_L.transpose() * inverse_L;
    for (std::size_t k = first + 1; k < end; ++k) inverse_[first] -= below_[k - first - 1].transpose() * inverse_[k];
  }

  // Contribution of the blocks of the inverse in the column of row k, and of their transposes. That column has all rows
  // below k that this one has: elimination ensures it.
  void add_column_of(std::size_t k, std::size_t first, std::size_t end) {
    const auto column = static_cast<std::size_t>(factor_.rows[k]);
    std::size_t place = begin(column);
    inverse_[k] -= inverse_[place] * below_[k - first - 1];
    for (std::size_t m = k + 1; m < end; ++m) {
      while (factor_.rows[place] != factor_.rows[m]) ++place;
      inverse_[m] -= inverse_[place] * below_[k - first - 1];
      inverse_[k] -= inverse_[place].transpose() * below_[m - first - 1];
    }
  }

  std::size_t begin(std::size_t column) const { return static_cast<std::size_t>(factor_.begin[column]); }
  Eigen::Map<const Block> value(std::size_t k) const {
    return Eigen::Map<const Block>(factor_.values.data() + k * kSize * kSize);
  }

  const BlockFactor& factor_;
  std::vector<Block> inverse_;  // where the factor has blocks
  std::vector<Block> below_;    // of the column that is being solved
};

}  // namespace

std::vector<Eigen::MatrixXd> inverse_diagonal(const BlockFactor& factor) {
  if (factor.block_size == 3) return Recursion<3>(factor).diagonal();
  if (factor.block_size == 6) return Recursion<6>(factor).diagonal();
  throw std::invalid_argument("blocks have 3 or 6 rows");
}

}  // namespace lapis::slam
