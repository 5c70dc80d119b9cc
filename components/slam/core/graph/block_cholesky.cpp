#include "slam/core/graph/block_cholesky.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include <cholmod.h>

namespace lapis::slam {
namespace {

constexpr double kLeastDiagonal = 1e-6;

cholmod_sparse upper_view(int size, std::vector<int>& column_begin, std::vector<int>& rows, double* values) {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(size);
  matrix.nzmax = rows.size();
  matrix.p = column_begin.data();
  matrix.i = rows.data();
  matrix.x = values;
  matrix.stype = 1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = values == nullptr ? CHOLMOD_PATTERN : CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

// (column, row) with row < column, sorted, each once.
std::vector<BlockPair> sorted_places(const std::vector<BlockPair>& pairs, const std::vector<int>* position) {
  std::vector<BlockPair> places;
  places.reserve(pairs.size());
  for (auto [a, b] : pairs) {
    if (position != nullptr) {
      a = (*position)[static_cast<std::size_t>(a)];
      b = (*position)[static_cast<std::size_t>(b)];
    }
    places.emplace_back(std::max(a, b), std::min(a, b));
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

}  // namespace

struct BlockCholesky::Cholmod {
  Cholmod() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.final_ll = 1;  // LL' detects a matrix that is not positive definite
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholmod() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  mutable cholmod_common common{};
  cholmod_sparse matrix{};
  cholmod_factor* factor = nullptr;
};

std::vector<int> elimination_order(int blocks, const std::vector<BlockPair>& pairs) {
  const std::vector<BlockPair> places = sorted_places(pairs, nullptr);
  std::vector<int> column_begin(static_cast<std::size_t>(blocks) + 1, 0), rows;
  for (const auto& [column, row] : places) {
    ++column_begin[static_cast<std::size_t>(column) + 1];
    rows.push_back(row);
  }
  for (std::size_t i = 1; i < column_begin.size(); ++i) column_begin[i] += column_begin[i - 1];
  std::vector<int> order(static_cast<std::size_t>(blocks));
  rows.reserve(1);
  cholmod_sparse pattern = upper_view(blocks, column_begin, rows, nullptr);
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  const bool is_ordered = blocks == 0 || cholmod_amd(&pattern, nullptr, 0, order.data(), &common) != 0;
  cholmod_finish(&common);
  if (!is_ordered) throw std::bad_alloc();
  return order;
}

BlockCholesky::BlockCholesky(int block_size, const std::vector<int>& order, const std::vector<BlockPair>& pairs)
    : block_size_(block_size), position_(order.size()), cholmod_(std::make_unique<Cholmod>()) {
  for (std::size_t i = 0; i < order.size(); ++i) position_[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  const std::vector<BlockPair> sorted = sorted_places(pairs, &position_);
  lay_out(sorted);
  for (const int position : position_) diagonals_.push_back(slot_of(sorted, {position, position}));
  for (const auto& [row, column] : pairs) {
    pairs_.push_back(
        slot_of(sorted, {position_[static_cast<std::size_t>(row)], position_[static_cast<std::size_t>(column)]}));
  }
  const int size = block_size_ * static_cast<int>(order.size());
  cholmod_->matrix = upper_view(size, column_begin_, rows_, values_.data());
  cholmod_->factor = cholmod_analyze(&cholmod_->matrix, &cholmod_->common);
  if (cholmod_->factor == nullptr) throw std::bad_alloc();
}

BlockCholesky::~BlockCholesky() = default;

void BlockCholesky::lay_out(const std::vector<BlockPair>& sorted) {
  column_begin_ = {0};
  auto next = sorted.begin();
  for (int block = 0; block < static_cast<int>(position_.size()); ++block) {
    const auto first = next;
    while (next != sorted.end() && next->first == block) ++next;
    for (int c = 0; c < block_size_; ++c) {
      for (auto place = first; place != next; ++place) {
        for (int r = 0; r < block_size_; ++r) rows_.push_back(place->second * block_size_ + r);
      }
      for (int r = 0; r <= c; ++r) rows_.push_back(block * block_size_ + r);
      column_begin_.push_back(static_cast<int>(rows_.size()));
    }
  }
  values_.assign(rows_.size(), 0.0);
}

// Slot of the block at two positions in the elimination order (row, column).
BlockCholesky::Slot BlockCholesky::slot_of(const std::vector<BlockPair>& sorted, BlockPair place) const {
  const int column = std::max(place.first, place.second), row = std::min(place.first, place.second);
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), BlockPair{column, 0});
  const auto found = std::lower_bound(first, sorted.end(), BlockPair{column, row});
  const auto first_column = static_cast<std::size_t>(column) * static_cast<std::size_t>(block_size_);
  const std::ptrdiff_t begin = column_begin_[first_column];
  const std::ptrdiff_t end = column_begin_[first_column + 1];
  return {begin + (found - first) * block_size_, end - begin - 1, place.first > place.second};
}

void BlockCholesky::set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

bool BlockCholesky::factorize(double damping) {
  if (position_.empty()) return true;
  std::vector<double> diagonal;
  if (damping > 0.0) {
    for (std::size_t i = 1; i < column_begin_.size(); ++i) {
      diagonal.push_back(values_[static_cast<std::size_t>(column_begin_[i]) - 1]);
    }
    const double mean = Eigen::Map<const Eigen::VectorXd>(diagonal.data(), std::ssize(diagonal)).mean();
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      values_[static_cast<std::size_t>(column_begin_[i + 1]) - 1] +=
          damping * std::max(diagonal[i], kLeastDiagonal * mean);
    }
  }
  cholmod_factorize(&cholmod_->matrix, cholmod_->factor, &cholmod_->common);
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    values_[static_cast<std::size_t>(column_begin_[i + 1]) - 1] = diagonal[i];
  }
  if (cholmod_->common.status < 0) throw std::bad_alloc();
  return cholmod_->common.status == CHOLMOD_OK;
}

Eigen::MatrixXd BlockCholesky::solve(const Eigen::MatrixXd& right) const {
  Eigen::MatrixXd ordered(right.rows(), right.cols());
  for (std::size_t i = 0; i < position_.size(); ++i) {
    ordered.middleRows(position_[i] * block_size_, block_size_) =
        right.middleRows(static_cast<int>(i) * block_size_, block_size_);
  }
  if (right.rows() == 0) return ordered;
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(right.rows());
  b.ncol = static_cast<std::size_t>(right.cols());
  b.nzmax = b.nrow * b.ncol;
  b.x = ordered.data();
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, cholmod_->factor, &b, &cholmod_->common);
  if (x == nullptr) throw std::bad_alloc();
  const Eigen::Map<const Eigen::MatrixXd> solution(static_cast<const double*>(x->x), right.rows(), right.cols());
  for (std::size_t i = 0; i < position_.size(); ++i) {
    ordered.middleRows(static_cast<int>(i) * block_size_, block_size_) =
        solution.middleRows(position_[i] * block_size_, block_size_);
  }
  cholmod_free_dense(&x, &cholmod_->common);
  return ordered;
}

std::vector<Eigen::MatrixXd> BlockCholesky::inverse_diagonal() const {
  std::vector<Eigen::MatrixXd> result(position_.size());
  if (result.empty()) return result;
  cholmod_factor* factor = cholmod_copy_factor(cholmod_->factor, &cholmod_->common);
  const bool is_simplicial =
      factor != nullptr && cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, factor, &cholmod_->common) != 0;
  if (!is_simplicial) throw std::bad_alloc();
  const std::vector<Eigen::MatrixXd> ordered = slam::inverse_diagonal(block_factor(*factor));
  const auto* order = static_cast<const int*>(factor->Perm);  // CHOLMOD's own permutation, applied after ours
  std::vector<std::size_t> place(position_.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    place[static_cast<std::size_t>(order[i * static_cast<std::size_t>(block_size_)] / block_size_)] = i;
  }
  cholmod_free_factor(&factor, &cholmod_->common);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = ordered[place[static_cast<std::size_t>(position_[i])]];
  return result;
}

// CHOLMOD's order is a post-order of the elimination tree. It keeps the rows of a block together, so that the rows of a
// block's first column, from its diagonal block on, form whole blocks.
BlockFactor BlockCholesky::block_factor(const cholmod_factor_struct& factor) const {
  const auto *begin = static_cast<const int*>(factor.p), *rows = static_cast<const int*>(factor.i),
             *count = static_cast<const int*>(factor.nz);
  const auto* values = static_cast<const double*>(factor.x);
  BlockFactor result{block_size_, {0}, {}, {}};
  for (int first = 0; first < static_cast<int>(factor.n); first += block_size_) {
    const int blocks = count[first] / block_size_;
    for (int block = 0; block < blocks; ++block) {
      result.rows.push_back(rows[begin[first] + block * block_size_] / block_size_);
      for (int c = 0; c < block_size_; ++c) {
        // Column c of the diagonal block begins at its row c.
        const double* column = values + begin[first + c] + block * block_size_ - c;
        for (int r = 0; r < block_size_; ++r) result.values.push_back(block == 0 && r < c ? 0.0 : column[r]);
      }
    }
    result.begin.push_back(static_cast<int>(result.rows.size()));
  }
  return result;
}

}  // namespace lapis::slam
